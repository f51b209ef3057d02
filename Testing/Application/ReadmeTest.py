"""The examples of adaptiso-mesh's README.md and the first session of the project's, run as they stand."""

import json
import os
import re
import subprocess
import unittest
from pathlib import Path

from documents import check_printed, commands, run
from support import BIN, SOURCE, ApplicationTest, ball, main, write_nifti

README = SOURCE / "Applications" / "adaptiso-mesh" / "README.md"
PROJECT = SOURCE / "README.md"
SCAN = Path("/usr/share/mricron/templates/ch2bet.nii.gz")
SCANS = unittest.skipUnless(SCAN.exists(), "mricron-data is not installed")


class Readme(ApplicationTest):
    def test_examples_run(self):
        write_nifti(self.path("head.nii"), ball(24, 9))
        subprocess.run(["gzip", "head.nii"], cwd=self.folder, check=True)
        examples = re.search(r"## Examples.*?```sh\n(.*?)```", README.read_text(), re.DOTALL)
        done = subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", examples.group(1)],
                              cwd=self.folder, env={**os.environ, "PATH": f"{BIN}:/usr/bin:/bin"},
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(self.names(), ["head-150.ply", "head-80.ply", "head-iso100.vtp",
                                        "head.nii.gz", "head.stl", "head.vtp", "lh.pial",
                                        "report.json", "smooth.ply"])
        self.assertRegex(done.stdout, r'"triangles": \d+')

    @SCANS
    def test_first_session_prints_what_the_page_says(self):
        # Testing/BareMachine runs what installs and builds
        done = run(commands("README.md", marks=True, without=("run.sh", "cmake", "apt-get")), self.folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(check_printed(self, "README.md", done.stdout), 1)
        written = {"brain.vtp", "brain-80.ply", "brain-100.ply", "report.json", "full.vtp", "distance.vtp",
                   "small.vtp", "model", "aal", "check.html"}
        self.assertLessEqual(written, set(self.names()))

    @SCANS
    def test_bounds_make_the_triangles_of_the_table_and_the_picture(self):
        page = PROJECT.read_text()
        bounds, counts = (re.findall(r"[\d.,]*\d", line) for line in
                          re.search(r"\| `--max-error`, mm (.*)\n.*\n\| triangles (.*)", page).groups())
        self.assertEqual(len(bounds), 6)
        brain = f"adaptiso-mesh {SCAN} --iso auto --largest --fill-cavities -o b.ply --json - -q"
        made = {}
        for option in ("--method mc", *(f"--max-error {bound}" for bound in bounds)):
            report = json.loads(run(f"{brain} {option}", self.folder).stdout)
            made[option.split()[1]] = f"{report['surfaces'][0]['triangles']:,}"
        told = re.search(r"!\[(.*)\]\(Documentation/gallery/first-screen.png\)", page).group(1)
        pictured = re.findall(r"[\d,]+\d", told.replace("0.15", "").replace("0.5", ""))
        full = re.search(r"\(full resolution: ([\d,]+)\)", page).group(1)
        before = [full, *counts, *pictured]
        after = [made["mc"], *(made[bound] for bound in bounds), made["mc"], made["0.15"], made["0.5"]]
        if os.environ.get("ADAPTISO_RENEW_PAGES"):  # draw.py then draws the picture anew
            for old, new in zip(before, after):
                page = page.replace(old, new)
            PROJECT.write_text(page)
        else:
            self.assertEqual(before, after)

    def test_a_page_to_finish(self):
        self.assertLessEqual(len(PROJECT.read_text().splitlines()), 150)


if __name__ == "__main__":
    main()
