"""EEG potentials of a sphere of any number of concentric layers, by the series in Legendre polynomials.

Layers are told from inside out: outer radii in metres, conductivities in S/m. Dipoles lie in the innermost
layer, electrodes on the outermost sphere. The factors are those of Mosher, Leahy and Lewis 1999 (equations
11 to 14), which hold for any number of layers. Published coefficients of four layers had errors (Naess et al. 2017), so
Testing/Application/LayeredSphereTest.py solves the equations at the borders as they stand, and compares.
"""
from typing import NamedTuple

import numpy as np

TERMS = 300  # 0.9^300 of the largest is 2e-14


class Layers(NamedTuple):
    radii: tuple           # m
    conductivities: tuple  # S/m


THREE = Layers((0.080, 0.086, 0.092), (0.33, 0.0041, 0.33))
FOUR = Layers((0.078, 0.080, 0.086, 0.092), (0.33, 1.79, 0.01, 0.43))  # brain, CSF, skull, scalp


def factors(layers, orders):
    """f_n: what layers make of the potential of order n on the surface."""
    product = np.tile(np.eye(2), (len(orders), 1, 1))
    n = orders.astype(float)
    for inner in range(len(layers.radii) - 1):
        ratio = layers.conductivities[inner] / layers.conductivities[inner + 1]
        radius = layers.radii[inner] / layers.radii[-1]
        step = np.empty_like(product)
        step[:, 0, 0] = n + (n + 1) * ratio
        step[:, 0, 1] = (n + 1) * (ratio - 1) * radius ** -(2 * n + 1)
        step[:, 1, 0] = n * (ratio - 1) * radius ** (2 * n + 1)
        step[:, 1, 1] = (n + 1) + n * ratio
        product = product @ step / (2 * n + 1)[:, None, None]
    return n / (n * product[:, 1, 1] + (n + 1) * product[:, 1, 0])


def legendre(cosines, terms):
    """P_n and its derivative, n = 1 ... terms, one row an order."""
    values = np.ones((terms + 1, len(cosines)))
    slopes = np.zeros_like(values)
    values[1], slopes[1] = cosines, 1
    for n in range(2, terms + 1):
        values[n] = ((2 * n - 1) * cosines * values[n - 1] - (n - 1) * values[n - 2]) / n
        slopes[n] = slopes[n - 2] + (2 * n - 1) * values[n - 1]
    return values[1:], slopes[1:]


def potentials(layers, places, moments, electrodes, terms=TERMS):
    """Potentials (V) on the outermost sphere, one row a dipole (m, A m) and a column an electrode."""
    orders = np.arange(1, terms + 1)
    outer = layers.radii[-1]
    weights = (2 * orders + 1) / orders * factors(layers, orders)
    directions = electrodes / np.linalg.norm(electrodes, axis=1, keepdims=True)
    rows = []
    for place, moment in zip(places, moments):
        distance = np.linalg.norm(place)
        axis = place / distance
        cosines = directions @ axis
        across = directions - cosines[:, None] * axis
        values, slopes = legendre(cosines, terms)
        share = weights * (distance / outer) ** (orders - 1)
        rows.append((moment @ axis * ((share * orders) @ values) + (across @ moment) * (share @ slopes))
                    / (4 * np.pi * layers.conductivities[-1] * outer ** 2))
    return np.array(rows)


def spread_over_sphere(count, radius):
    """Points of the golden spiral."""
    steps = np.arange(count) + 0.5
    z = 1 - 2 * steps / count
    turn = np.pi * (1 + 5 ** 0.5) * steps
    r = np.sqrt(1 - z * z)
    return radius * np.c_[r * np.cos(turn), r * np.sin(turn), z]


def random_directions(count, random):
    vectors = random.randn(count, 3)
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def rdm_and_mag(found, truth):
    """Of every row, both against their average: |v/|v| - a/|a|| (0: same topography) and |v| / |a|
    (1: same strength)."""
    found = found - found.mean(axis=1, keepdims=True)
    truth = truth - truth.mean(axis=1, keepdims=True)
    sizes = [np.linalg.norm(v, axis=1, keepdims=True) for v in (found, truth)]
    return (np.linalg.norm(found / sizes[0] - truth / sizes[1], axis=1),
            (sizes[0] / sizes[1]).ravel())
