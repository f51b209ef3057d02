#!/usr/bin/python3
"""What adaptive sizes are worth: the four layers that adaptiso-bem makes by default, against as many vertices in edges of
one length, and against as many spread evenly over the surfaces, by symmetric boundary elements.

    adaptiveSpheres.py ADAPTISO-BEM FOLDER [--vertices N] [--radii R,R,R,R] [--dipoles N] [--offsets O,O,O,O]

Makes an image (1 mm, partial volume) of four spheres (default 78, 80, 86, 92 mm), and three head models of it: with
--vertices in proportion to the spheres' areas, with --vertices of N / 4, and with --most-vertices N. Prints for each RDM and
MAG, as layeredSphere.py has them, of dipoles of random places and directions at 0.9, 0.925, 0.95 and 0.98 of the innermost
radius, the mean of these, and spread from 0.9 to 0.98; and how much smaller the adaptive model's RDM is than the others'.
The truth is the analytic series; with --offsets (mm that each sphere's centre lies below the middle, so that layers are
thin above and thick below) a model of 2,568 vertices, 642 a sphere. N = 1284 takes 2 minutes, N = 2568 or offsets 5.

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
SINGLE = (0.9, 0.925, 0.95, 0.98)
SPREAD = (0.9, 0.98)
TRUTH = (642, 642, 642, 642)
ELECTRODES = 60


def dipoles_at(nearest, farthest, options):
    random = np.random.RandomState(11)
    directions = layeredSphere.random_directions(options.dipoles, random)
    moments = layeredSphere.random_directions(options.dipoles, random)
    from_centre = random.uniform(nearest, farthest, (options.dipoles, 1)) * options.layers.radii[0] * directions
    return from_centre - [0, 0, options.offsets[0]], moments


def all_dipoles(options):
    return [dipoles_at(*limits, options) for limits in [(e, e) for e in SINGLE] + [SPREAD]]


def solved(folder, options):
    """Potentials at the electrodes, an array for each of SINGLE, and for SPREAD."""
    surfaces = []
    for name in SURFACES:
        points, triangles = scanner_points(folder / f"{name}.surf")
        surfaces.append(symmetricBem.Surface((points - CENTRE) / 1000, triangles))
    solution = symmetricBem.Solution(surfaces, options.layers.conductivities)
    electrodes = layeredSphere.spread_over_sphere(ELECTRODES, options.layers.radii[-1])
    return [layeredBem.at_electrodes(surfaces[-1].points, surfaces[-1].triangles, solution.potentials(*dipoles), electrodes)
            for dipoles in all_dipoles(options)]


def model(name, image, sizes, options):
    """Makes it. returns the potentials, and the numbers of vertices"""
    folder = options.folder / name
    subprocess.run([options.program, *image, "--layers", "4", "-o", folder, "--force", "--quiet",
                    "--no-warnings", *map(str, sizes)], check=True)
    report = json.loads((folder / "report.json").read_text())
    return solved(folder, options), [surface["vertices"] for surface in report["surfaces"]]


def truth(image, options):
    if any(options.offsets):
        return model("truth", image, ("--vertices", ",".join(map(str, TRUTH))), options)[0]
    electrodes = layeredSphere.spread_over_sphere(ELECTRODES, options.layers.radii[-1])
    return [layeredSphere.potentials(options.layers, *dipoles, electrodes, terms=600) for dipoles in all_dipoles(options)]


def in_metres(text):
    return tuple(float(mm) / 1000 for mm in text.split(","))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--vertices", type=int, default=1284)
    parser.add_argument("--radii", type=in_metres, default=layeredSphere.FOUR.radii)
    parser.add_argument("--offsets", type=in_metres, default=(0, 0, 0, 0))
    parser.add_argument("--dipoles", type=int, default=200)
    options = parser.parse_args()
    options.layers = layeredSphere.Layers(options.radii, layeredSphere.FOUR.conductivities)
    options.folder.mkdir(parents=True, exist_ok=True)
    image = four_spheres(options.folder, "partial", options.radii, options.offsets)
    exact = truth(image, options)
    areas = np.array(options.radii) ** 2
    shares = [int(round(n)) for n in options.vertices * areas / areas.sum()]
    places = [str(e) for e in SINGLE] + ["0.9 to 0.98", "mean"]
    rows = {}
    for name, sizes in (("one length", ("--vertices", ",".join(map(str, shares)))),
                        ("even", ("--vertices", options.vertices // 4)),
                        ("adaptive", ("--most-vertices", options.vertices))):
        found, vertices = model(name.replace(" ", "-"), image, sizes, options)
        pairs = [layeredSphere.rdm_and_mag(*both) for both in zip(found, exact)]
        rows[name] = np.array([[part.mean() for part in pair] for pair in pairs])
        rows[name] = np.vstack([rows[name], rows[name][:len(SINGLE)].mean(axis=0)])
        print(f"{name:10} {vertices}  " +
              "; ".join(f"{place}: {r:.4f} / {m:.3f}" for place, (r, m) in zip(places, rows[name])), flush=True)
    for name in ("one length", "even"):
        gains = 100 * (1 - rows["adaptive"][:, 0] / rows[name][:, 0])
        print(f"RDM smaller than with {name} by " +
              "; ".join(f"{place}: {gain:.0f} %" for place, gain in zip(places, gains)))


if __name__ == "__main__":
    main()
