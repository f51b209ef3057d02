"""A table of how sound surfaces are, and how good their triangles.

qualityTable.py MESH...: prints the table and writes quality.csv. The exit code is 1 where a mesh fails.
"""

import sys

import adaptiso
import pandas


def row(file):
    found = adaptiso.check(file)
    report = found.report
    return {"mesh": file.rsplit("/", 1)[-1], "passed": found.passed,
            "failed": ", ".join(found.failed), "triangles": report["triangles"],
            "genus": report["genus"], "cm2": report["areaMm2"] / 100,
            "cm3": None if report["volumeMm3"] is None else report["volumeMm3"] / 1000,
            "crossings": report["selfIntersections"]["pairCount"],
            "angle, least": report["shape"]["minAngleDeg"]["minimum"],
            "angle, median": report["shape"]["minAngleDeg"]["median"],
            "edge, mean mm": report["shape"]["edgeMm"]["mean"]}


if len(sys.argv) < 2:
    sys.exit("usage: qualityTable.py MESH...")
table = pandas.DataFrame(map(row, sys.argv[1:])).set_index("mesh")
table.to_csv("quality.csv")
print(table.round(2).to_string())
print(f"{int(table.passed.sum())} of {len(table)} pass")
sys.exit(0 if table.passed.all() else 1)
