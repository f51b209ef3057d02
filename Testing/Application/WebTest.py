"""The programs in WebAssembly under Node beside the native ones: the same files to the byte, the same
reports, lines and exit codes. Builds nothing: Applications/web/run.sh does."""

import json
import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from support import BIN, SOURCE, ApplicationTest, Image, from_function, main, write_nifti

STARTER = Path(os.environ.get("ADAPTISO_WEB", SOURCE / "build/web")) / "npm/adaptiso/bin.mjs"
NODE = shutil.which("node")

#: What a report has of the run, not of the result.
MEANS = ("solidAngleShare", "mean", "meanMm", "rms", "rmsMm")
OF_THE_RUN = {"seconds", "peakMemoryMb", "threads", "version", "startedAt", "finishedAt", "command", "host",
              "libraries", "program", "date", "work"}


def bumpy(x, y, z):
    bumps = 2 * math.sin(x / 2.3) * math.cos(y / 1.9) * math.sin(z / 2.7)
    r = math.sqrt(x * x + y * y + z * z)
    return round(max(0, min(255, 100 + 12 * (14 - r + bumps))))


def layers(x, y, z):
    r = 2.2 * math.sqrt(x * x + y * y + 1.1 * z * z)
    return 1 if r < 62 else 2 if r < 70 else 3 if r < 78 else 0


def without_run(value, is_rounded=False):
    if isinstance(value, dict):
        return {key: without_run(of, is_rounded or key.endswith("Deg") or key in MEANS)
                for key, of in value.items() if key not in OF_THE_RUN}
    if isinstance(value, list):
        return [without_run(of, is_rounded) for of in value]
    # angles are atan2's, whose last digit is the C library's; means of distances differ in their last two
    return float(f"{value:.12g}") if is_rounded and isinstance(value, float) else value


class WebTest(ApplicationTest):
    def run_both(self, program, *arguments, code=0):
        """Runs both in a folder of their own with what was made so far.
        \\return the stdout of the one in WebAssembly"""
        outputs = []
        for name, command in (("native", [str(BIN / f"adaptiso-{program}")]),
                              ("web", [NODE, str(STARTER), program])):
            folder = self.path(name)
            folder.mkdir(exist_ok=True)
            for file in self.folder.iterdir():
                if file.is_file() and not (folder / file.name).exists():
                    (folder / file.name).symlink_to(file)
            done = subprocess.run([*command, *map(str, arguments)], cwd=folder, text=True, timeout=600,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.assertEqual(done.returncode, code, f"{name}: {done.stderr}")
            outputs.append(done)
        native, web = outputs
        # a run of more than a minute prints lines of progress
        self.assertEqual(*(re.sub(r"^\w[\w ]* (\d+ %|\.\.\.), \d+ s\n", "", done.stderr, flags=re.M)
                           for done in (web, native)))
        return web.stdout

    def assert_same_files(self):
        def files(name):
            root = self.path(name)
            return {str(p.relative_to(root)): p for p in sorted(root.rglob("*")) if p.is_file()}
        native, web = files("native"), files("web")
        self.assertEqual(list(web), list(native))
        for name, path in web.items():
            if name.endswith(".json"):
                self.assertEqual(without_run(json.loads(path.read_text())),
                                 without_run(json.loads(native[name].read_text())), name)
            else:
                self.assertEqual(path.read_bytes(), native[name].read_bytes(), name)

    def write_bumpy(self):
        # voxels of a volume whose cube root is not exact
        write_nifti(self.path("bumpy.nii"), from_function(40, "B", bumpy, (0.9, 1.1, 1.3), (-20, 3, 7)))

    def test_meshes_have_the_native_bytes(self):
        self.write_bumpy()
        for number, extra in enumerate(([], ["--max-error", "0.4"], ["--triangles", "900"], ["--smooth", "1.5"],
                                        ["--method", "mc"], ["--largest", "--fill-cavities"])):
            for suffix in ("ply", "stl", "gii", "vtp", "obj"):
                self.run_both("mesh", "bumpy.nii", "--iso", 100, *extra, "-o", f"m{number}.{suffix}",
                              "--json", f"m{number}{suffix}.json")
        self.assert_same_files()

    def test_simplified_checked_and_compared_meshes_are_the_native_ones(self):
        self.write_bumpy()
        self.run_both("mesh", "bumpy.nii", "--iso", 100, "--method", "mc", "-o", "full.ply")
        for suffix in ("ply", "stl"):
            self.run_both("simplify", "full.ply", "--max-error", "0.5", "-o", f"few.{suffix}",
                          "--json", f"few-{suffix}.json")
        self.run_both("compare", "full.ply", "few.ply", "--colored", "distance.vtp", "--json", "distance.json")
        self.run_both("check", "few.ply", "full.ply", "--json", "check.json")
        self.assert_same_files()

    def test_regions_and_head_models_are_the_native_ones(self):
        write_nifti(self.path("seg.nii"), from_function(85, "B", layers, (2, 2, 2)))
        self.run_both("labels", "seg.nii", "--format", "ply", "-o", "regions", "--json", "labels.json")
        self.run_both("bem", "--labels", "seg.nii", "--tissue", "brain=1", "--tissue", "skull=2",
                      "--tissue", "scalp=3",
                      "--vertices", 642, "-o", "model", "--json", "model.json")
        self.assert_same_files()

    def test_refuses_with_the_native_lines(self):
        self.path("empty.nii").write_bytes(b"")
        self.path("text.nii.gz").write_text("no image")
        for arguments, code in ((["empty.nii"], 3), (["text.nii.gz"], 3), (["missing.nii"], 3), (["--nothing"], 2)):
            self.run_both("mesh", *arguments, "--iso", 1, "-o", "x.stl", code=code)

    def test_an_image_beyond_32_bits_is_refused_in_one_line(self):
        write_nifti(self.path("huge.nii"), Image((1200, 1200, 1200), "f", b""))
        with open(self.path("huge.nii"), "r+b") as file:
            file.truncate(352 + 4 * 1200 ** 3)  # sparse
        done = subprocess.run([NODE, str(STARTER), "mesh", "huge.nii", "--iso", "1", "-o", "x.ply"],
                              cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, r"\Aadaptiso-mesh: huge.nii: its samples take 6.9 GB of memory, .*64-bit.*\n\Z")

    def test_its_version_names_what_it_was_built_without(self):
        done = subprocess.run([NODE, str(STARTER), "mesh", "--version"], text=True, stdout=subprocess.PIPE, check=True)
        self.assertRegex(done.stdout, r"\Aadaptiso-mesh \d+\.\d+\.\d+\none thread\n\Z")

    def test_says_how_much_memory_it_took(self):
        self.write_bumpy()
        text = self.run_both("mesh", "bumpy.nii", "--iso", 100, "-o", "m.ply")
        memory = int(re.search(r"peak memory (\d+) MB", text)[1])
        self.assertGreater(memory, 5)
        self.assertLess(memory, 200)


if __name__ == "__main__":
    main()
