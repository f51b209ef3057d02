"""The analytic potentials of layered spheres that head models are measured against (Testing/Benchmark): by
other ways. Needs Debian's python3-numpy; exits 77 (skipped) without it."""
import sys
import unittest

from support import SOURCE

try:
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

sys.path.insert(0, str(SOURCE / "Testing" / "Benchmark"))
import layeredSphere as spheres  # noqa: E402

ORDERS = np.arange(1, 61)


class LayeredSphere(unittest.TestCase):
    def test_a_homogeneous_sphere_has_its_closed_form(self):
        """The terms (2 n + 1) / n = 2 + 1 / n: twice the potential in an endless medium, and a logarithm."""
        radius, sigma = 0.092, 0.33
        layers = spheres.Layers((radius,), (sigma,))
        electrodes = spheres.spread_over_sphere(20, radius)
        random = np.random.RandomState(1)
        places = 0.7 * radius * spheres.random_directions(10, random)
        moments = spheres.random_directions(10, random)
        found = spheres.potentials(layers, places, moments, electrodes)
        for row, place, moment in zip(found, places, moments):
            np.testing.assert_allclose(row, homogeneous(electrodes, place, moment, radius, sigma),
                                       atol=1e-9 * np.abs(row).max())

    def test_splitting_a_layer_changes_nothing(self):
        for layers in (spheres.THREE, spheres.FOUR):
            for n, outer in enumerate(layers.radii):
                inner = layers.radii[n - 1] if n > 0 else 0.05
                radii = (*layers.radii[:n], (inner + outer) / 2, *layers.radii[n:])
                sigmas = (*layers.conductivities[:n], layers.conductivities[n], *layers.conductivities[n:])
                np.testing.assert_allclose(spheres.factors(spheres.Layers(radii, sigmas), ORDERS),
                                           spheres.factors(layers, ORDERS), rtol=1e-10)

    def test_they_solve_the_equations_at_the_borders(self):
        """Potential and current through every border are the same on both sides, none leaves the head: 2 N
        linear equations for each order, solved as they stand."""
        for layers in (spheres.THREE, spheres.FOUR):
            np.testing.assert_allclose([by_equations(layers, n) for n in ORDERS],
                                       spheres.factors(layers, ORDERS), rtol=1e-8)


def homogeneous(electrodes, place, moment, radius, sigma):
    """With G = sum of (1 / n) r0^n / R^(n+1) P_n = -ln((R - r0 . r / R + d) / (2 R)) / R."""
    ray = electrodes - place
    d = np.linalg.norm(ray, axis=1, keepdims=True)
    outward = electrodes / radius
    slope = (outward + ray / d) / (radius * (radius - outward @ place + d[:, 0]))[:, None]
    return (2 * ray / d ** 3 + slope) @ moment / (4 * np.pi * sigma)


def coefficients(layers, n):
    """A_1, A_2, B_2, ... of the potential A_k r^n + B_k r^-(n+1) in layer k, B_1 = 1."""
    count = len(layers.radii)
    matrix, right = np.zeros((2 * count - 1, 2 * count - 1)), np.zeros(2 * count - 1)
    scale = layers.radii[-1]

    def put(row, layer, grow, shrink, sign):
        """Of layer's A and B."""
        if layer == 0:
            matrix[row, 0] += sign * grow
            right[row] -= sign * shrink
        else:
            matrix[row, 2 * layer - 1] += sign * grow
            matrix[row, 2 * layer] += sign * shrink

    for k in range(count):
        r, sigma = layers.radii[k] / scale, layers.conductivities
        if k + 1 < count:
            for layer, sign in ((k, 1), (k + 1, -1)):
                put(2 * k, layer, r ** n, r ** -(n + 1), sign)
                put(2 * k + 1, layer, sigma[layer] * n * r ** (n - 1),
                    -sigma[layer] * (n + 1) * r ** -(n + 2), sign)
        else:
            put(2 * k, k, n * r ** (n - 1), -(n + 1) * r ** -(n + 2), 1)
    rows = np.abs(matrix).max(axis=1)
    columns = np.abs(matrix / rows[:, None]).max(axis=0)
    solved = np.linalg.solve(matrix / rows[:, None] / columns, right / rows) / columns
    solved[0] /= scale ** (2 * n + 1)
    return solved


def by_equations(layers, n):
    """What the layers make of the potential of order n on the surface: against that of the source alone, in
    an endless medium of the scalp's conductivity, by n / (2 n + 1)."""
    scale = layers.radii[-1]
    solved = coefficients(layers, n)
    if len(layers.radii) == 1:
        surface = solved[0] * scale ** (2 * n + 1) + 1
    else:
        surface = solved[-2] + solved[-1]
    return surface * n / (2 * n + 1) * layers.conductivities[-1] / layers.conductivities[0]


if __name__ == "__main__":
    unittest.main(verbosity=2)
