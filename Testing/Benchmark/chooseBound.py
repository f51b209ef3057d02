#!/usr/bin/python3
"""What an error bound of the adaptive method costs and buys: the default is chosen by this.

chooseBound.py PROGRAMS FOLDER [truths] [scans] [cost] [tables]

PROGRAMS holds adaptiso-mesh and adaptiso-compare. Each part writes FOLDER/<part>.json:
  truths  shapes known on paper, sampled with partial volume and noise: how far the surface of
          marching cubes is from the shape itself, and how far the adaptive one is at each bound
  scans   real scans: how far the surface moves when the samples are interpolated by cubic
          B-splines instead of linearly, or when the isovalue moves by the noise
  cost    real scans: triangles, distance, volume and processor time at each bound
  tables  prints what is there as Markdown
Without a part all are done. Everything is in voxels, one process and one thread at a time. Needs
python3-numpy, python3-scipy and python3-nibabel; scans that are not there are left out.
"""
import json
import pathlib
import resource
import subprocess
import sys

import numpy as np

BOUNDS = (0.05, 0.1, 0.15, 0.2, 0.25, 0.35, 0.5)  # of a voxel
SIDE = 64  # samples a side of the shapes known on paper
SUBSAMPLES = 8  # along each axis, for partial volume
LEVEL = 1000  # contrast of the shapes
NOISE = (0, 1 / 40, 1 / 20)  # standard deviations, of the contrast
POINTS = 200000  # laid on a surface, evenly over its area
FINER = 3  # times, for the B-spline
MRICRON = pathlib.Path("/usr/share/mricron/templates")
SHARED = pathlib.Path(__file__).resolve().parents[2] / ".." / "shared" / "data"
SCANS = (("engine", SHARED / "engine.nii.gz", 50.5), ("teapot", SHARED / "teapot.nii.gz", 50.5),
         ("ch2bet", MRICRON / "ch2bet.nii.gz", 90.5), ("ch2", MRICRON / "ch2.nii.gz", 50.5))


class Programs:
    """The programs measured, and the folder for what they write."""

    def __init__(self, programs, folder):
        self.programs, self.folder = pathlib.Path(programs), pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)

    def run(self, name, *arguments):
        """The program's JSON report, and its processor seconds outside the kernel."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run([self.programs / name, "--threads", "1", "--json", "-",
                               *map(str, arguments)], check=True, stdout=subprocess.PIPE)
        after = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        return json.loads(done.stdout), after - before

    def mesh(self, image, isovalue, out, *options):
        report, seconds = self.run("adaptiso-mesh", image, "--iso", isovalue, "-o", out, *options)
        return report["surfaces"][0], seconds

    def compare(self, a, b):
        return self.run("adaptiso-compare", a, b, "--voxel", 1)[0]

    def write(self, part, rows):
        (self.folder / f"{part}.json").write_text(json.dumps(rows, indent=1) + "\n")


def write_image(path, samples, step=1.0):
    """An NRRD image of samples[i, j, k], its first voxel's centre at 0, 0, 0."""
    kind = {"int16": "short", "uint8": "uchar", "float32": "float"}[samples.dtype.name]
    header = (f"NRRD0004\ntype: {kind}\ndimension: 3\nspace: left-posterior-superior\n"
              f"sizes: {' '.join(map(str, samples.shape))}\n"
              f"space directions: ({step!r},0,0) (0,{step!r},0) (0,0,{step!r})\n"
              "space origin: (0,0,0)\nkinds: domain domain domain\n"
              "endian: little\nencoding: raw\n\n")
    with open(path, "wb") as file:
        file.write(header.encode())
        file.write(samples.astype(samples.dtype.newbyteorder("<")).tobytes(order="F"))


# --- shapes known on paper: a field that is > 0 inside, and the distance of points to its zero ---

CENTRE = np.array([31.37, 31.81, 31.59])  # nowhere special on the lattice


def sphere(radius):
    def field(p):
        return radius - np.linalg.norm(p - CENTRE, axis=-1)
    return field, lambda p: np.abs(field(p))


def shell(radius, thickness):
    def field(p):
        return thickness / 2 - np.abs(np.linalg.norm(p - CENTRE, axis=-1) - radius)
    return field, lambda p: np.abs(field(p))


def torus(large, small):
    axis = np.array([0.3, 0.5, 0.8]) / np.linalg.norm([0.3, 0.5, 0.8])

    def field(p):
        along = (p - CENTRE) @ axis
        across = np.sqrt(np.maximum(np.sum((p - CENTRE) ** 2, axis=-1) - along ** 2, 0))
        return small - np.hypot(across - large, along)
    return field, lambda p: np.abs(field(p))


def gyroid(period, radius):
    """A gyroid's one side, within a ball; its distance is measured away from the ball's sphere."""
    scale = 2 * np.pi / period

    def wave(p):
        x, y, z = np.moveaxis((p - CENTRE) * scale, -1, 0)
        return np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)

    def slope(p):
        x, y, z = np.moveaxis((p - CENTRE) * scale, -1, 0)
        return scale * np.stack([np.cos(x) * np.cos(y) - np.sin(z) * np.sin(x),
                                 np.cos(y) * np.cos(z) - np.sin(x) * np.sin(y),
                                 np.cos(z) * np.cos(x) - np.sin(y) * np.sin(z)], axis=-1)

    def ball(p):
        return radius - np.linalg.norm(p - CENTRE, axis=-1)

    def distance(p):
        kept = p[ball(p) > 2]
        foot = kept
        for _ in range(5):  # Newton: along the slope to the zero
            gradient = slope(foot)
            foot = foot - (wave(foot) / np.sum(gradient ** 2, axis=-1))[:, None] * gradient
        return np.linalg.norm(foot - kept, axis=-1)
    return lambda p: np.minimum(wave(p), ball(p)), distance


SHAPES = {"sphere, radius 5": sphere(5), "sphere, radius 10": sphere(10),
          "sphere, radius 20": sphere(20), "torus, radii 18 and 6": torus(18, 6),
          "shell 2 thick, radius 20": shell(20, 2), "gyroid, period 20": gyroid(20, 29)}


def partial_volume(field):
    """The share of every voxel that is inside, by SUBSAMPLES cubed points."""
    inside = np.zeros((SIDE,) * 3)
    offsets = (np.arange(SUBSAMPLES) + 0.5) / SUBSAMPLES - 0.5
    line = np.arange(SIDE, dtype=float)
    lattice = np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1)
    near = np.abs(field(lattice)) < 1.8  # no field is steeper than 1 a voxel by more than this
    inside[~near] = field(lattice[~near]) > 0
    for offset in np.stack(np.meshgrid(offsets, offsets, offsets), axis=-1).reshape(-1, 3):
        inside[near] += (field(lattice[near] + offset) > 0) / SUBSAMPLES ** 3
    return inside


def with_noise(shares, noise):
    """Magnitudes as MRI gives them (Rician), over a level that keeps the noise nearly Gaussian."""
    chance = np.random.default_rng(1)
    real = LEVEL * (0.5 + shares) + LEVEL * noise * chance.standard_normal(shares.shape)
    return np.round(np.hypot(real, LEVEL * noise * chance.standard_normal(shares.shape))).astype(
        np.int16)


def points_on(path):
    """Points spread evenly over the area of a binary STL surface."""
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])
    a, b, c = np.moveaxis(
        np.frombuffer(path.read_bytes()[84:], record)["corners"].astype(float), 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    chance = np.random.default_rng(2)
    one = chance.choice(len(area), POINTS, p=area / area.sum())
    u, v = np.sqrt(chance.random(POINTS)), chance.random(POINTS)
    return (1 - u)[:, None] * a[one] + (u * (1 - v))[:, None] * b[one] + (u * v)[:, None] * c[one]


def measure_truths(programs):
    image, out = programs.folder / "shape.nrrd", programs.folder / "shape.stl"
    rows = []
    for name, (field, distance) in SHAPES.items():
        shares = partial_volume(field)
        for noise in NOISE:
            write_image(image, with_noise(shares, noise))
            for bound in (None, *BOUNDS):
                wanted = ("--method", "mc") if bound is None else ("--max-error", bound)
                surface, _ = programs.mesh(image, LEVEL, out, "--coordinates", "voxel",
                                           *wanted)
                off = distance(points_on(out))
                rows.append({"shape": name, "noise": noise, "bound": bound,
                             "triangles": surface["triangles"], "mean": off.mean(),
                             "rms": np.sqrt((off ** 2).mean()), "p50": np.percentile(off, 50),
                             "p95": np.percentile(off, 95), "max": off.max(),
                             "volume": surface["volumeMm3"]})
                print(rows[-1], flush=True)
    return rows


# --- real scans ---

def noise_of(samples):
    """Standard deviation of the noise: of the product of three differences, one along each axis,
    by its median size, where all eight samples are above 0."""
    samples = samples.astype(float)
    held = samples > 0
    for axis in range(3):
        ahead, behind = [slice(None)] * 3, [slice(None)] * 3
        ahead[axis], behind[axis] = slice(1, None), slice(None, -1)
        samples = (samples[tuple(ahead)] - samples[tuple(behind)]) / np.sqrt(2)
        held = held[tuple(ahead)] & held[tuple(behind)]
    return float(np.median(np.abs(samples[held])) / 0.6745)


def by_splines(samples):
    """The samples interpolated by cubic B-splines, FINER times as fine, over the same extent."""
    from scipy import ndimage
    size = [FINER * (n - 1) + 1 for n in samples.shape]
    fine = np.empty(size, np.float32)
    coefficients = ndimage.spline_filter(samples.astype(float), order=3, mode="mirror")
    across = np.meshgrid(np.arange(size[1]) / FINER, np.arange(size[2]) / FINER, indexing="ij")
    for i in range(size[0]):
        place = [np.full(across[0].shape, i / FINER), *across]
        fine[i] = ndimage.map_coordinates(coefficients, place, order=3, mode="mirror",
                                          prefilter=False)
    return fine


def measure_scans(programs):
    import nibabel
    image, fine = programs.folder / "scan.nrrd", programs.folder / "fine.nrrd"
    surface, other = programs.folder / "scan.ply", programs.folder / "other.ply"
    rows = []
    for name, path, isovalue in SCANS:
        if not path.exists():
            continue
        samples = np.asarray(nibabel.load(path).dataobj)
        noise = noise_of(samples)
        write_image(image, samples)
        programs.mesh(image, isovalue, surface, "--method", "mc", "--border", "open")

        def add(what):
            there = programs.compare(surface, other)["distances"]
            rows.append({"scan": name, "noise": noise, "what": what} |
                        {way: there[way]["inVoxels"] for way in ("aToB", "bToA", "combined")})
            print(rows[-1], flush=True)

        write_image(fine, by_splines(samples), 1 / FINER)
        programs.mesh(fine, isovalue, other, "--method", "mc", "--border", "open")
        add("B-splines")
        fine.unlink()
        for what, step in (("one level", 1), ("noise", noise / np.sqrt(8))):
            programs.mesh(image, isovalue + step, other, "--method", "mc", "--border", "open")
            add(what)
    return rows


def measure_cost(programs):
    reference, out = programs.folder / "mc.ply", programs.folder / "adaptive.ply"
    rows = []
    for name, path, isovalue in SCANS:
        if not path.exists():
            continue
        mc, seconds = programs.mesh(path, isovalue, reference, "--method", "mc",
                                    "--no-check-crossings")
        rows.append({"scan": name, "bound": None, "seconds": seconds,
                     "triangles": mc["triangles"], "volume": mc["volumeMm3"]})
        for bound in BOUNDS:
            ours, seconds = programs.mesh(path, isovalue, out, "--max-error", bound)
            report = programs.compare(out, reference)
            both = report["distances"]["combined"]
            rows.append({"scan": name, "bound": bound, "seconds": seconds,
                         "triangles": ours["triangles"], "proved": ours["errorBoundMm"],
                         "volume": ours["volumeMm3"], **both["inVoxels"],
                         "normals": both["meanNormalDeviationDeg"]})
            print(rows[-1], flush=True)
    return rows


# --- tables ---

def table(head, rows):
    print("| " + " | ".join(head) + " |\n|" + "---|" + "---:|" * (len(head) - 1))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def print_truths(rows):
    groups, shapes = {}, {}
    for row in rows:
        groups.setdefault((row["shape"], row["noise"]), {})[row["bound"]] = row
    bounds = [f"{b:g}" for b in BOUNDS]
    lines = []
    for (shape, noise), at in groups.items():
        mc = at[None]
        lines.append([f"{shape}, {noise:.1%}",
                      " / ".join(f"{mc[key]:.3f}" for key in ("mean", "p50", "p95", "max")),
                      *(f"{at[b]['rms'] / mc['rms'] - 1:+.0%} "
                        f"({at[b]['triangles'] / mc['triangles']:.0%})" for b in BOUNDS)])
        shapes.setdefault(shape, []).append(
            [at[b]["volume"] / mc["volume"] - 1 for b in BOUNDS])
    table(["shape, noise", "mc: mean / p50 / p95 / max", *bounds], lines)
    table(["volume, largest change", *bounds],
          [[shape, *(f"{max(column, key=abs):+.2%}" for column in zip(*changes))]
           for shape, changes in shapes.items()])


def print_scans(rows):
    table(["scan, change", "noise, levels", "mean", "rms", "p95", "p99", "max"],
          [[f"{r['scan']}, {r['what']}", f"{r['noise']:.2f}",
            *(f"{r['aToB'][key]:.3f}" for key in ("mean", "rms", "p95", "p99", "max"))]
           for r in rows])


def print_cost(rows):
    reference = {r["scan"]: r for r in rows if r["bound"] is None}
    lines = []
    for r in rows:
        mc = reference[r["scan"]]
        if r["bound"] is None:
            lines.append([f"{r['scan']}, mc", f"{r['triangles']:,}", "1", *5 * ["-"],
                          f"{r['seconds']:.1f}"])
            continue
        lines.append([f"{r['scan']}, {r['bound']:g}", f"{r['triangles']:,}",
                      f"{r['triangles'] / mc['triangles']:.3f}",
                      *(f"{r[key]:.3f}" for key in ("mean", "p95", "max")),
                      f"{r['volume'] / mc['volume'] - 1:+.3%}", f"{r['normals']:.1f}",
                      f"{r['seconds']:.1f}"])
    table(["scan, bound", "triangles", "of mc's", "mean", "p95", "max", "volume",
           "normals, degrees", "CPU s"], lines)


PARTS = {"truths": (measure_truths, print_truths), "scans": (measure_scans, print_scans),
         "cost": (measure_cost, print_cost)}


def main():
    programs = Programs(sys.argv[1], sys.argv[2])
    for part in sys.argv[3:] or [*PARTS, "tables"]:
        if part != "tables":
            programs.write(part, PARTS[part][0](programs))
            continue
        for name, (_, show) in PARTS.items():
            path = programs.folder / f"{name}.json"
            if path.exists():
                show(json.loads(path.read_text()))


if __name__ == "__main__":
    main()
