"""EEG potentials of any number of nested surfaces by symmetric boundary elements [Kybic2005], the method of
OpenMEEG, which is not in Debian: potentials linear in triangles, currents constant in them.

Within the layer k, of conductivity s_k, between the surfaces k - 1 and k, with V the potentials on surfaces, p the
currents through them outward, and u0 the dipole's potential in an endless medium (k = 1 alone):

    u = u0 + S_k p_k / s_k - D_k V_k - S_(k-1) p_(k-1) / s_k + D_(k-1) V_(k-1)

S and D are the single and the double layer. That u and s du/dn are the same on both sides of a surface gives the
equations, the first tested with constants, the second with linear functions; the single layer gives the double
layer's slope by integration by parts. Over the inner triangle integrals are in closed form [Wilton1984], over the
outer one by three points, in 16 parts of it where the two are near.

Testing/Application/SymmetricBemTest.py holds it to the analytic series; on icospheres of 642 vertices it gives what
OpenMEEG does. Needs python3-numba.
"""
import numba
import numpy as np

THREE_POINTS = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6.0


def subdivided(levels):
    """Barycentric coordinates of points of equal weight: three in each of 4^levels parts of a triangle."""
    parts = [np.eye(3)]
    for _ in range(levels):
        finer = []
        for a, b, c in parts:
            ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
            finer += [np.array(t) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        parts = finer
    return np.concatenate([THREE_POINTS @ part for part in parts])


@numba.njit(fastmath=False)
def layers_at(x, corners, slopes, normal, is_same, single_and_double):
    """Of one triangle, seen from x: the integrals of 1 / R, and of -h_j n . (y - x) / R^3 (the double layer times 4 pi)
    with the linear functions h_j of its corners."""
    height = 0.0
    for k in range(3):
        height += normal[k] * (x[k] - corners[0, k])
    rays = np.empty((3, 3))
    lengths = np.empty(3)
    for c in range(3):
        total = 0.0
        for k in range(3):
            rays[c, k] = corners[c, k] - x[k]
            total += rays[c, k] ** 2
        lengths[c] = np.sqrt(total)
    single = 0.0
    flow0 = flow1 = flow2 = 0.0
    for c in range(3):
        d = (c + 1) % 3
        t0 = corners[d, 0] - corners[c, 0]
        t1 = corners[d, 1] - corners[c, 1]
        t2 = corners[d, 2] - corners[c, 2]
        edge = np.sqrt(t0 * t0 + t1 * t1 + t2 * t2)
        t0, t1, t2 = t0 / edge, t1 / edge, t2 / edge
        m0 = t1 * normal[2] - t2 * normal[1]
        m1 = t2 * normal[0] - t0 * normal[2]
        m2 = t0 * normal[1] - t1 * normal[0]
        near = t0 * rays[c, 0] + t1 * rays[c, 1] + t2 * rays[c, 2]
        far = near + edge
        # of the two forms of the logarithm the one without cancellation
        if near + far > 0:
            line = np.log((lengths[d] + far) / (lengths[c] + near))
        else:
            line = np.log((lengths[c] - near) / (lengths[d] - far))
        single += (m0 * rays[c, 0] + m1 * rays[c, 1] + m2 * rays[c, 2]) * line
        flow0 += m0 * line
        flow1 += m1 * line
        flow2 += m2 * line
    angle = 0.0
    if not is_same:
        a, b, c = rays[0], rays[1], rays[2]
        triple = (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2])
                  + a[2] * (b[0] * c[1] - b[1] * c[0]))
        ab = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
        bc = b[0] * c[0] + b[1] * c[1] + b[2] * c[2]
        ca = c[0] * a[0] + c[1] * a[1] + c[2] * a[2]
        angle = 2 * np.arctan2(triple, lengths[0] * lengths[1] * lengths[2] + ab * lengths[2]
                               + bc * lengths[0] + ca * lengths[1])
    single_and_double[0] = single - abs(height * angle)
    for j in range(3):
        share = 1.0
        across = 0.0
        for k in range(3):
            share -= slopes[j, k] * rays[j, k]
        across = slopes[j, 0] * flow0 + slopes[j, 1] * flow1 + slopes[j, 2] * flow2
        single_and_double[1 + j] = 0.0 if is_same else -(share * angle + height * across)


@numba.njit(parallel=True)
def assemble(corners, centres, reach, areas, corners2, centres2, reach2, slopes2, normals2, triangles2,
             vertices2, are_same, few, many):
    """Single layer (triangle, triangle) and double layer (triangle, vertex), both tested with constants."""
    single = np.zeros((len(corners), len(corners2)))
    double = np.zeros((len(corners), vertices2))
    for s in numba.prange(len(corners)):
        one = np.empty(4)
        x = np.empty(3)
        for t in range(len(corners2)):
            far = 0.0
            for k in range(3):
                far += (centres[s, k] - centres2[t, k]) ** 2
            points = many if far < (2 * (reach[s] + reach2[t])) ** 2 else few
            weight = areas[s] / len(points) / (4 * np.pi)
            same = are_same and s == t
            for n in range(len(points)):
                for k in range(3):
                    x[k] = (points[n, 0] * corners[s, 0, k] + points[n, 1] * corners[s, 1, k]
                            + points[n, 2] * corners[s, 2, k])
                layers_at(x, corners2[t], slopes2[t], normals2[t], same, one)
                single[s, t] += weight * one[0]
                for j in range(3):
                    double[s, triangles2[t, j]] += weight * one[1 + j]
    return single, double


class Surface:
    """Points (m), triangles counter-clockwise seen from outside."""

    def __init__(self, points, triangles):
        self.points, self.triangles = np.asarray(points, float), np.asarray(triangles, np.int64)
        self.corners = self.points[self.triangles]
        self.centres = self.corners.mean(axis=1)
        self.reach = np.linalg.norm(self.corners - self.centres[:, None], axis=2).max(axis=1)
        across = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        twice = np.linalg.norm(across, axis=1)
        self.areas, self.normals = twice / 2, across / twice[:, None]
        opposite = self.corners[:, [2, 0, 1]] - self.corners[:, [1, 2, 0]]
        self.slopes = np.cross(self.normals[:, None], opposite) / twice[:, None, None]
        self.curls = np.cross(self.normals[:, None], self.slopes)

    def between(self, other):
        return assemble(self.corners, self.centres, self.reach, self.areas, other.corners, other.centres,
                        other.reach, other.slopes, other.normals, other.triangles, len(other.points),
                        self is other, THREE_POINTS, subdivided(2))

    def slope_of_double(self, other, single):
        """-d/dn of the double layer, tested with linear functions: curls times the single layer."""
        density = single / self.areas[:, None] / other.areas[None]
        result = np.zeros((len(self.points), len(other.points)))
        mine, theirs = self.curls * self.areas[:, None, None], other.curls * other.areas[:, None, None]
        for axis in range(3):
            half = np.zeros((len(self.triangles), len(other.points)))
            for j in range(3):
                np.add.at(half.T, other.triangles[:, j], (density * theirs[:, j, axis]).T)
            for j in range(3):
                np.add.at(result, self.triangles[:, j], half * mine[:, j, axis, None])
        return result


class Solution:
    """Of surfaces from inside out and the conductivities within each."""

    def __init__(self, surfaces, conductivities):
        self.surfaces = surfaces
        inside = np.asarray(conductivities, float)
        outside = np.append(inside[1:], 0.0)
        count = len(surfaces)
        sizes = [n for s in surfaces for n in (len(s.points), len(s.triangles))][:-1]
        starts = np.concatenate([[0], np.cumsum(sizes)])
        matrix = np.zeros((starts[-1], starts[-1]))

        def place(kind, k):
            return slice(starts[2 * k + kind], starts[2 * k + kind + 1])

        for k in range(count):
            for other in range(max(0, k - 1), min(count, k + 2)):
                single, double = surfaces[k].between(surfaces[other])
                # the layer that the two surfaces share
                sigma = inside[k] + outside[k] if other == k else -inside[max(k, other)]
                inverse = 1 / inside[k] + 1 / max(outside[k], 1e-300) if other == k else -1 / inside[max(k, other)]
                sign = 2.0 if other == k else -1.0
                matrix[place(0, k), place(0, other)] += sigma * surfaces[k].slope_of_double(surfaces[other], single)
                if k + 1 < count:
                    matrix[place(1, k), place(0, other)] += sign * double
                    matrix[place(0, other), place(1, k)] += sign * double.T
                    if other + 1 < count:
                        matrix[place(1, k), place(1, other)] -= inverse * single
        skin = place(0, count - 1)
        matrix[skin, skin] += np.abs(matrix[skin, skin].diagonal()).mean() / sizes[-1]  # the mean is 0
        # of the inverse only the rows of the skin and the columns of the sources are wanted
        wanted = np.zeros((len(matrix), skin.stop - skin.start))
        wanted[skin] = np.eye(skin.stop - skin.start)
        self.transfer = np.linalg.solve(matrix.T, wanted)[:starts[2]]
        self.source = inside[0]

    def potentials(self, places, moments):
        """At all points of the outermost surface, one row a dipole."""
        inner = self.surfaces[0]
        weights = subdivided(3)
        points = np.einsum("pc,tck->tpk", weights, inner.corners)
        rows = []
        for place, moment in zip(places, moments):
            ray = points - place
            far = np.linalg.norm(ray, axis=2)
            along = ray @ moment
            potential = along / far ** 3 / (4 * np.pi * self.source)
            slope = (moment / far[..., None] ** 3 - 3 * (along / far ** 5)[..., None] * ray) / (4 * np.pi)
            current = np.einsum("tpk,tk->tp", slope, inner.normals)
            right = np.zeros(len(self.transfer))
            tested = np.einsum("tp,pc->tc", current, weights) * inner.areas[:, None] / len(weights)
            np.add.at(right, inner.triangles, -tested)
            # the second equation has its sign turned, so that the matrix is symmetric
            right[len(inner.points):] = potential.mean(axis=1) * inner.areas
            rows.append(right @ self.transfer)
        return np.array(rows)
