"""EEG potentials of any number of nested surfaces by boundary elements: linear collocation, as MNE solves
three surfaces, with the isolated problem approach [Hamalainen1989] on the skull's inside.

The coefficients (solid angles of linear elements) are MNE's; what is here is the system for N surfaces, which
mne.make_bem_solution refuses. OpenMEEG, whose symmetric method is better, is not in Debian.
"""
import mne
import numpy as np
from mne import bem as mne_bem


def surface(points, triangles, number=1):
    """A surface (m, outward) as MNE's functions take it."""
    return mne.surface.complete_surface_info(
        dict(rr=np.asarray(points, float), tris=np.asarray(triangles), np=len(points),
             ntri=len(triangles), id=number, coord_frame=5), copy=False, verbose=False)


class Solution:
    """Of surfaces from inside out (m) and the conductivities within each. The layer outside of surface
    `isolated` is the skull, far worse a conductor than what is within."""

    def __init__(self, surfaces, conductivities, isolated):
        self.points = np.concatenate([s["rr"] for s in surfaces])
        self.counts = [len(s["rr"]) for s in surfaces]
        self.source = conductivities[0]
        inside = np.asarray(conductivities, float)
        outside = np.append(inside[1:], 0.0)
        angles = -mne_bem._fwd_bem_lin_pot_coeff(surfaces)
        inner = sum(self.counts[:isolated + 1])
        self.inner, self.skull = inner, outside[isolated]
        cut = outside.copy()
        cut[isolated] = 0
        self.isolated_solution = self._inverse(angles[:inner, :inner], inside[:isolated + 1],
                                               cut[:isolated + 1], self.counts[:isolated + 1])
        self.isolated_scale = self._scale(inside[:isolated + 1], cut[:isolated + 1],
                                          self.counts[:isolated + 1])
        solution = self._inverse(angles, inside, outside, self.counts)
        # what the isolated potentials lack of the whole ones comes from the skull's inside alone
        last = slice(inner - self.counts[isolated], inner)
        source = self.skull / (4 * np.pi) * angles[:, last]
        source[last] -= self.skull / 2 * np.eye(self.counts[isolated])
        scale = self._scale(inside, outside, self.counts)
        self.rest = solution @ (scale[:, None] * source)
        self.last = last

    @staticmethod
    def _scale(inside, outside, counts):
        return np.repeat(2 / (inside + outside), counts)

    @staticmethod
    def _inverse(angles, inside, outside, counts):
        gamma = (inside - outside)[None, :] / (inside + outside)[:, None]
        matrix = angles * np.repeat(np.repeat(gamma, counts, axis=0), counts, axis=1) / (2 * np.pi)
        return np.linalg.inv(matrix + np.eye(len(matrix)) + 1 / len(matrix))

    def potentials(self, places, moments):
        """At all points of the outermost surface, one row a dipole."""
        rows = []
        for place, moment in zip(places, moments):
            ray = self.points[:self.inner] - place
            infinite = ray @ moment / (4 * np.pi * self.source * np.linalg.norm(ray, axis=1) ** 3)
            isolated = self.isolated_solution @ (self.isolated_scale * self.source * infinite)
            rows.append((self.rest @ isolated[self.last])[-self.counts[-1]:])
        return np.array(rows)


def at_electrodes(points, triangles, values, electrodes):
    """Values at points of a surface, linear in its triangles, where rays from the origin to the electrodes
    meet it."""
    corners = points[triangles]
    rows = []
    weights = []
    for electrode in electrodes:
        solved = np.linalg.solve(corners.transpose(0, 2, 1), np.tile(electrode, (len(corners), 1))[..., None])
        solved = solved[..., 0]
        hit = np.argmax(solved.min(axis=1))
        share = solved[hit] / solved[hit].sum()
        rows.append(triangles[hit])
        weights.append(share)
    return np.einsum("dek,ek->de", values[:, np.array(rows)], np.array(weights))
