"""positions.py ADAPTISO-BEM FOLDER: four positions of Debian's ch2 (mricron-data), by header and by resampling, each as a model
of 2,562 vertices without a mask, moved back and compared by adaptiso-compare with that of ch2 as it is. Prints a table of
distances, mm: mean, of 95 of 100 places, largest. Needs Debian's python3-nibabel and python3-scipy. 2 min of processor time."""

import json
import subprocess
import sys
from pathlib import Path

import nibabel
import numpy as np
from scipy import ndimage

from runHeads import scanner_points

SURFACES = ("inner_skull", "outer_skull", "outer_skin")


def turned(x, z):
    """By degrees about two axes."""
    (c, s), (d, t) = ((np.cos(a), np.sin(a)) for a in np.radians((x, z)))
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(((1, 0, 0), (0, c, -s), (0, s, c))) @ np.array(((d, -t, 0), (t, d, 0), (0, 0, 1)))
    return matrix


def shifted(*mm):
    matrix = np.eye(4)
    matrix[:3, 3] = mm
    return matrix


def resampled(image, grid):
    """The image on another grid of 1 mm, with room for all of it. \\return  samples, affine"""
    affine = grid @ image.affine @ shifted(-20, -20, -20)
    voxels = np.indices(np.array(image.shape) + 40).reshape(3, -1)
    back = np.linalg.inv(image.affine) @ affine
    places = back[:3, :3] @ voxels + back[:3, 3:]
    samples = ndimage.map_coordinates(np.asarray(image.dataobj, np.float32), places, order=1)
    return samples.reshape(np.array(image.shape) + 40), affine


def model(program, folder, samples, affine):
    folder.mkdir(parents=True, exist_ok=True)
    nibabel.save(nibabel.Nifti1Image(samples, affine), folder / "t1.nii.gz")
    subprocess.run([program, "--t1", folder / "t1.nii.gz", "-o", folder / "model", "--force", "--quiet", "--no-warnings"], check=True)


def write_off(path, surface, move):
    points, triangles = scanner_points(surface)
    points = points @ move[:3, :3].T + move[:3, 3]
    with open(path, "w") as out:
        out.write(f"OFF\n{len(points)} {len(triangles)} 0\n")
        np.savetxt(out, points, fmt="%.6f")
        np.savetxt(out, np.column_stack([np.full(len(triangles), 3), triangles]), fmt="%d")


def main():
    program, work = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    image = nibabel.load("/usr/share/mricron/templates/ch2.nii.gz")
    samples = np.asarray(image.dataobj, np.float32)
    cases = {"as it is": (samples, image.affine, np.eye(4))}
    for name, move in (("shifted by its header", shifted(37.3, -12.1, 8.8)), ("tilted by its header", turned(20, 10))):
        cases[name] = (samples, move @ image.affine, move)
    for name, grid in (("on a grid half a voxel off", shifted(0.5, 0.5, 0.5)), ("on a grid turned by 12 and 8 degrees", turned(12, 8))):
        cases[name] = (*resampled(image, grid), np.eye(4))
    for name, (data, affine, move) in cases.items():
        folder = work / name.replace(" ", "-")
        model(program, folder, data, affine)
        row = []
        for surface in SURFACES:
            write_off(folder / f"{surface}.off", folder / "model" / f"{surface}.surf", np.linalg.inv(move))
            done = subprocess.run([program.with_name("adaptiso-compare"), folder / f"{surface}.off", work / f"as-it-is/{surface}.off",
                                   "--json", "-", "--quiet"], check=True, text=True, capture_output=True)
            off = json.loads(done.stdout)["distances"]["aToB"]
            row.append(", ".join(f"{off[key]:.2f}" for key in ("meanMm", "p95Mm", "maxMm")))
        print(f"| {name} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
