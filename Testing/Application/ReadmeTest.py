"""The examples of adaptiso-mesh's README.md and the first session of the project's, run as they stand."""

import os
import re
import subprocess
import unittest
from pathlib import Path

from documents import check_printed, commands, run
from support import BIN, SOURCE, ApplicationTest, ball, main, write_nifti

README = SOURCE / "Applications" / "adaptiso-mesh" / "README.md"


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

    @unittest.skipUnless(Path("/usr/share/mricron/templates/ch2.nii.gz").exists(), "mricron-data is not installed")
    def test_first_session_prints_what_the_page_says(self):
        scan = self.path("study/sub-01/anat/sub-01_T1w.nii")
        scan.parent.mkdir(parents=True)
        write_nifti(scan, ball(24, 8))
        self.path("study/dataset_description.json").write_text('{"Name": "x", "BIDSVersion": "1.8.0"}')
        # Testing/BareMachine runs what installs and builds
        done = run(commands("README.md", marks=True, without=("run.sh", "cmake", "apt-get")), self.folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(check_printed(self, "README.md", done.stdout), 1)
        written = {"ch2bet-iso100.vtp", "head.stl", "brain-80.ply", "brain-100.ply", "report.json", "full.vtp",
                   "distance.vtp", "small.vtp", "out", "model", "aal", "check.html"}
        self.assertLessEqual(written, set(self.names()))


if __name__ == "__main__":
    main()
