"""The examples of adaptiso-labels' README.md, run as they stand."""

import os
import re
import subprocess

from labelsSupport import LabelsTest, label_map, three_boxes
from support import BIN, SOURCE, Image, main, write_nifti

README = SOURCE / "Applications" / "adaptiso-labels" / "README.md"


class Readme(LabelsTest):
    def test_examples_run(self):
        for name in ("seg", "other"):
            write_nifti(self.path(name + ".nii"), three_boxes())
        self.path("masks").mkdir()
        for first in (2, 6):
            write_nifti(self.path(f"masks/from{first}.nii"), label_map(
                (16, 8, 8), lambda i, j, k: first <= i < first + 4 and 2 <= j < 6 and 2 <= k < 6))
        write_nifti(self.path("scan.nii"), Image((16, 14, 12), "h", list(range(16 * 14 * 12))))
        self.path("colors.txt").write_text("1 left 255 0 0 0\n2 right 0 255 0 0\n7 mid 0 0 255 0\n")
        subprocess.run(["gzip", "seg.nii", "other.nii", "scan.nii"], cwd=self.folder, check=True)
        examples = re.search(r"## Examples.*?```sh\n(.*?)```", README.read_text(), re.DOTALL)
        done = subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", examples.group(1)],
                              cwd=self.folder, env={**os.environ, "PATH": f"{BIN}:/usr/bin:/bin"},
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual({path.name for path in self.folder.iterdir() if path.is_dir()},
                         {"seg-labels", "some", "coarse", "again", "made", "masks", "body"})
        self.assertEqual({path.name for path in self.path("some/regions").iterdir()},
                         {"1.stl", "7.stl"})
        self.assertEqual(self.table("some")[1]["name"], "both sides")
        self.assertEqual(self.table("body")[1]["name"], "all")
        self.assertTrue(self.path("page.html").is_file())
        self.assertTrue((self.path("made") / "other-labels" / "walls.vtp").is_file())


if __name__ == "__main__":
    main()
