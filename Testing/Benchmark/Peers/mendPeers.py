#!/usr/bin/python3
"""A damaged surface made sound by adaptiso-mend and by CGAL's Alpha Wrap.

  mendPeers.py FOLDER [--scan NIFTI] [--iso V] [--bound MM] [--faults N]

The surface is adaptiso-mesh's largest piece within --bound; N of its triangles are taken out, turned round, doubled, or
moved by a corner, the same ones every time. Both sides are asked what adaptiso-check and adaptiso-compare find:
crossings, and the distances of all points. Seconds are the processor's; of adaptiso-mend with reading, checks and
writing, of CGAL without reading and writing. A table in Markdown goes to standard output.
"""
import argparse
import json
import pathlib
import random
import resource
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
BUILD = HERE.parents[2] / "build" / "benchmark"
PEERS, PROGRAMS = BUILD / "Testing" / "Benchmark" / "Peers", BUILD / "bin"


def call(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if not done.stdout or done.returncode > 1:
        raise RuntimeError(f"{command[0]}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def damage(source, target, faults):
    """OFF to OFF."""
    lines = source.read_text().splitlines()
    head = [line for line in lines if line.startswith("#")]
    rows = [line.split() for line in lines[1:] if not line.startswith("#") and line]
    count = int(rows[0][0])
    points = [[float(x) for x in row] for row in rows[1:count + 1]]
    triangles = [[int(n) for n in row[1:4]] for row in rows[count + 1:]]
    chance = random.Random(7)
    for _ in range(faults):
        t, kind = chance.randrange(len(triangles)), chance.randrange(4)
        if kind == 0:
            triangles.pop(t)
        elif kind == 1:
            triangles[t] = triangles[t][::-1]
        elif kind == 2:
            triangles.append(list(triangles[t]))
        else:
            points[triangles[t][0]] = [x + chance.uniform(-2.5, 2.5) for x in points[triangles[t][0]]]
    target.write_text("\n".join(["OFF", *head, f"{len(points)} {len(triangles)} 0",
                                *(" ".join(map(repr, p)) for p in points),
                                *("3 %d %d %d" % tuple(t) for t in triangles)]) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--scan", default="/usr/share/mricron/templates/ch2bet.nii.gz")
    parser.add_argument("--iso", default="100")
    parser.add_argument("--bound", default="0.5")
    parser.add_argument("--faults", type=int, default=40)
    arguments = parser.parse_args()
    folder, bound = arguments.folder, float(arguments.bound)
    folder.mkdir(parents=True, exist_ok=True)
    sound, damaged = folder / "sound.off", folder / "damaged.off"
    for file in folder.glob("*.off"):
        file.unlink()
    call(PROGRAMS / "adaptiso-mesh", arguments.scan, "--iso", arguments.iso, "--largest", "--max-error", bound,
         "-o", sound, "--quiet", "--json", "-")
    damage(sound, damaged, arguments.faults)

    def mended(name, make):
        out = folder / f"{name}.off"
        before = processor_time()
        report = make(out)
        seconds = report.get("cpuSeconds", processor_time() - before)
        checked = call(PROGRAMS / "adaptiso-check", out, "--json", "-")["surfaces"][0]
        compared = call(PROGRAMS / "adaptiso-compare", damaged, out, "--json", "-")["distances"]
        failed = ", ".join(checked["failed"]) or "none"
        print(f"| {name} | {checked['triangles']:,} | {failed} | {compared['bToA']['hausdorff']['upperMm']:.2f} | "
              f"{compared['aToB']['hausdorff']['upperMm']:.2f} | {seconds:.2f} |", flush=True)

    print("| method | triangles | failed checks | farthest from the input, mm | of the input, farthest, mm | s |")
    print("|---|---:|---|---:|---:|---:|")
    mended(f"adaptiso-mend, {bound} mm", lambda out: call(
        PROGRAMS / "adaptiso-mend", damaged, "--max-error", bound, "--max-hole", 20, "-o", out, "--json", "-"))
    for alpha in (4 * bound, 2 * bound):
        mended(f"Alpha Wrap, alpha {alpha}, offset {bound / 2}", lambda out, alpha=alpha: call(
            PEERS / "peerCgal", "wrap", damaged, alpha, bound / 2, "-o", out))


if __name__ == "__main__":
    main()
