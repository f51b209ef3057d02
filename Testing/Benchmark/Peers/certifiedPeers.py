#!/usr/bin/python3
"""One surface with fewer triangles, by this library and by others; distances are adaptiso-compare's intervals.

  certifiedPeers.py FOLDER [--scan NIFTI] [--iso V] [--bound MM] [--repeats N] [--debian13 ROOT]

The surface is that of marching cubes, its largest piece with cavities filled. Those that take a bound get --bound,
the others as many triangles as adaptiso-mesh makes within it. All run in turn, in processes of their own. Seconds are
the processor's (user and system), medians; of adaptiso-mesh with reading, proof, checks and writing, of niimath with
reading and writing, of the others without. CGAL runs once; what FOLDER has of it stays. A table in Markdown goes to
standard output, all figures to FOLDER/certified.json.

manifold and niimath, which has nii2mesh's chain, run where FOLDER has them (`npm install manifold-3d @niivue/niimath`),
VTK 9.3 and SurfaceNets where ROOT is a Debian 13 with python3-vtk9 (`debootstrap --variant=minbase trixie ROOT`, then
apt-get in a chroot); needs root.
"""
import argparse
import json
import pathlib
import resource
import shutil
import statistics
import subprocess
import sys

import nibabel
import numpy as np
from scipy import ndimage

HERE = pathlib.Path(__file__).resolve().parent
BUILD = HERE.parents[2] / "build" / "benchmark"
PEERS, PROGRAMS = BUILD / "Testing" / "Benchmark" / "Peers", BUILD / "bin"
MODERN = "peerVtkPython.py"
CGAL = "CGAL, edge collapse in an envelope"
NIIMATH = "niimath -mesh (nii2mesh), as WebAssembly"
FORMATS = {CGAL: "vtp", "manifold": "off", NIIMATH: "off"}  # of their outputs


def call(*command, **where):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **where)
    if not done.stdout:
        raise RuntimeError(f"{command[0]}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Bench:
    def __init__(self, arguments):
        self.folder, self.bound, self.root = arguments.folder, arguments.bound, arguments.debian13
        self.scan, self.iso = arguments.scan, arguments.iso
        self.count = None
        self.full = self.path("full.ply")
        self.full_count = self.mesh("--method", "mc", "-o", self.full)["triangles"]

    def path(self, name):
        return self.folder / name

    def mesh(self, *options):
        began = processor_time()
        report = call(PROGRAMS / "adaptiso-mesh", self.scan, "--iso", self.iso, "--largest", "--fill-cavities",
                      "--json", "-", *options)
        return {"cpuSeconds": processor_time() - began, "triangles": report["surfaces"][0]["triangles"]}

    def ours(self, out, threads=1):
        made = self.mesh("--max-error", self.bound, "--threads", threads, "-o", out)
        self.count = made["triangles"]
        return made

    def simplify(self, out, method, *aim, threads=1):
        return call(PEERS / "peerSimplify", self.full, "--method", method, "--threads", threads, *aim, "-o", out)

    def library(self, out, threads=1):
        return self.simplify(out, "adaptiso", "--max-error", self.bound, threads=threads)

    def quadric(self, out):
        return self.simplify(out, "quadric", "--triangles", self.count)

    def meshoptimizer(self, out):
        return self.simplify(out, "meshoptimizer", "--triangles", self.count)

    def cgal(self, out):
        kept = self.path("cgal.json")
        if not (kept.exists() and out.exists()):
            kept.write_text(json.dumps(call(PEERS / "peerCgal", "envelope", self.full, self.bound, "-o", out)))
        return json.loads(kept.read_text())

    def manifold(self, out):
        full = self.path("full.off")
        if not full.exists():
            self.mesh("--method", "mc", "-o", full)
        return call("node", HERE / "peerManifold.mjs", full.name, self.bound, out.name, cwd=self.folder)

    def niimath(self, out):
        image = self.path("image.nii")
        nibabel.load(self.scan).to_filename(image)
        return call("node", HERE / "peerNiimath.mjs", image.name, self.iso, self.count / self.full_count, out.name,
                    cwd=self.folder)

    def modern(self, method, given, *arguments):
        """By VTK of Debian 13."""
        for file in (HERE / MODERN, given):
            shutil.copy(file, self.root / "tmp")
        made = call("chroot", self.root, "python3", f"/tmp/{MODERN}", method, f"/tmp/{given.name}", *arguments,
                    "/tmp/made.ply")
        return made, self.root / "tmp" / "made.ply"

    def modern_quadric(self, out):
        made, written = self.modern("quadric", self.full, self.count)
        shutil.copy(written, out)
        return made

    def surface_nets(self, out):
        """Of the voxels of the largest piece; its PLY is moved from voxel indices to the scan's place."""
        image = nibabel.load(self.scan)
        pieces, _ = ndimage.label(np.asarray(image.dataobj) >= self.iso)
        mask = ndimage.binary_fill_holes(pieces == np.bincount(pieces[pieces > 0]).argmax())
        nibabel.Nifti1Image(mask.astype(np.uint8), np.eye(4)).to_filename(self.path("mask.nii"))
        made, written = self.modern("surfaceNets", self.path("mask.nii"))
        head, body = written.read_bytes().split(b"end_header\n", 1)
        count = int(head.split(b"element vertex ")[1].split()[0])
        points = np.frombuffer(body[:12 * count], "<f4").reshape(-1, 3)
        moved = nibabel.affines.apply_affine(image.affine, points).astype("<f4").tobytes()
        out.write_bytes(head + b"end_header\n" + moved + body[12 * count:])
        return made

    def defects(self, mesh):
        surface = call(PROGRAMS / "adaptiso-check", mesh, "--json", "-", "--quiet", "--profile", "view")["surfaces"][0]
        found, pairs = surface["defects"], surface["selfIntersections"]
        return {"torn": found["boundaryEdge"], "nonManifold": found["nonManifoldEdge"] + found["nonManifoldVertex"],
                "crossing": pairs["pairCount"] if pairs else None, "flat": found["degenerateTriangle"]}

    def distances(self, mesh, frame):
        report = call(PROGRAMS / "adaptiso-compare", mesh, self.full, "--json", "-", "--samples", 1000,
                      "--no-warnings", "--max-hausdorff", self.bound, *frame)["distances"]
        return {way: report[way]["hausdorff"] for way in ("aToB", "bToA")}


def methods(bench):
    """Name, how it is run with one thread, with two."""
    yield "adaptiso-mesh, from the image", bench.ours, lambda out: bench.ours(out, 2)
    yield "simplify() of this library", bench.library, lambda out: bench.library(out, 2)
    yield CGAL, bench.cgal, None
    if bench.path("node_modules/manifold-3d").exists():
        yield "manifold", bench.manifold, None
    if bench.path("node_modules/@niivue/niimath").exists():
        yield NIIMATH, bench.niimath, None
    yield "vtkQuadricDecimation", bench.quadric, None
    if bench.root:
        yield "vtkQuadricDecimation, Debian 13", bench.modern_quadric, None
    yield "meshoptimizer", bench.meshoptimizer, None
    if bench.root:
        yield "vtkSurfaceNets3D, Debian 13", bench.surface_nets, None


def interval(distance):
    return f"{distance['lowerMm']:.4f} to {distance['upperMm']:.4f}"


def table(rows):
    print("| method | triangles | torn | non-manifold | crossing | flat | to the full surface, mm | from it, mm "
          "| s, 1 thread | 2 threads |\n|---|---:|---:|---:|---:|---:|---|---|---:|---:|")
    for row in rows:
        two = row["twoThreads"]
        version = f" {row['version']}" if "version" in row else ""
        print(f"| {row['name']}{version} | {row['triangles']:,} | {row['torn']} | {row['nonManifold']} "
              f"| {row['crossing']} | {row['flat']} | {interval(row['aToB'])} | {interval(row['bToA'])} "
              f"| {statistics.median(row['cpuSeconds']):.2f} | {f'{statistics.median(two):.2f}' if two else '-'} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--scan", default="/usr/share/mricron/templates/ch2bet.nii.gz")
    parser.add_argument("--iso", type=float, default=46.5)
    parser.add_argument("--bound", type=float, default=0.15)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--debian13", type=pathlib.Path)
    arguments = parser.parse_args()
    arguments.folder = arguments.folder.resolve()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    bench = Bench(arguments)
    rows = [{"name": name, "one": one, "two": two, "out": bench.path(f"made{n}.{FORMATS.get(name, 'ply')}"),
             "cpuSeconds": [], "twoThreads": []}
            for n, (name, one, two) in enumerate(methods(bench))]
    for repeat in range(arguments.repeats):
        for row in rows:
            if repeat > 0 and row["name"] == CGAL:
                continue
            if row["two"]:
                row["twoThreads"].append(row["two"](row["out"])["cpuSeconds"])
            made = row["one"](row["out"])
            row["cpuSeconds"].append(made["cpuSeconds"])
            row.update({key: made[key] for key in ("version", "triangles") if key in made})
            print(f"{row['name']}: {made}", file=sys.stderr, flush=True)
    for row in rows:
        says_frame = FORMATS.get(row["name"]) != "off" and "Debian 13" not in row["name"]
        frame = () if says_frame else ("--input-coordinates", "ras")  # as the full surface's
        row.update(bench.defects(row["out"]), **bench.distances(row["out"], frame))
        for key in ("one", "two", "out"):
            del row[key]
    bench.path("certified.json").write_text(json.dumps(rows, indent=1) + "\n")
    table(rows)


if __name__ == "__main__":
    main()
