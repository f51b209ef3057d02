#!/usr/bin/python3
"""voronoiLabels.py FILE SIDE REGIONS   a label map of SIDE^3 voxels of 1 mm: cells of REGIONS jittered seeds (one for each
cell of a coarse lattice, more or less), bent by smooth noise. The same numbers give the same map."""
import sys

import nibabel as nib
import numpy as np
from scipy.spatial import cKDTree


def jitteredSeeds(side, regions, rng):
    """Seeds in a box of side^3, one in each cell of a lattice; what is too many is left out at random."""
    cells = int(np.ceil(regions ** (1 / 3)))
    corners = np.stack(np.meshgrid(*[np.arange(cells)] * 3, indexing="ij"), -1).reshape(-1, 3)
    seeds = (corners + rng.uniform(0.1, 0.9, corners.shape)) * side / cells
    return seeds[np.sort(rng.permutation(len(seeds))[:regions])]


def bend(points, waves):
    """Points moved by a few waves of some 40 voxels, up to some voxels."""
    moved = points.copy()
    for direction, phase, way in waves:
        moved += np.sin(points @ direction + phase)[:, None] * way
    return moved


def main():
    path, side, regions = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    rng = np.random.default_rng(1)
    tree = cKDTree(jitteredSeeds(side, regions, rng))
    waves = [(rng.normal(0, 0.12, 3), rng.uniform(0, 6.28), rng.normal(0, 1.2, 3)) for _ in range(8)]
    labels = np.zeros((side, side, side), np.int16, order="F")
    j, i = np.meshgrid(np.arange(side), np.arange(side))
    for k in range(side):
        points = np.stack([i.ravel(), j.ravel(), np.full(i.size, k)], -1).astype(float)
        labels[:, :, k] = tree.query(bend(points, waves))[1].reshape(side, side) + 1
    image = nib.Nifti1Image(labels, np.eye(4))
    image.header.set_intent("label")
    nib.save(image, path)


if __name__ == "__main__":
    main()
