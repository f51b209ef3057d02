"""How the programs of this folder are called, and what is known of the benchmark's volumes."""
import json
import pathlib
import statistics
import subprocess

ERRORS = (0.1, 0.25, 0.5, 1.0)  # voxels


class Volume:
    """A volume as the programs read it, with its reference surfaces."""

    def __init__(self, name, image, isovalue, triangles, asked, low=None, high=None):
        self.name, self.image, self.isovalue = name, image, isovalue
        self.triangles = triangles  # the count at which all are compared
        self.asked = asked  # the whole isovalue that `isovalue` was moved off
        self.low, self.high = low, high


def volumes(top):
    data = top / ".." / "shared" / "data"
    return [
        Volume("engine", data / "engine.nii.gz", 50.5, 49693, asked=50),
        Volume("teapot", data / "teapot.nii.gz", 50.5, 43351, asked=50),
        Volume("ch2bet", "/usr/share/mricron/templates/ch2bet.nii.gz", 90.5, 256954, asked=90,
               low=(12, 13, 1), high=(168, 201, 156)),
    ]


def bound_volumes(top):
    """And a whole head."""
    return volumes(top) + [Volume("ch2", "/usr/share/mricron/templates/ch2.nii.gz", 100.5, None,
                                  asked=100)]


class Row:
    """One way to make a surface: a program and its options."""

    def __init__(self, label, program, method, border="open", isovalue=None, **options):
        self.label, self.program, self.method = label, program, method
        self.border = border  # of the reference it is measured against
        self.isovalue, self.options = isovalue, options


def ours(method, border, label=None, **options):
    return Row(label or method, "peerAdaptiso", method, border, **options)


def quadric(count=None):
    return Row("FlyingEdges + vtkQuadricDecimation", "peerVtk", "quadric", triangles=count)


def pro(count=None):
    return Row("FlyingEdges + vtkDecimatePro", "peerVtk", "pro", triangles=count)


def meshoptimizer(count=None):
    return Row("FlyingEdges + meshoptimizer", "peerMeshoptimizer", "simplify", triangles=count)


def openvdb(adaptivity):
    # closed at the border whatever one does
    return Row("OpenVDB volumeToMesh", "peerOpenVdb", "volumeToMesh", "closed",
               adaptivity=adaptivity)


def attributes(count=None):
    return Row("FlyingEdges + vtkQuadricDecimation with normals", "peerVtk", "quadricAttributes",
               triangles=count)


def clustering(adaptivity):
    return Row("FlyingEdges + vtkQuadricClustering", "peerVtk", "clustering",
               adaptivity=adaptivity)


def relative(label, method):
    """Maker of rows of one of the thesis's relatives, by its coarseness."""
    return lambda adaptivity: Row(label, "peerRelatives", method, adaptivity=adaptivity)


RELATIVES = [relative("downsampling, then marching cubes", "downsample"),
             relative("downsampling that keeps critical points", "critical"),
             relative("adaptive marching cubes with crack patches", "cubes"),
             relative("tetrahedral bisection", "bisection"),
             relative("volume warping", "warping")]


class Bench:
    def __init__(self, programs, folder, threads):
        self.programs, self.folder, self.threads = programs, folder, threads

    def has(self, program):
        return (self.programs / program).exists()

    def call(self, program, *arguments):
        command = [self.programs / program, *arguments]
        result = subprocess.run([str(a) for a in command], capture_output=True, text=True)
        if result.returncode != 0:
            raise RuntimeError(f"{program}: {result.stderr.strip()}")
        return json.loads(result.stdout)

    def path(self, volume, name):
        return self.folder / f"{volume.name}-{name}"

    def prepare(self, volume):
        """Writes the volume and its reference surfaces; they are as every program made them."""
        crop = ["--low", *volume.low, "--high", *volume.high] if volume.low else []
        facts = self.call("peerVolume", "scan", volume.image, *crop, "-o",
                          self.path(volume, "volume"), "--iso", volume.isovalue)
        for border in ("open", "closed"):
            for isovalue in (volume.isovalue, volume.asked):
                made = self.run(volume, ours("mc", border, isovalue=isovalue, border_=border),
                                self.reference(volume, border, isovalue))
                if border == "open" and isovalue == volume.isovalue:
                    facts["mcTriangles"] = made["triangles"]
        return facts

    def reference(self, volume, border, isovalue=None):
        return self.path(volume, f"mc-{border}-{isovalue or volume.isovalue}")

    def run(self, volume, row, mesh=None, meters_heap=False):
        arguments = [self.path(volume, "volume"), "--method", row.method,
                     "--iso", row.isovalue or volume.isovalue, "--threads", self.threads]
        for name, value in row.options.items():
            if value is not None:
                arguments += ["--" + name.rstrip("_").replace("_", "-"), value]
        if mesh:
            arguments += ["--mesh", mesh]
        if meters_heap:
            arguments.append("--meter-heap")
        return self.call(row.program, *arguments)

    def measure(self, volume, mesh, references, *options):
        return self.call("peerMeasure", self.path(volume, "volume"), mesh, *references, *options)

    def rows(self, volume, rows, repeats, meters_heap=True, tell=lambda text: None):
        """Runs all rows in turn, `repeats` times, the order turned round every time; then measures
        each row's mesh. Returns a list of dicts, one a row."""
        runs = [[] for _ in rows]
        for repeat in range(repeats):
            order = list(range(len(rows)))
            for n in order if repeat % 2 == 0 else order[::-1]:
                mesh = self.path(volume, f"row{n}") if repeat == 0 else None
                runs[n].append(self.run(volume, rows[n], mesh))
            tell(f"{volume.name}: repeat {repeat + 1} of {repeats}")
        results = []
        for n, row in enumerate(rows):
            result = {"label": row.label, "border": row.border,
                      "isovalue": row.isovalue or volume.isovalue, "options": row.options}
            result.update(runs[n][0])
            for key in ("seconds", "cpuSeconds", "peakResidentBytes"):
                result[key] = [run[key] for run in runs[n]]
            if meters_heap:
                result["peakHeapBytes"] = self.run(volume, row, meters_heap=True)["peakHeapBytes"]
            mesh = self.path(volume, f"row{n}")
            facts = self.measure(volume, mesh,
                                 [self.reference(volume, row.border, row.isovalue)])
            result["distance"] = facts.pop("distances")[0]
            result.update(facts)
            results.append(result)
            pathlib.Path(mesh).unlink()
        return results


def median_ratio(row, base, key="seconds"):
    """The median of the ratios within each repeat."""
    return statistics.median(a / b for a, b in zip(row[key], base[key]))
