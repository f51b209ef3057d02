#!/usr/bin/python3
"""Prints the triangles of the first surface in a report of adaptiso-mesh, beside marching cubes'.

usage: counts.py REPORT.json
"""
import json
import sys

with open(sys.argv[1], encoding="utf-8") as file:
    surface = json.load(file)["surfaces"][0]
triangles, full = surface["triangles"], surface["marchingCubesTriangles"]
print(f"{triangles:,} triangles; marching cubes: {full:,} ({full / triangles:.1f} times as many)")
