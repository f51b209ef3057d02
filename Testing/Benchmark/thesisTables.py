#!/usr/bin/python3
"""The thesis's tables 6.1 to 6.5 from what compareExtraction measured, its numbers beside ours.

    thesisTables.py -o FOLDER JSON...

Writes thesis.md, thesis.json, thesisTriangles.svg (triangles against distance) and thesisTime.svg
(time against block size). The skull of table 6.3 is not at hand; a volume named so gets its
numbers.
"""
import argparse
import json
import pathlib

import matplotlib

from thesisTargets import targets, write_targets

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "thesis", "font.size": 8})
import matplotlib.pyplot as plt  # noqa: E402: after the choice of a backend

# (triangles, mean error, seconds) by (method, block size); mean errors of 6.5 are not given
THESIS = {
    "6.1": {("mc", 4): (584950, 0, 2.297), ("dmc", 4): (132336, 0.244, 1.344),
            ("asc", 4): (59835, 0.117, 8.641), ("boxes", 2): (61100, None, 5.328),
            ("boxes", 4): (49693, 0.193, 2.922), ("boxes", 8): (47094, None, 5.344)},
    "6.2": {("mc", 4): (713144, 0, 3.062), ("dmc", 4): (155630, 0.242, 1.797),
            ("asc", 4): (66989, 0.051, 10.891), ("boxes", 2): (61702, None, 6.828),
            ("boxes", 4): (43351, 0.268, 3.844), ("boxes", 8): (46202, None, 5.688)},
    "6.3": {("mc", 4): (1044777, 0, 4.485), ("dmc", 4): (405680, 0.255, 4.789),
            ("asc", 4): (217805, 0.114, 17.75), ("boxes", 2): (228076, None, 13.875),
            ("boxes", 4): (213639, 0.127, 8.266), ("boxes", 8): (212923, None, 14.437)},
    "6.4": {("mc", 4): (976826, 0, 1.813), ("dmc", 4): (408470, 0.213, 2.485),
            ("asc", 4): (265575, 0.127, 10.704), ("boxes", 2): (274544, None, 11.297),
            ("boxes", 4): (256954, 0.124, 5.547), ("boxes", 8): (256603, None, 8.828)}}
NAMED = {"engine": "6.1", "teapot": "6.2", "skull": "6.3"}  # all at 50
COLOURS = {"mc": "black", "dmc": "tab:blue", "dmc, within blocks": "tab:cyan",
           "dmc, adjusted": "tab:purple", "asc": "tab:green", "boxes": "tab:red"}


def thesis_table(run):
    """Which of the thesis's tables is of this volume; "" for none."""
    if run["name"] in NAMED and run["isovalue"] == 50 and not run["crop"]:
        return NAMED[run["name"]]
    # another brain, in a box of the same size
    return "6.4" if run["name"] == "ch2bet" and run["size"] == [157, 189, 156] else ""


def method_of(row):
    return (row["method"] + (", within blocks" if row["mergeWithinBlocks"] else "")
            + (", adjusted" if row["adjustVertices"] else ""))


def rows_of(run):
    """The rows of an open border, each with the thesis's numbers and its time against mc's."""
    thesis = THESIS.get(thesis_table(run), {})
    rows = [r for r in run["rows"] if r["border"] == "open" and r["computesNormals"]]
    thesis_mc = thesis.get(("mc", 4))
    for row in rows:
        name, size = method_of(row), row["blockSize"]
        # the reading of its dmc whose counts are the thesis's, see Algorithm.md
        theirs = thesis.get(("dmc", 4) if (name, size) == ("dmc, within blocks", 8)
                            else (name, size))
        yield {
            "method": name, "blockSize": size,
            "triangles": row["triangles"], "ratioToMc": row["ratioToMc"],
            "meanDistanceVoxels": row["meanDistanceVoxels"],
            "extractSeconds": row["extractSeconds"], "indexSeconds": row["indexSeconds"],
            # medians of ratios to runs just before, at N = 4
            "timeToMc": row["extractToMc"], "timeToAsc": row["extractToAsc"],
            "peakHeapBytes": row["peakHeapBytes"],
            "blocksActive": row["blocksActive"], "blocksTotal": row["blocksTotal"],
            "indexNodesVisited": row["indexNodesVisited"],
            "thesis": theirs and {"triangles": theirs[0], "meanError": theirs[1],
                                  "seconds": theirs[2], "timeToMc": theirs[2] / thesis_mc[2]}}


def cell(value, form):
    return "-" if value is None else format(value, form)


HEADER = ("| method | N | triangles | ratio to mc | mean (voxel) | extract s | index s | x mc "
          "| peak MB | thesis: triangles | mean | s | x mc |\n"
          "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n")


def write_markdown(out, runs):
    for run in runs:
        table = thesis_table(run)
        out.write(f"### {run['title']}{f' (table {table})' if table else ''}\n")
        out.write(" x ".join(map(str, run["size"])) + f" samples, commit {run['commit']}, "
                  f"{run['threads']} threads, medians of {run['repeats']}.\n\n" + HEADER)
        for r in run["rows"]:
            theirs = r["thesis"] or dict.fromkeys(("triangles", "meanError", "seconds",
                                                   "timeToMc"))
            cells = [r["method"], cell(r["blockSize"], "d"), cell(r["triangles"], ",d"),
                     cell(r["ratioToMc"], ".3f"), cell(r["meanDistanceVoxels"], ".3f"),
                     cell(r["extractSeconds"], ".4f"), cell(r["indexSeconds"], ".4f"),
                     cell(r["timeToMc"], ".2f"), cell(r["peakHeapBytes"] / 1e6, ".1f"),
                     cell(theirs["triangles"], ",d"), cell(theirs["meanError"], ".3f"),
                     cell(theirs["seconds"], ".3f"), cell(theirs["timeToMc"], ".2f")]
            out.write("| " + " | ".join(cells) + " |\n")
        out.write("\n")
    out.write("### Block size (table 6.5)\n| boxes, triangles / mean / x mc | N = 2 | N = 4 "
              "| N = 8 |\n|---|---:|---:|---:|\n")
    for run in runs:
        boxes = {r["blockSize"]: r for r in run["rows"] if r["method"] == "boxes"}
        ours = [f"{boxes[n]['triangles']:,} / {boxes[n]['meanDistanceVoxels']:.3f} / "
                f"{cell(boxes[n]['timeToMc'], '.2f')}" if n in boxes else "-" for n in (2, 4, 8)]
        out.write(f"| {run['title']} | " + " | ".join(ours) + " |\n")
        thesis = THESIS.get(thesis_table(run))
        if thesis:
            theirs = [thesis[("boxes", n)] for n in (2, 4, 8)]
            out.write("| thesis | " + " | ".join(
                f"{triangles:,} / {cell(mean, '.3f')} / {seconds / thesis[('mc', 4)][2]:.2f}"
                for triangles, mean, seconds in theirs) + " |\n")
    out.write("\n")


def panels(runs, x_label, y_label):
    """A figure and an axis for each run, three in a row."""
    columns, lines = min(3, len(runs)), -(-len(runs) // 3)
    figure, axes = plt.subplots(lines, columns, squeeze=False,
                                figsize=(3.1 * columns, 2.6 * lines + 0.5))
    axes = list(axes.flat)
    for unused in axes[len(runs):]:
        unused.axis("off")
    for axis, run in zip(axes, runs):
        axis.set(title=run["title"], xlabel=x_label, ylabel=y_label)
    return figure, axes[:len(runs)]


def finish(figure, axes, path):
    entries = dict(zip(*reversed(axes[0].get_legend_handles_labels())))
    entries["thesis"] = plt.Line2D([], [], color="gray", marker="x", linestyle="")
    figure.legend(entries.values(), entries, loc="lower center", ncols=8, fontsize=7)
    figure.tight_layout(rect=(0, 0.35 / figure.get_figheight(), 1, 1))
    figure.savefig(path, metadata={"Date": None})


def plot_triangles(runs, path):
    figure, axes = panels(runs, "triangles, thousands", "mean distance to mc, voxels")
    for axis, run in zip(axes, runs):
        for method, colour in COLOURS.items():
            rows = [r for r in run["rows"] if r["method"] == method and method != "mc"]
            places = {}
            for r in rows:
                place = (r["triangles"] / 1000, round(r["meanDistanceVoxels"], 3))
                places.setdefault(place, []).append(str(r["blockSize"]))
                theirs = r["thesis"]
                if theirs and theirs["meanError"] is not None and "," not in method:
                    axis.plot(theirs["triangles"] / 1000, theirs["meanError"], "x", color=colour)
            axis.plot([x for x, _ in places], [y for _, y in places], "o-", color=colour,
                      markersize=4, linewidth=0.7, label=method if rows else None)
            for place, sizes in places.items():
                one = len(sizes) == 1
                axis.annotate(sizes[0] if one else "any N", place, xytext=(3 if one else -3, 3),
                              textcoords="offset points", ha="left" if one else "right",
                              fontsize=6)
        axis.set_xlim(left=0)
        axis.set_ylim(bottom=0)
    finish(figure, axes, path)


def plot_time(runs, path):
    figure, axes = panels(runs, "block size N", "extraction time / mc at N = 4")
    for axis, run in zip(axes, runs):
        for method, colour in COLOURS.items():
            rows = [r for r in run["rows"] if r["method"] == method]
            axis.plot([r["blockSize"] for r in rows], [r["timeToMc"] for r in rows], "o-",
                      color=colour, markersize=4, linewidth=0.7, label=method if rows else None)
            theirs = [r for r in rows if r["thesis"] and "," not in method]
            axis.plot([r["blockSize"] for r in theirs], [r["thesis"]["timeToMc"] for r in theirs],
                      "x--", color=colour, linewidth=0.5)
        for r in run["rows"]:
            if r["method"] == "FlyingEdges":
                axis.axhline(r["timeToMc"], color="gray", linewidth=0.7, label=r["method"])
        sizes = sorted({r["blockSize"] for r in run["rows"] if r["blockSize"]})
        axis.set(xscale="log", yscale="log", ylim=(0.2, 8))
        axis.set_xticks(sizes, [str(n) for n in sizes])
        axis.minorticks_off()
        axis.set_yticks([0.25, 0.5, 1, 2, 4, 8], ["1/4", "1/2", "1", "2", "4", "8"])
    finish(figure, axes, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", dest="folder", type=pathlib.Path, required=True)
    parser.add_argument("json", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    runs = [json.loads(path.read_text()) for path in arguments.json]
    for run in runs:
        run["name"] = run["input"].split(".")[0]
        run["title"] = (f"{run['name']}{' cropped' if run['crop'] else ''} "
                        f"at {run['isovalue']:g}")
        run["table"] = thesis_table(run) or None
        run["rows"] = list(rows_of(run))
    asked = targets(runs)
    with open(arguments.folder / "thesis.md", "w", encoding="utf-8") as out:
        write_markdown(out, runs)
        write_targets(out, asked)
    with open(arguments.folder / "thesis.json", "w", encoding="utf-8") as out:
        json.dump({"runs": runs, "targets": asked}, out, indent=2)
        out.write("\n")
    plot_triangles(runs, arguments.folder / "thesisTriangles.svg")
    plot_time(runs, arguments.folder / "thesisTime.svg")
    print(f"== wrote {arguments.folder}/thesis.md")


if __name__ == "__main__":
    main()
