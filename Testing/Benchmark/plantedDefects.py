"""The 19 defects planted in a head model: what adaptiso-check says, and what MNE-Python finds.

    plantedDefects.py FOLDER_OF_PROGRAMS

prints the table of Documentation/Benchmarks.md. MNE is Debian's python3-mne: make_bem_model without
decimation, then make_bem_solution, with their default conductivities. What raises is found, what only warns is
said to warn."""

import json
import shutil
import subprocess
import struct
import sys
import tempfile
import time
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "Support"))
from headDefects import DEFECTS, good, write_off  # noqa: E402

FILES = ["inner.off", "middle.off", "outer.off"]
SKULL = ["inner_skull.surf", "outer_skull.surf", "outer_skin.surf"]


def write_surf(path, mesh):
    points, triangles = mesh
    path.write_bytes(b"\xff\xff\xfetest\n\n" + struct.pack(">2i", len(points), len(triangles)) +
                     b"".join(struct.pack(">3f", *p) for p in points) +
                     b"".join(struct.pack(">3i", *t) for t in triangles))


def ask_adaptiso(program, folder, model):
    """(exit code, what failed, seconds)"""
    for name, mesh in zip(FILES, model):
        write_off(folder / name, mesh)
    start = time.monotonic()
    done = subprocess.run([program, "--nested", *FILES, "--json", "-"], cwd=folder,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    seconds = time.monotonic() - start
    report = json.loads(done.stdout)
    failed = []
    for subject in report["surfaces"] + report["nesting"]["pairs"]:
        failed += [name for name in subject["failed"] if name not in failed]
    return done.returncode, failed, seconds


def ask_mne(folder, model):
    """(found, in whose words, seconds)"""
    import mne
    mne.set_log_level("ERROR")
    bem = folder / "subjects" / "head" / "bem"
    bem.mkdir(parents=True, exist_ok=True)
    for name, mesh in zip(SKULL, model):
        write_surf(bem / name, mesh)
    start = time.monotonic()
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            surfaces = mne.make_bem_model("head", ico=None, subjects_dir=folder / "subjects")
            mne.make_bem_solution(surfaces)
        except Exception as error:  # whatever it raises, it has seen something
            return True, str(error), time.monotonic() - start
    words = "; ".join(dict.fromkeys(str(warning.message) for warning in said
                                    if not issubclass(warning.category, DeprecationWarning)))
    return False, words, time.monotonic() - start


def cell(text):
    return " ".join(text.split()).replace("|", "/")[:110]


def main():
    program = str(Path(sys.argv[1]).resolve() / "adaptiso-check")
    folder = Path(tempfile.mkdtemp(prefix="adaptiso-defects-"))
    ours, theirs, times = 0, 0, []
    print("| planted | adaptiso-check: what fails | MNE | in its words (NumPy's, where it only warns) |\n|---|---|---|---|")
    try:
        for name, plant in [("nothing", lambda model: model), *DEFECTS.items()]:
            code, failed, seconds = ask_adaptiso(program, folder, plant(good()))
            found, words, mneSeconds = ask_mne(folder, plant(good()))
            times.append((seconds, mneSeconds))
            if name != "nothing":
                ours += code == 1
                theirs += found
            print(f"| {name} | {', '.join(f'`{key}`' for key in failed) or '-'} | "
                  f"{'found' if found else 'warns' if words else '-'} | {cell(words)} |", flush=True)
    finally:
        shutil.rmtree(folder)
    total = [sum(column) for column in zip(*times)]
    print(f"\n{len(DEFECTS)} defects: adaptiso-check finds {ours} ({total[0]:.1f} s), "
          f"MNE {theirs} ({total[1]:.1f} s).")


if __name__ == "__main__":
    main()
