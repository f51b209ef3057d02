#!/usr/bin/env python3
"""Draws where the surfaces of a head model cut three orthogonal slices of an image.

drawContours.py IMAGE MODEL-FOLDER OUT.png [X Y Z]      (a point in scanner RAS mm; the image's
middle when none is given). The surfaces are read from the folder's .surf files, through their
footers; needs python3-nibabel and python3-matplotlib.
"""
import sys
from pathlib import Path

import matplotlib
import nibabel
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of a screenless backend)

COLOURS = {"inner_skull": "#ff4040", "outer_skull": "#ffd020", "outer_skin": "#40c0ff"}


def scanner_points(path):
    """Points in scanner RAS, and triangles."""
    points, triangles, info = nibabel.freesurfer.read_geometry(path, read_metadata=True)
    axes = np.array([info["xras"], info["yras"], info["zras"]]).T
    size, spacing = np.array(info["volume"]), np.array(info["voxelsize"])
    to_scanner = np.eye(4)
    to_scanner[:3, :3] = axes * spacing
    to_scanner[:3, 3] = np.array(info["cras"]) - to_scanner[:3, :3] @ (size / 2)
    dx, dy, dz = spacing
    nx, ny, nz = size
    to_tkras = np.array([[-dx, 0, 0, dx * nx / 2], [0, 0, dz, -dz * nz / 2],
                         [0, -dy, 0, dy * ny / 2], [0, 0, 0, 1]])
    move = to_scanner @ np.linalg.inv(to_tkras)
    return points @ move[:3, :3].T + move[:3, 3], triangles


def contour(points, triangles, axis, at):
    """Line segments where the surface meets the plane coordinate[axis] == at."""
    segments = []
    height = points[:, axis] - at
    crossed = triangles[(np.sign(height[triangles]).min(1) < 0) &
                        (np.sign(height[triangles]).max(1) > 0)]
    for triangle in crossed:
        ends = []
        for a, b in ((0, 1), (1, 2), (2, 0)):
            i, j = triangle[a], triangle[b]
            if (height[i] < 0) != (height[j] < 0):
                part = height[i] / (height[i] - height[j])
                ends.append(points[i] + part * (points[j] - points[i]))
        segments.append(np.delete(np.array(ends[:2]), axis, axis=1))
    return segments


def slice_of(image, axis, at, low, high):
    """The image on a 1 mm lattice of the plane, nearest voxel."""
    others = [a for a in range(3) if a != axis]
    u, v = (np.arange(low[a], high[a], 0.5) for a in others)
    grid = np.zeros((len(v), len(u), 3))
    grid[..., axis] = at
    grid[..., others[0]], grid[..., others[1]] = np.meshgrid(u, v)
    inverse = np.linalg.inv(image.affine)
    index = np.rint(grid @ inverse[:3, :3].T + inverse[:3, 3]).astype(int)
    data = np.asanyarray(image.dataobj)
    inside = np.all((index >= 0) & (index < data.shape[:3]), axis=2)
    index[~inside] = 0
    values = np.where(inside, data[tuple(index[..., a] for a in range(3))], 0)
    return values, (u[0], u[-1], v[0], v[-1])


def main(image_path, folder, out, point=None):
    image = nibabel.load(image_path)
    shape = np.array(image.shape[:3])
    corners = np.array([[i, j, k, 1] for i in (0, 1) for j in (0, 1) for k in (0, 1)]) * [*(shape - 1), 1]
    ras = (corners @ image.affine.T)[:, :3]
    low, high = ras.min(0) - 15, ras.max(0) + 15
    point = point or list((ras.min(0) + ras.max(0)) / 2)
    surfaces = {name: scanner_points(Path(folder) / f"{name}.surf") for name in COLOURS
                if (Path(folder) / f"{name}.surf").exists()}
    figure, panels = plt.subplots(1, 3, figsize=(21, 8), facecolor="black")
    for axis, panel in enumerate(panels):
        values, extent = slice_of(image, axis, point[axis], low, high)
        panel.imshow(values, origin="lower", cmap="gray", extent=extent,
                     vmax=np.percentile(values, 99.5) or 1)
        for name, (points, triangles) in surfaces.items():
            for segment in contour(points, triangles, axis, point[axis]):
                panel.plot(segment[:, 0], segment[:, 1], color=COLOURS[name], linewidth=1.2)
        panel.set_title(f"{'xyz'[axis]} = {point[axis]:.0f} mm RAS", color="white")
        panel.tick_params(colors="white")
    figure.tight_layout()
    figure.savefig(out, dpi=70, facecolor="black")


if __name__ == "__main__":
    if len(sys.argv) not in (4, 7):
        sys.exit(__doc__)
    main(*sys.argv[1:4], [float(a) for a in sys.argv[4:7]] or None)
