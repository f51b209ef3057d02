#!/usr/bin/python3
"""alone.py SOURCE WORK   compiles each source as far as its syntax, alone: in units of many sources, as CI builds, one
that lacks an include finds it in another's."""
import concurrent.futures
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path


def faults(command):
    words = shlex.split(command["command"])
    output = words.index("-o")
    # precompiled headers would bring what a source lacks
    words = [word for word in words[:output] + words[output + 2:] if "cmake_pch" not in word and word != "-include"]
    done = subprocess.run([words[0], "-fsyntax-only", "-w", *words[1:]], cwd=command["directory"],
                          stderr=subprocess.PIPE, text=True)
    return done.stderr if done.returncode else ""


def main():
    source, work = sys.argv[1:]
    subprocess.run(["cmake", "--preset", "release", "-B", work, "-DCMAKE_UNITY_BUILD=OFF"], cwd=source, check=True,
                   stdout=subprocess.DEVNULL)
    commands = json.loads((Path(work) / "compile_commands.json").read_text())
    made = [c for c in commands if c["file"].startswith(f"{source}/") and Path(c["file"]).exists()
            and not c["file"].startswith(work)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = [text for text in pool.map(faults, made) if text]
    print("".join(found), end="")
    print(f"{len(made)} sources, {len(found)} that need others")
    return 1 if found or not made else 0


if __name__ == "__main__":
    sys.exit(main())
