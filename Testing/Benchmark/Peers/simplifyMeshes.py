#!/usr/bin/python3
"""Any mesh with fewer triangles: this library beside vtkQuadricDecimation and meshoptimizer.

  simplifyMeshes.py [-o FOLDER] [--repeats N] [--only NAME ...]

Makes the meshes of simplifiedMeshes.py (four minutes the first time), simplifies each to a tenth of
its triangles, and within a thousandth of its diagonal, by every method in turn in processes of
their own, and writes a table in Markdown to standard output, all figures to FOLDER/simplify.json.
Distances are adaptiso-compare's; "VTK" is the largest that vtkCellLocator finds from 100,000 random
points of each surface to the other. Defects are adaptiso-check's: open edges, edges with more than
two triangles, vertices that are no fan, pairs that cross, triangles twice or without area.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys

import numpy as np

from simplifiedMeshes import NAMES, Maker, read_ply

TOP = pathlib.Path(__file__).resolve().parents[3]
METHODS = ("adaptiso", "quadric", "meshoptimizer")
SAMPLES = 100_000


def call(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if not done.stdout:
        raise RuntimeError(f"{command[0]}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def random_points(points, triangles, random):
    corners = points[triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]),
                           axis=1)
    chosen = corners[random.choice(len(triangles), SAMPLES, p=areas / areas.sum())]
    u, v = random.uniform(0, 1, (2, SAMPLES, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return chosen[:, 0] + u * (chosen[:, 1] - chosen[:, 0]) + v * (chosen[:, 2] - chosen[:, 0])


def farthest_from(path, samples):
    """Of samples from a surface, by VTK."""
    import vtkmodules.vtkCommonDataModel as model
    import vtkmodules.vtkIOPLY as ply
    from vtkmodules.vtkCommonCore import mutable
    reader = ply.vtkPLYReader()
    reader.SetFileName(str(path))
    reader.Update()
    locator = model.vtkCellLocator()
    locator.SetDataSet(reader.GetOutput())
    locator.BuildLocator()
    nearest, cell, part, squared = [0.0, 0.0, 0.0], mutable(0), mutable(0), mutable(0.0)
    largest = 0.0
    for sample in samples:
        locator.FindClosestPoint(sample, nearest, cell, part, squared)
        largest = max(largest, squared.get())
    return largest ** 0.5


def farthest(mesh, made):
    random = np.random.default_rng(2)
    return max(farthest_from(made, random_points(*read_ply(mesh), random)),
               farthest_from(mesh, random_points(*read_ply(made), random)))


def defects_of(made, programs):
    surface = call(programs / "adaptiso-check", made, "--json", "-", "--quiet", "--profile",
                   "view")["surfaces"][0]
    found = surface["selfIntersections"]
    defects = {kind: count for kind, count in surface["defects"].items() if kind != "unusedVertex"}
    return {**defects, "crossingPairs": found["pairCount"] if found else 0}


def facts_of(mesh, made, programs):
    distances = call(programs / "adaptiso-compare", mesh, made, "--json", "-",
                     "--quiet")["distances"]["combined"]
    return {"mean": distances["meanMm"], "max": distances["maxMm"],
            "vtkMax": farthest(mesh, made), "defects": defects_of(made, programs)}


def measure(mesh, programs, peer, options, methods, repeats):
    results = {method: [] for method in methods}
    for repeat in range(repeats):
        for method in methods if repeat % 2 == 0 else methods[::-1]:
            made = mesh.with_name(f"{mesh.stem}-{method}.ply")
            results[method].append(call(peer, mesh, "--method", method, *options, "-o", made))
    rows = []
    for method, runs in results.items():
        made = mesh.with_name(f"{mesh.stem}-{method}.ply")
        heap = call(peer, mesh, "--method", method, *options, "--meter-heap")
        rows.append({"mesh": mesh.stem, "method": method, "options": [str(o) for o in options],
                     "triangles": runs[0]["triangles"], "before": runs[0]["before"],
                     "seconds": [run["seconds"] for run in runs],
                     "cpuSeconds": [run["cpuSeconds"] for run in runs],
                     "bytesPerTriangle": heap["bytesPerTriangle"],
                     **facts_of(mesh, made, programs)})
    return rows


def ratio(row, rows, method, what="seconds"):
    """Median over the repeats, beside another method's run of the same mesh."""
    for other in rows:
        if (other["mesh"], other["options"], other["method"]) == (row["mesh"], row["options"],
                                                                  method):
            return f"{statistics.median(a / b for a, b in zip(row[what], other[what])):.2f}"
    return "-"


def table(rows):
    print("| mesh | asked for | method | triangles | s | CPU s | x meshoptimizer | x quadric | "
          "mean | largest | VTK | defects | bytes a triangle |")
    print("|---|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|")
    for row in rows:
        print(f"| {row['mesh']}, {row['before']:,} | {' '.join(row['options'])} | {row['method']} | "
              f"{row['triangles']:,} | {statistics.median(row['seconds']):.2f} | "
              f"{statistics.median(row['cpuSeconds']):.2f} | "
              f"{ratio(row, rows, 'meshoptimizer')} | {ratio(row, rows, 'quadric')} | "
              f"{row['mean']:.4f} | {row['max']:.3f} | {row['vtkMax']:.3f} | "
              f"{sum(row['defects'].values()):,} | {row['bytesPerTriangle']:.0f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=pathlib.Path, default=TOP / "out" / "simplify")
    parser.add_argument("--build", type=pathlib.Path, default=TOP / "build" / "benchmark")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--only", nargs="+", choices=NAMES, default=NAMES)
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=METHODS)
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    programs = arguments.build / "bin"
    peers = arguments.build / "Testing" / "Benchmark" / "Peers"
    maker = Maker(arguments.output, programs, peers / "remeshEvenly")
    rows = []
    for name in arguments.only:
        mesh = maker.path(name)
        size = call(programs / "adaptiso-compare", mesh, mesh, "--samples", "1000", "--json", "-",
                    "--quiet")["a"]
        asked = (["--triangles", size["triangles"] // 10],
                 ["--max-error", f"{size['boundingBoxDiagonalMm'] / 1000:.4g}"])
        for options in asked:
            # the peer has no limit of error
            methods = [m for m in arguments.methods if options is asked[0] or m != "quadric"]
            rows += measure(mesh, programs, peers / "peerSimplify", options, methods,
                            arguments.repeats)
        print(f"{mesh.stem}: done, load {os.getloadavg()[0]:.0f}", file=sys.stderr, flush=True)
        (arguments.output / "simplify.json").write_text(json.dumps(rows, indent=1) + "\n")
    table(rows)


if __name__ == "__main__":
    main()
