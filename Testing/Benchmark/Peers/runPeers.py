#!/usr/bin/python3
"""Measures the adaptive method and its peers; every run is a process of its own.

  runPeers.py compare   all methods at one count of triangles, side by side: compare.json
  runPeers.py bound     ours by its default bound, decimation to as many triangles: bound.json
  runPeers.py scans     ours and decimation on thirteen other scans, at 30, 10 and 3 %: scans.json
  runPeers.py held      ours by its default bound and meshoptimizer to as many triangles, on these: held.json
  runPeers.py relatives the methods that the thesis surveys, at one count: relatives.json
  runPeers.py counts    triangles that a largest distance of 0.1 to 1 voxel takes: counts.json
  runPeers.py pareto    all methods at several counts: pareto.json
  runPeers.py growth    ours on a gyroid of 64 to 512 samples a side: growth.json
  runPeers.py report    Markdown of the above on standard output, plots beside them

Every command reads and writes the folder of -o.
"""
import argparse
import datetime
import json
import math
import pathlib
import subprocess
import sys

import otherScans
import peerPrograms as peers
import peerReport

TOP = pathlib.Path(__file__).resolve().parents[3]


def tell(text):
    print(text, file=sys.stderr, flush=True)


def context(arguments):
    commit = subprocess.run(["git", "-C", str(TOP), "describe", "--always", "--dirty"],
                            capture_output=True, text=True).stdout.strip()
    processor = next((line.split(": ")[1].strip() for line in open("/proc/cpuinfo")
                      if line.startswith("model name")), "unknown")
    return {"commit": commit, "date": datetime.date.today().isoformat(), "processor": processor,
            "processors": len([line for line in open("/proc/cpuinfo")
                               if line.startswith("processor")]),
            "threads": arguments.threads, "repeats": arguments.repeats, "border": arguments.border,
            "loadAverage": float(open("/proc/loadavg").read().split()[0])}


def adaptivity_for(bench, volume, count, row_of=peers.openvdb):
    """The adaptivity that comes nearest to the count from above, or 1 where that does not reach."""
    low, high = 0.0, 1.0
    if bench.run(volume, row_of(high))["triangles"] > count:
        return high
    for _ in range(9):
        middle = (low + high) / 2
        if bench.run(volume, row_of(middle))["triangles"] > count:
            low = middle
        else:
            high = middle
    return low


def decimators(bench, count):
    made = [peers.quadric(count), peers.pro(count)]
    return made + ([peers.meshoptimizer(count)] if bench.has("peerMeshoptimizer") else [])


def compare(bench, arguments, volume, facts):
    border = arguments.border
    rows = [peers.Row("FlyingEdges", "peerVtk", "flyingEdges"),
            *decimators(bench, volume.triangles)]
    if bench.has("peerOpenVdb"):
        rows.append(peers.openvdb(adaptivity_for(bench, volume, volume.triangles)))
    # also where many samples equal the isovalue, and closed, as users have it by default
    for each in dict.fromkeys((border, "open", "closed")):
        rows.append(peers.ours("adaptive", each, triangles=volume.triangles, border_=each))
        rows.append(peers.ours("adaptive", each, f"adaptive, at {volume.asked}",
                               isovalue=volume.asked, triangles=volume.triangles, border_=each))
    rows += [peers.ours(m, border, border_=border) for m in ("mc", "boxes", "asc")]
    return bench.rows(volume, rows, arguments.repeats, tell=tell)


def relatives(bench, arguments, volume, facts):
    """The methods that the thesis surveys, those of libraries too, at the count of `compare`."""
    rows = [peers.Row("FlyingEdges", "peerVtk", "flyingEdges"),
            *decimators(bench, volume.triangles), peers.attributes(volume.triangles)]
    for row_of in (peers.clustering, *peers.RELATIVES):
        rows.append(row_of(adaptivity_for(bench, volume, volume.triangles, row_of)))
        tell(f"{volume.name}: {rows[-1].label}, {rows[-1].options}")
    rows.append(peers.ours("adaptive", "open", triangles=volume.triangles, border_="open"))
    facts["seeds"] = bench.call("peerSeeds", bench.path(volume, "volume"), "--iso", volume.isovalue)
    return bench.rows(volume, rows, arguments.repeats, meters_heap=False, tell=tell)


def bound(bench, arguments, volume, facts):
    """What users get who ask for nothing: closed and, as FlyingEdges makes it, open borders."""
    rows = []
    for border in ("open", "closed"):
        ours = peers.ours("adaptive", border, border_=border)
        count = bench.run(volume, ours)["triangles"]
        rows += [ours, *decimators(bench, count)]
    return bench.rows(volume, rows, arguments.repeats, tell=tell)


def scans(bench, arguments):
    """Parts of marching cubes' triangles, where vtkQuadricDecimation gets there."""
    results = []
    for name, image, isovalue in otherScans.write(arguments.output):
        volume = peers.Volume(name, image, isovalue, None, asked=isovalue)
        facts = bench.prepare(volume)
        for part in (0.3, 0.1, 0.03):
            count = round(part * facts["mcTriangles"])
            rows = [peers.quadric(count),
                    peers.ours("adaptive", arguments.border, triangles=count,
                               border_=arguments.border)]
            base, ours = rows = bench.rows(volume, rows, arguments.repeats, meters_heap=False)
            results.append({"name": name, "isovalue": isovalue, "part": part, "wanted": count,
                            "rows": rows})
            mean = ours["distance"]["both"]["mean"] / base["distance"]["both"]["mean"]
            tell(f"{name}, {100 * part:.0f} %: mean {mean:.3f}, time "
                 f"{peers.median_ratio(ours, base):.2f}, processor time "
                 f"{peers.median_ratio(ours, base, 'cpuSeconds'):.2f} of quadric's")
        image.unlink()
        for kept in arguments.output.glob(f"{name}-*"):
            kept.unlink()
    return results


def held(bench, arguments):
    """Scans that no constant was chosen by, as users get them who ask for nothing."""
    results = []
    for name, image, isovalue in otherScans.write(arguments.output):
        volume = peers.Volume(name, image, isovalue, None, asked=isovalue)
        facts = bench.prepare(volume)
        ours = peers.ours("adaptive", "open", border_="open")
        count = bench.run(volume, ours)["triangles"]
        rows = bench.rows(volume, [ours, peers.meshoptimizer(count)], arguments.repeats, meters_heap=False)
        ratios = sorted(a / b for a, b in zip(*(row["cpuSeconds"] for row in rows)))
        results.append({"name": name, "isovalue": isovalue, "mcTriangles": facts["mcTriangles"], "rows": rows})
        tell(f"{name}: {100 * count / facts['mcTriangles']:.0f} % of {facts['mcTriangles']:,}, processor time "
             f"{peers.median_ratio(*rows, 'cpuSeconds'):.2f} of meshoptimizer's, {ratios[0]:.2f} to {ratios[-1]:.2f}")
        image.unlink()
        for kept in arguments.output.glob(f"{name}-*"):
            kept.unlink()
    return results


def pareto(bench, arguments, volume, facts):
    border = arguments.border
    rows = []
    for part in (0.03, 0.06, 0.12, 0.25, 0.5):
        count = round(part * facts["mcTriangles"])
        rows += [*decimators(bench, count),
                 peers.ours("adaptive", border, triangles=count, border_=border)]
    if bench.has("peerOpenVdb"):
        rows += [peers.openvdb(a) for a in (0, 0.05, 0.2, 0.5, 1)]
    rows += [peers.ours(m, border, block=n, border_=border)
             for m in ("boxes", "asc") for n in (2, 4, 8, 16)]
    rows.append(peers.ours("dmc", border, border_=border))
    return bench.rows(volume, rows, arguments.repeats, meters_heap=False, tell=tell)


def fewest(evaluate, fine, coarse, middle, is_close):
    """For every error the coarsest setting found by bisection whose largest distance keeps to it.
    Settings that were tried for one error serve the others. `fine` keeps to all."""
    tried = {}

    def largest(setting):
        if setting not in tried:
            tried[setting] = evaluate(setting)
        return tried[setting]["max"]

    found = []
    bad = coarse
    for error in reversed(peers.ERRORS):
        # what fails a larger error fails this one; start at the coarsest that is known to keep it
        good = min((s for s in tried if tried[s]["max"] <= error), default=fine,
                   key=lambda s: tried[s]["triangles"])
        if largest(bad) <= error:
            good = bad
        while not is_close(good, bad):
            between = middle(good, bad)
            good, bad = (between, bad) if largest(between) <= error else (good, between)
        largest(good)
        found.append({"error": error, **tried[good]})
        bad = good
    return found[::-1]


def counts_of_ours(bench, arguments, volume):
    results = []
    for error in reversed(peers.ERRORS):
        row = peers.ours("adaptive", arguments.border, max_error=error, border_=arguments.border)
        mesh = bench.path(volume, "ours")
        made = bench.run(volume, row, mesh)
        there = bench.measure(volume, mesh, [bench.reference(volume, arguments.border)],
                              "--distances-only")["distances"][0]["both"]
        results.append({"label": "adaptive", "error": error, "triangles": made["triangles"],
                        "max": there["max"], "mean": there["mean"], "seconds": made["seconds"],
                        "cpuSeconds": made["cpuSeconds"], "boundMm": made["boundMm"]})
        tell(f"{volume.name}: {results[-1]}")
    return results[::-1]


def counts_of_peers(bench, arguments, volume, facts):
    """Each against its own surface of full resolution, so that no one is charged for deciding
    ambiguous faces otherwise."""
    results = []

    def bisect(label, row_of, full, settings):
        reference, mesh = bench.path(volume, "full"), bench.path(volume, "tried")
        bench.run(volume, full, reference)

        def evaluate(setting):
            made = bench.run(volume, row_of(setting), mesh)
            there = bench.measure(volume, mesh, [reference],
                                  "--distances-only")["distances"][0]["both"]
            return {"triangles": made["triangles"], "max": there["max"], "mean": there["mean"],
                    "seconds": made["seconds"], "cpuSeconds": made["cpuSeconds"]}

        for found in fewest(evaluate, *settings):
            results.append({"label": label, **found})
            tell(f"{volume.name}: {results[-1]}")

    of_count = (facts["mcTriangles"], 1000, lambda a, b: round(math.sqrt(a * b)),
                lambda a, b: a <= 1.05 * b)
    for row in reversed(decimators(bench, None)):
        bisect(row.label,
               lambda count, row=row: peers.Row("", row.program, row.method, triangles=count),
               peers.Row("", "peerVtk", "flyingEdges"), of_count)
    if bench.has("peerOpenVdb"):
        bisect("OpenVDB volumeToMesh", peers.openvdb, peers.openvdb(0),
               (0.0, 1.0, lambda a, b: (a + b) / 2, lambda a, b: abs(a - b) < 0.01))
    return results


def counts(bench, arguments, volume, facts):
    rows = [] if arguments.part == "peers" else counts_of_ours(bench, arguments, volume)
    if arguments.part == "ours":
        return rows + kept_rows(arguments.output / "counts.json", volume.name,
                                lambda row: row["label"] != "adaptive")
    return rows + counts_of_peers(bench, arguments, volume, facts)


def with_earlier(path, volumes):
    """`volumes`, and those that an earlier run measured besides; in the order of all."""
    names = [volume["name"] for volume in volumes]
    earlier = json.loads(path.read_text())["volumes"] if path.exists() else []
    volumes = volumes + [volume for volume in earlier if volume["name"] not in names]
    order = [volume.name for volume in peers.bound_volumes(TOP)]
    return sorted(volumes, key=lambda volume: order.index(volume["name"]))


def kept_rows(path, volume, is_kept):
    """Of an earlier run."""
    if not path.exists():
        return []
    return [row for earlier in json.loads(path.read_text())["volumes"]
            if earlier["name"] == volume for row in earlier["rows"] if is_kept(row)]


def growth(bench, arguments):
    results = []
    for side in arguments.sides:
        volume = peers.Volume(f"gyroid{side}", None, 0.5, None)
        facts = bench.call("peerVolume", "gyroid", side, "-o", bench.path(volume, "volume"),
                           "--iso", volume.isovalue)
        result = {"side": side, **facts, "runs": []}
        row = peers.ours("adaptive", "closed", max_error=arguments.max_error, border_="closed")
        for _ in range(arguments.repeats):
            for threads in (1, 2):
                bench.threads = threads
                result["runs"].append({"threads": threads, **bench.run(volume, row)})
        result["peakHeapBytes"] = bench.run(volume, row, meters_heap=True)["peakHeapBytes"]
        bench.path(volume, "volume").unlink()
        results.append(result)
        tell(f"growth: {result}")
    return results


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=["compare", "bound", "scans", "held", "relatives", "counts", "pareto",
                                            "growth", "report"])
    parser.add_argument("-o", "--output", type=pathlib.Path, default=TOP / "out" / "peers")
    parser.add_argument("--programs", type=pathlib.Path,
                        default=TOP / "build" / "benchmark" / "Testing" / "Benchmark" / "Peers")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--border", choices=["open", "closed"], default="open",
                        help="of our methods; FlyingEdges is open, OpenVDB closed")
    parser.add_argument("--only", choices=["engine", "teapot", "ch2bet", "ch2"],
                        help="the file keeps what it has of the other volumes")
    parser.add_argument("--part", choices=["all", "ours", "peers"], default="all",
                        help="of counts; ours keeps what an earlier run found of the peers")
    parser.add_argument("--sides", type=int, nargs="+", default=[64, 128, 256, 512],
                        help="of growth; 1024 takes 2 GB for the volume")
    parser.add_argument("--max-error", type=float, help="of growth, voxels")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    if arguments.command == "report":
        peerReport.write(arguments.output, sys.stdout)
        return
    bench = peers.Bench(arguments.programs, arguments.output, arguments.threads)
    report = {"context": context(arguments)}
    path = arguments.output / f"{arguments.command}.json"
    if arguments.command == "growth":
        report["sizes"] = growth(bench, arguments)
    elif arguments.command == "scans":
        report["scans"] = scans(bench, arguments)
    elif arguments.command == "held":
        report["scans"] = held(bench, arguments)
    else:
        measure = {"compare": compare, "bound": bound, "relatives": relatives, "counts": counts,
                   "pareto": pareto}[arguments.command]
        report["volumes"] = []
        of_bound = arguments.command == "bound"
        for volume in peers.bound_volumes(TOP) if of_bound else peers.volumes(TOP):
            if arguments.only not in (None, volume.name):
                continue
            if not pathlib.Path(volume.image).exists():
                tell(f"{volume.name}: {volume.image} is not there, left out")
                continue
            facts = bench.prepare(volume)
            rows = measure(bench, arguments, volume, facts)  # may add facts
            report["volumes"].append({
                "name": volume.name, "isovalue": volume.isovalue, "wanted": volume.triangles,
                **facts, "rows": rows})
        if arguments.only:
            report["volumes"] = with_earlier(path, report["volumes"])
    path.write_text(json.dumps(report, indent=1) + "\n")
    tell(f"wrote {path}")


if __name__ == "__main__":
    main()
