#!/usr/bin/python3
"""What adaptive sizes are worth: the four layers that adaptiso-bem makes by default, against as many vertices spread
evenly over the surfaces, by symmetric boundary elements against the analytic series.

    adaptiveSpheres.py ADAPTISO-BEM FOLDER [--vertices N] [--radii R,R,R,R] [--dipoles N]

Makes an image (1 mm, partial volume) of four spheres (default 78, 80, 86, 92 mm), and two head models of it: with
--most-vertices N, and with --vertices of N / 4. Prints for each RDM and MAG, as layeredSphere.py has them, of dipoles of
random places and directions at 0.9, 0.95 and 0.98 of the innermost radius, and spread from 0.9 to 0.98; and how much
smaller the adaptive model's RDM is. N = 2568 takes 3 minutes and 1.2 GB.

Needs Debian's python3-numba, python3-nibabel.
"""
import argparse
import json
import subprocess
from pathlib import Path

import numpy as np

import layeredBem
import layeredSphere
import symmetricBem
from bemSpheres import scanner_points
from sphereImages import CENTRE, four_spheres

SURFACES = ("brain", "inner_skull", "outer_skull", "outer_skin")
PLACES = {"0.9": (0.9, 0.9), "0.95": (0.95, 0.95), "0.98": (0.98, 0.98), "0.9 to 0.98": (0.9, 0.98)}
ELECTRODES = 60


def measured(folder, layers, dipoles):
    """RDM and MAG, mean, for each of PLACES."""
    surfaces = []
    for name in SURFACES:
        points, triangles = scanner_points(folder / f"{name}.surf")
        surfaces.append(symmetricBem.Surface((points - CENTRE) / 1000, triangles))
    solution = symmetricBem.Solution(surfaces, layers.conductivities)
    electrodes = layeredSphere.spread_over_sphere(ELECTRODES, layers.radii[-1])
    rows = []
    for nearest, farthest in PLACES.values():
        random = np.random.RandomState(11)
        directions = layeredSphere.random_directions(dipoles, random)
        moments = layeredSphere.random_directions(dipoles, random)
        places = random.uniform(nearest, farthest, (dipoles, 1)) * layers.radii[0] * directions
        truth = layeredSphere.potentials(layers, places, moments, electrodes, terms=600)
        values = solution.potentials(places, moments)
        found = layeredBem.at_electrodes(surfaces[-1].points, surfaces[-1].triangles, values, electrodes)
        rows.append([part.mean() for part in layeredSphere.rdm_and_mag(found, truth)])
    return np.array(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--vertices", type=int, default=2568)
    parser.add_argument("--radii", default="78,80,86,92")
    parser.add_argument("--dipoles", type=int, default=200)
    options = parser.parse_args()
    radii = tuple(float(r) / 1000 for r in options.radii.split(","))
    layers = layeredSphere.Layers(radii, layeredSphere.FOUR.conductivities)
    options.folder.mkdir(parents=True, exist_ok=True)
    image = four_spheres(options.folder, "partial", radii)
    rows = []
    for name, sizes in (("even", ("--vertices", options.vertices // 4)),
                        ("adaptive", ("--most-vertices", options.vertices))):
        folder = options.folder / name
        subprocess.run([options.program, *image, "--layers", "4", "-o", folder, "--force", "--quiet",
                        "--no-warnings", *map(str, sizes)], check=True)
        report = json.loads((folder / "report.json").read_text())
        rows.append(measured(folder, layers, options.dipoles))
        print(f"{name:9} {[s['vertices'] for s in report['surfaces']]}  " +
              "; ".join(f"{place}: {r:.4f} / {m:.3f}" for place, (r, m) in zip(PLACES, rows[-1])), flush=True)
    gains = 100 * (1 - rows[1][:, 0] / rows[0][:, 0])
    print("RDM smaller by " + "; ".join(f"{place}: {gain:.0f} %" for place, gain in zip(PLACES, gains)))


if __name__ == "__main__":
    main()
