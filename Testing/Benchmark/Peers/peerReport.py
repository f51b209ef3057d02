"""Tables and plots of what runPeers.py measured."""
import json
import statistics

import peerPrograms as peers

BASE = "FlyingEdges + vtkQuadricDecimation"
MB = 1e6


def table(header, rows, out):
    print("| " + " | ".join(header) + " |", file=out)
    print("|---" + "|---:" * (len(header) - 1) + "|", file=out)
    for row in rows:
        print("| " + " | ".join(row) + " |", file=out)


def mesh_bytes(row):
    """Of ours: points, normals, triangles as kept in memory."""
    return 36 * row["points"] + 24 * row["triangles"]


def bound_cell(row):
    """The voxels of these volumes are 1 mm."""
    if "boundMm" not in row:
        return "-"
    is_kept = row["distance"]["both"]["max"] <= row["boundMm"] + 1e-6
    return f"{row['boundMm']:.3f}" + ("" if is_kept else " (broken)")


def compare_cells(row, base):
    is_ours = row["program"] == "peerAdaptiso"
    distance = row["distance"]["both"]
    memory = f"{row['peakHeapBytes'] / MB:.0f}"
    if is_ours:
        memory += f" ({mesh_bytes(row) / MB:.0f})"
    return [
        ("**" + row["label"] + "**" if is_ours else row["label"]) + ", " + row["border"],
        f"{row['triangles']:,}", f"{distance['mean']:.4f}", f"{distance['max']:.2f}",
        bound_cell(row), f"{row['openEdgesInside']} / {row['nonManifoldEdges']} / "
        f"{row['crossingPairs']} / {row['degenerateTriangles']}",
        f"{statistics.median(row['seconds']):.2f}", f"{statistics.median(row['cpuSeconds']):.2f}",
        f"{peers.median_ratio(row, base):.3f}",
        f"{peers.median_ratio(row, base, 'cpuSeconds'):.3f}", memory]


def write_compare(report, out):
    context = report["context"]
    print(f"Commit {context['commit']}, {context['date']}, {context['processors']} x "
          f"{context['processor']}, load {context['loadAverage']:.1f} at the start; "
          f"{context['threads']} threads each, medians of {context['repeats']} repeats in turn.",
          file=out)
    for volume in report["volumes"]:
        base = next(row for row in volume["rows"] if row["label"] == BASE)
        size = " x ".join(str(n) for n in volume["size"])
        print(f"\n### {volume['name']} {size} at {volume['isovalue']}, "
              f"{volume['wanted']:,} triangles\n", file=out)
        table(["method, border", "triangles", "mean", "max", "bound",
               "open inside / non-manifold / crossing / degenerate", "s", "CPU s", "x quadric",
               "x quadric, CPU", "peak MB (mesh)"],
              [compare_cells(row, base) for row in volume["rows"]], out)


def write_bound(report, out):
    rows = []
    for volume in report["volumes"]:
        for border in ("open", "closed"):
            ours = next(row for row in volume["rows"]
                        if row["label"] == "adaptive" and row["border"] == border)
            first = volume["rows"].index(ours)
            peers_ = {row["label"]: row for row in volume["rows"][first + 1:first + 4]}
            cells = [f"{volume['name']} at {volume['isovalue']}, {border}",
                     f"{ours['triangles']:,}", f"{statistics.median(ours['seconds']):.2f}",
                     f"{statistics.median(ours['cpuSeconds']):.2f}"]
            for label in (BASE, "FlyingEdges + meshoptimizer"):
                cells += [f"{statistics.median(peers_[label]['seconds']):.2f}",
                          f"{peers.median_ratio(ours, peers_[label]):.2f}"]
            own = ours["peakHeapBytes"] - mesh_bytes(ours)
            cells.append(f"{own / peers_[BASE]['peakHeapBytes']:.2f}")
            rows.append(cells)
    table(["volume, border", "triangles", "s", "CPU s", "quadric s", "ours /", "meshoptimizer s",
           "ours /", "heap without mesh / quadric's"], rows, out)


def keeps_topology(row, of):
    """All parts of another surface of the same scan, no edge open within the volume or shared by three."""
    return (row["components"] == of["components"] and row["openEdgesInside"] == 0
            and row["nonManifoldEdges"] + row["nonManifoldVertices"] == 0)


def write_scans(report, out):
    rows = []
    for scan in report["scans"]:
        base, ours = scan["rows"]
        near, far = ours["distance"]["both"], base["distance"]["both"]
        rows.append([f"{scan['name']} at {scan['isovalue']}, {100 * scan['part']:.0f} %",
                     f"{ours['triangles']:,}", f"{base['triangles']:,}",
                     f"{near['mean'] / far['mean']:.2f}", f"{near['max'] / far['max']:.2f}",
                     f"{peers.median_ratio(ours, base):.2f}",
                     f"{peers.median_ratio(ours, base, 'cpuSeconds'):.2f}",
                     "yes" if keeps_topology(base, ours) else "no",
                     f"{base['components']:,} of {ours['components']:,}",
                     f"{base['openEdgesInside']} / "
                     f"{base['nonManifoldEdges'] + base['nonManifoldVertices']} / "
                     f"{base['crossingPairs']}"])
    table(["scan", "triangles", "quadric's", "mean / quadric's", "largest / quadric's",
           "time / quadric's", "CPU time / quadric's", "quadric keeps topology", "its parts",
           "open inside / non-manifold / crossing"], rows, out)


def write_relatives(report, out):
    for volume in report["volumes"]:
        print(f"\n### {volume['name']} at {volume['isovalue']}, {volume['wanted']:,} triangles\n",
              file=out)
        rows = []
        for row in volume["rows"]:
            distance = row["distance"]["both"]
            rows.append([row["label"], f"{row['triangles']:,}", f"{distance['mean']:.4f}",
                         f"{distance['max']:.2f}",
                         f"{row['openEdgesInside']} / "
                         f"{row['nonManifoldEdges'] + row['nonManifoldVertices']} / "
                         f"{row['crossingPairs']} / {row['degenerateTriangles']}",
                         f"{statistics.median(row['seconds']):.2f}",
                         f"{statistics.median(row['cpuSeconds']):.2f}"])
        table(["method", "triangles", "mean", "max",
               "open inside / non-manifold / crossing / degenerate", "s", "CPU s"], rows, out)
        seeds = volume["seeds"]
        print(f"\nseeds: {seeds}", file=out)


def write_counts(report, out):
    header = ["volume, method"] + [f"{error} voxel" for error in peers.ERRORS]
    rows = []
    for volume in report["volumes"]:
        for label in dict.fromkeys(row["label"] for row in volume["rows"]):
            found = {row["error"]: row for row in volume["rows"] if row["label"] == label}
            rows.append([f"{volume['name']}, {label}"] +
                        [f"{found[error]['triangles']:,} ({found[error]['max']:.2f})"
                         for error in peers.ERRORS])
    table(header, rows, out)


def write_growth(report, out):
    rows = []
    for size in report["sizes"]:
        seconds = {threads: statistics.median(run["seconds"] for run in size["runs"]
                                              if run["threads"] == threads) for threads in (1, 2)}
        cpu = statistics.median(run["cpuSeconds"] for run in size["runs"] if run["threads"] == 1)
        run, cells = size["runs"][0], size["activeCells"]
        rows.append([f"{size['side']}^3", f"{cells:,}", f"{run['mcTriangles']:,}",
                     f"{run['triangles']:,}", f"{seconds[1]:.2f}", f"{seconds[2]:.2f}",
                     f"{cpu:.2f}", f"{1e6 * cpu / cells:.2f}", f"{size['bytes'] / MB:.0f}",
                     f"{size['peakHeapBytes'] / MB:.0f}", f"{mesh_bytes(run) / MB:.1f}",
                     f"{size['peakHeapBytes'] / cells:.0f}"])
    table(["size", "active cells", "mc triangles", "triangles", "s, 1 thread", "s, 2 threads",
           "CPU s, 1 thread", "CPU us / cell", "volume MB", "peak MB", "mesh MB", "bytes / cell"],
          rows, out)


MARKS = {"adaptive": ("C3", "o-"), BASE: ("C0", "s-"), "FlyingEdges + vtkDecimatePro": ("C1", "^-"),
         "FlyingEdges + meshoptimizer": ("C2", "v-"), "OpenVDB volumeToMesh": ("C4", "D-"),
         "boxes": ("C5", "x:"), "asc": ("C6", "+:"), "dmc": ("C7", "*:")}


def draw_pareto(volume, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(2, 2, figsize=(9, 7), sharey="row", sharex="col")
    for label, (colour, style) in MARKS.items():
        rows = [row for row in volume["rows"] if row["label"] == label]
        for axis, key in zip(axes, ("mean", "max")):
            across = (lambda r: r["triangles"], lambda r: statistics.median(r["seconds"]))
            for panel, x in zip(axis, across):
                points = sorted((x(row), row["distance"]["both"][key]) for row in rows)
                # settings of blocks and of adaptivity make no curve of seconds
                line = style if panel is axis[0] else style[0]
                panel.plot(*zip(*points), line, color=colour, label=label, markersize=4)
            axis[0].set_ylabel(f"{key} distance, voxels")
    for panel in axes.flat:
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.grid(True, which="major", alpha=0.3)
    axes[1][0].set_xlabel("triangles")
    axes[1][1].set_xlabel("seconds")
    figure.suptitle(f"{volume['name']} at {volume['isovalue']}: "
                    f"{volume['mcTriangles']:,} triangles at full resolution")
    figure.legend(*axes[0][0].get_legend_handles_labels(), loc="lower center", ncol=4, fontsize=8)
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    figure.savefig(path, dpi=75)
    plt.close(figure)


def draw_growth(report, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    cells = [size["activeCells"] for size in report["sizes"]]
    figure, (time, memory) = plt.subplots(1, 2, figsize=(9, 3.5))
    for threads, style in ((1, "o-"), (2, "s-")):
        time.plot(cells, [statistics.median(run["seconds"] for run in size["runs"]
                                            if run["threads"] == threads)
                          for size in report["sizes"]], style, label=f"threads: {threads}")
    memory.plot(cells, [size["peakHeapBytes"] / MB for size in report["sizes"]], "o-", label="peak")
    memory.plot(cells, [size["bytes"] / MB for size in report["sizes"]], "k:", label="volume")
    for panel, text in ((time, "seconds"), (memory, "MB")):
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlabel("active cells")
        panel.set_ylabel(text)
        panel.grid(True, alpha=0.3)
        panel.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)


def write(folder, out):
    """Markdown of the JSON files that are there to `out`; plots as PNG files beside them."""
    writers = {"compare": write_compare, "bound": write_bound, "scans": write_scans,
               "relatives": write_relatives, "counts": write_counts, "growth": write_growth}
    for name, writer in writers.items():
        path = folder / f"{name}.json"
        if path.exists():
            print(f"\n## {name}\n", file=out)
            writer(json.loads(path.read_text()), out)
    pareto, growth = folder / "pareto.json", folder / "growth.json"
    if pareto.exists():
        for volume in json.loads(pareto.read_text())["volumes"]:
            draw_pareto(volume, folder / f"pareto-{volume['name']}.png")
    if growth.exists():
        draw_growth(json.loads(growth.read_text()), folder / "growth.png")
