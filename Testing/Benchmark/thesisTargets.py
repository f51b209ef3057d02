"""What is asked of the thesis's tables, and whether what was measured meets it."""
import math

# (volume, isovalue, method, block size, key of the row, least or None, most)
WITHIN = 0.1  # of the thesis's counts
FIGURES = [
    ("engine", 50, "mc", 4, "triangles", 584950, 584950),
    ("engine", 50, "dmc", 4, "triangles", (1 - WITHIN) * 132336, (1 + WITHIN) * 132336),
    ("engine", 50, "dmc, within blocks", 8, "triangles", (1 - WITHIN) * 132336,
     (1 + WITHIN) * 132336),
    ("engine", 50, "dmc", 4, "meanDistanceVoxels", 0.234, 0.254),
    ("engine", 50, "dmc", 4, "midpointsMeanVoxels", 0.234, 0.254),
    ("engine", 50, "asc", 4, "triangles", (1 - WITHIN) * 59835, (1 + WITHIN) * 59835),
    ("engine", 50, "asc", 4, "meanDistanceVoxels", None, 0.13),
    ("engine", 50, "boxes", 4, "triangles", None, 52000),
    ("engine", 50, "boxes", 4, "meanDistanceVoxels", None, 0.195),
    ("teapot", 50, "dmc", 4, "triangles", (1 - WITHIN) * 155630, (1 + WITHIN) * 155630),
    ("teapot", 50, "dmc, within blocks", 8, "triangles", (1 - WITHIN) * 155630,
     (1 + WITHIN) * 155630),
    ("teapot", 50, "asc", 4, "triangles", (1 - WITHIN) * 66989, (1 + WITHIN) * 66989),
    ("teapot", 50, "boxes", 4, "triangles", None, 45500),
    ("teapot", 50, "boxes", 4, "meanDistanceVoxels", None, 0.27),
]
EVERYWHERE = [("boxes", 4, "timeToAsc", None, 0.5), ("boxes", 4, "timeToMc", None, 2.0)]
WORDS = {"triangles": "triangles", "meanDistanceVoxels": "mean distance, voxels",
         "midpointsMeanVoxels": "midpoint to crossing along its edge, voxels",
         "timeToAsc": "time / asc", "timeToMc": "time / mc",
         "visits": "most nodes visited, less 1.2 x active, / sqrt(all)"}


def target(run, method, size, key, least, most, here):
    return {"volume": run["title"], "method": method, "blockSize": size, "figure": WORDS[key],
            "least": least, "most": most, "here": here,
            "isMet": (least is None or least <= here) and here <= most}


def targets(runs):
    """One entry for each figure whose volume was measured."""
    met = []
    for run in runs:
        rows = {(r["method"], r["blockSize"]): r for r in run["rows"]}
        wanted = [f[2:] for f in FIGURES if f[:2] == (run["name"], run["isovalue"])
                  and not run["crop"]]
        for method, size, key, least, most in wanted + EVERYWHERE:
            row = rows.get((method, size))
            if row:
                here = run[key] if key in run else row[key]
                met.append(target(run, method, size, key, least, most, here))
        visits = [(r["indexNodesVisited"] - 1.2 * r["blocksActive"]) / math.sqrt(r["blocksTotal"])
                  for r in run["rows"] if r["blocksTotal"]]
        met.append(target(run, "k-d search", None, "visits", None, 1, max(visits)))
    return met


def write_targets(out, entries):
    out.write("### What is asked of them\n| volume | method | N | figure | asked | here | met |\n"
              "|---|---|---:|---|---:|---:|---|\n")
    for t in entries:
        form = ",.0f" if t["figure"] == "triangles" else ".3g"
        low, most = t["least"], format(t["most"], form)
        asked = f"at most {most}" if low is None else f"{low:{form}} to {most}"
        if low == t["most"]:
            asked = most
        out.write(f"| {t['volume']} | {t['method']} | {t['blockSize'] or '-'} | {t['figure']} | "
                  f"{asked} | {t['here']:{form}} | {'yes' if t['isMet'] else 'no'} |\n")
    out.write("\n")
