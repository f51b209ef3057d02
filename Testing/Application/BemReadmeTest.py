"""The examples of adaptiso-bem's README.md, run as they stand."""

import os
import re
import subprocess

from support import BIN, SOURCE, ApplicationTest, Image, main, without_progress, write_nifti

README = SOURCE / "Applications" / "adaptiso-bem" / "README.md"


def head(n=50, step=4):
    """Labels of three spheres of 70, 77 and 84 mm."""
    middle = (n - 1) / 2
    samples = bytearray()
    for k in range(n):
        for j in range(n):
            for i in range(n):
                r = step * ((i - middle) ** 2 + (j - middle) ** 2 + (k - middle) ** 2) ** 0.5
                samples.append(1 if r < 70 else 2 if r < 77 else 3 if r < 84 else 0)
    return Image((n, n, n), "B", bytes(samples), (step,) * 3)


class Readme(ApplicationTest):
    def test_examples_run(self):
        write_nifti(self.path("seg.nii"), head())
        subprocess.run(["gzip", "seg.nii"], cwd=self.folder, check=True)
        examples = re.search(r"## Examples.*?```sh\n(.*?)```", README.read_text(), re.DOTALL)
        done = subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", examples.group(1)],
                              cwd=self.folder, env={**os.environ, "PATH": f"{BIN}:/usr/bin:/bin"},
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, without_progress(done.stderr)), (0, ""))
        self.assertEqual(self.names(), ["checked", "meg", "model", "page.html", "report.json",
                                        "seg.nii.gz", "toolboxes"])
        self.assertTrue((self.path("meg") / "inner_skull.gii").exists())
        self.assertRegex(done.stdout, r'"model": true')


if __name__ == "__main__":
    main()
