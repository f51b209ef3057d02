"""The examples of adaptiso-mesh's README.md, run as they stand."""

import os
import re
import subprocess

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
                                        "head-iso120.vtp", "head.index", "head.nii.gz", "head.stl",
                                        "head.vtp", "lh.pial", "report.json", "smooth.ply"])
        self.assertRegex(done.stdout, r'"triangles": \d+')


if __name__ == "__main__":
    main()
