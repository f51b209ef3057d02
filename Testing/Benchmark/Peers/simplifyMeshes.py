#!/usr/bin/python3
"""Any mesh with fewer triangles: this library beside vtkQuadricDecimation and meshoptimizer.

  simplifyMeshes.py [-o FOLDER] [--repeats N] [--only NAME ...]

Makes the meshes (marching cubes of ch2 as it is, and with 0.3 mm of jitter; a sphere), simplifies
each to a tenth of its triangles, and within a thousandth of its diagonal, by every method in turn in
processes of their own, and writes a table in Markdown to standard output, all figures to
FOLDER/simplify.json. Distances are adaptiso-compare's, defects adaptiso-check's.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys

import numpy as np

TOP = pathlib.Path(__file__).resolve().parents[3]
HEAD = "/usr/share/mricron/templates/ch2.nii.gz"
METHODS = ("adaptiso", "quadric", "meshoptimizer")


def write_ply(path, points, triangles):
    rows = np.zeros(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, triangles
    with open(path, "wb") as file:
        file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
                    "property double x\nproperty double y\nproperty double z\n"
                    f"element face {len(triangles)}\nproperty list uchar int vertex_indices\n"
                    "end_header\n").encode())
        file.write(points.astype("<f8").tobytes())
        file.write(rows.tobytes())


def sphere(steps, radius=100.0):
    """An octahedron whose faces are cut into steps x steps triangles, blown up."""
    corners = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    points, triangles, first = [], [], 0
    for face in faces:
        i, j = np.nonzero(np.add.outer(np.arange(steps + 1), np.arange(steps + 1)) <= steps)
        number = np.full((steps + 2, steps + 2), -1)
        number[i, j] = np.arange(len(i)) + first
        points.append((steps - i - j)[:, None] * corners[face[0]] + i[:, None] * corners[face[1]]
                      + j[:, None] * corners[face[2]])
        up, down = i + j < steps, i + j < steps - 1
        triangles.append(np.stack([number[i, j], number[i + 1, j], number[i, j + 1]], 1)[up])
        triangles.append(np.stack([number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]],
                                  1)[down])
        first += len(i)
    points, same = np.unique(np.concatenate(points), axis=0, return_inverse=True)
    return (radius * points / np.linalg.norm(points, axis=1)[:, None],
            same.reshape(-1)[np.concatenate(triangles)])


def jittered(source, target, amount):
    import vtkmodules.vtkIOPLY as ply
    from vtkmodules.util.numpy_support import vtk_to_numpy
    reader = ply.vtkPLYReader()
    reader.SetFileName(str(source))
    reader.Update()
    data = reader.GetOutput()
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    random = np.random.default_rng(1)
    write_ply(target, points + amount * random.uniform(-1, 1, points.shape), triangles)


def call(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if not done.stdout:
        raise RuntimeError(f"{command[0]}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def make_meshes(folder, programs, only):
    head = folder / "head.ply"
    if not head.exists():
        subprocess.run([programs / "adaptiso-mesh", HEAD, "--iso", "100", "--method", "mc",
                        "--coordinates", "lps", "-o", head, "--quiet"],
                       check=True, stdout=subprocess.DEVNULL)
    if not (folder / "noisy.ply").exists():
        jittered(head, folder / "noisy.ply", 0.3)
    if not (folder / "sphere.ply").exists():
        write_ply(folder / "sphere.ply", *sphere(404))
    return [folder / f"{name}.ply" for name in ("head", "noisy", "sphere")
            if only is None or name in only]


def facts_of(mesh, made, programs):
    distances = call(programs / "adaptiso-compare", mesh, made, "--json", "-",
                     "--quiet")["distances"]["combined"]
    surface = call(programs / "adaptiso-check", made, "--json", "-", "--quiet",
                   "--profile", "view")["surfaces"][0]
    return {"mean": distances["meanMm"], "max": distances["maxMm"], "check": surface["checks"]}


def measure(mesh, programs, peer, options, methods, repeats):
    results = {method: [] for method in methods}
    for repeat in range(repeats):
        for method in methods if repeat % 2 == 0 else methods[::-1]:
            made = mesh.with_name(f"{mesh.stem}-{method}.ply")
            results[method].append(call(peer, mesh, "--method", method, *options, "-o", made))
    rows = []
    for method, runs in results.items():
        made = mesh.with_name(f"{mesh.stem}-{method}.ply")
        rows.append({"mesh": mesh.stem, "method": method, "options": [str(o) for o in options],
                     "triangles": runs[0]["triangles"], "before": runs[0]["before"],
                     "seconds": [run["seconds"] for run in runs],
                     "cpuSeconds": [run["cpuSeconds"] for run in runs],
                     **facts_of(mesh, made, programs)})
    return rows


def table(rows):
    print("| mesh | asked for | method | triangles | seconds | processor | mean | largest |")
    print("|---|---|---|---|---|---|---|---|")
    for row in rows:
        print(f"| {row['mesh']}, {row['before']:,} | {' '.join(row['options'])} | {row['method']} | "
              f"{row['triangles']:,} | {statistics.median(row['seconds']):.2f} | "
              f"{statistics.median(row['cpuSeconds']):.2f} | {row['mean']:.4f} | "
              f"{row['max']:.3f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=pathlib.Path, default=TOP / "out" / "simplify")
    parser.add_argument("--build", type=pathlib.Path, default=TOP / "build" / "benchmark")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--only", nargs="+", choices=["head", "noisy", "sphere"])
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    programs = arguments.build / "bin"
    peer = arguments.build / "Testing" / "Benchmark" / "Peers" / "peerSimplify"
    rows = []
    for mesh in make_meshes(arguments.output, programs, arguments.only):
        size = call(programs / "adaptiso-compare", mesh, mesh, "--samples", "1000", "--json", "-",
                    "--quiet")["a"]
        count = size["triangles"] // 10
        rows += measure(mesh, programs, peer, ["--triangles", count], METHODS, arguments.repeats)
        bound = size["boundingBoxDiagonalMm"] / 1000
        rows += measure(mesh, programs, peer, ["--max-error", f"{bound:.4g}"], METHODS[::2],
                        arguments.repeats)
        print(f"{mesh.stem}: done", file=sys.stderr, flush=True)
    (arguments.output / "simplify.json").write_text(json.dumps(rows, indent=1) + "\n")
    table(rows)


if __name__ == "__main__":
    main()
