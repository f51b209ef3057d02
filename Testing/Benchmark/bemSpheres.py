#!/usr/bin/python3
"""Three spheres through the whole of adaptiso-bem, and what their surfaces are worth.

    bemSpheres.py ADAPTISO-BEM FOLDER [--vertices N]

Makes images of spheres of 80, 86 and 92 mm in voxels of 1 mm, centre off the lattice: labels
(`binary`) and tissue probabilities (`partial`, parts of voxels by counting 10^3 points). Makes head
models of them, prints how far the vertices lie off the spheres and the triangles' smallest
angles, and puts the surfaces, centred, where solveSpheres.py finds them:

    solveSpheres.py FOLDER/binary FOLDER/partial

Needs Debian's python3-mne and python3-nibabel.
"""
import argparse
import json
import subprocess
from pathlib import Path

import mne
import nibabel
import numpy as np

from sphereImages import CENTRE, part_of_ball, save

NAMES = ("inner_skull", "outer_skull", "outer_skin")
RADII = (80, 86, 92)


def images(folder, name):
    """Writes the images. returns adaptiso-bem's arguments"""
    if name == "binary":
        labels = sum(part_of_ball(r, 1) for r in RADII).astype(np.uint8)
        save(folder / "labels.nii.gz", labels)
        return ["--labels", folder / "labels.nii.gz", "--tissue", "brain=3", "--tissue", "skull=2",
                "--tissue", "scalp=1"]
    inner, outer, skin = (part_of_ball(r, 10) for r in RADII)
    maps = (0.4 * inner, 0.4 * inner, 0.2 * inner, outer - inner, skin - outer)
    files = [folder / f"c{n + 1}.nii.gz" for n in range(5)]
    for file, values in zip(files, maps):
        save(file, values.astype(np.float32))
    return ["--probabilities", *files]


def scanner_points(path):
    """Points of a .surf in scanner RAS by its footer, as nibabel reads it, and triangles."""
    points, triangles, info = nibabel.freesurfer.read_geometry(path, read_metadata=True)
    header = nibabel.freesurfer.MGHImage(np.zeros(info["volume"], np.uint8), np.eye(4)).header
    header["delta"] = info["voxelsize"]
    header["Mdc"] = np.array([info["xras"], info["yras"], info["zras"]])
    header["Pxyz_c"] = info["cras"]
    move = header.get_vox2ras() @ np.linalg.inv(header.get_vox2ras_tkr())
    return points @ move[:3, :3].T + move[:3, 3], triangles


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--vertices", default="642")
    options = parser.parse_args()
    print(f"{'image':8} {'surface':12} {'radius error: mean':>18} {'largest':>8} "
          f"{'angle: p5':>10} {'smallest':>8}")
    for name in ("binary", "partial"):
        folder = options.folder / name
        (folder / "bem").mkdir(parents=True, exist_ok=True)
        subprocess.run([options.program, *images(folder, name), "--vertices", options.vertices,
                        "-o", folder / "model", "--force", "--quiet"], check=True)
        report = json.loads((folder / "model" / "report.json").read_text())
        for surface, radius, facts in zip(NAMES, RADII, report["surfaces"]):
            points, triangles = scanner_points(folder / "model" / f"{surface}.surf")
            off = np.linalg.norm(points - CENTRE, axis=1) - radius
            angles = facts["minAngleDeg"]
            print(f"{name:8} {surface:12} {np.abs(off).mean():15.3f} mm {np.abs(off).max():5.2f} mm"
                  f" {angles['p5']:10.1f} {angles['minimum']:8.1f}", flush=True)
            mne.write_surface(folder / "bem" / f"{surface}.surf", points - CENTRE, triangles,
                              overwrite=True)


if __name__ == "__main__":
    main()
