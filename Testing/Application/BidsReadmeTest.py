"""The examples of adaptiso-bids' README.md, run as they stand."""

import os
import re
import subprocess

from support import BIN, SOURCE, ApplicationTest, Image, ball, main, without_progress, write_nifti

README = SOURCE / "Applications" / "adaptiso-bids" / "README.md"


class Readme(ApplicationTest):
    def put(self, name, image):
        path = self.path(name)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_nifti(path, image)

    def test_examples_run(self):
        boxes = Image((16, 14, 12), "B", bytes(1 + (n % 16 > 7) for n in range(16 * 14 * 12)))
        for subject in ("01", "02", "03"):
            self.put(f"study/sub-{subject}/anat/sub-{subject}_T1w.nii", ball(24, 8))
            self.put(f"seg/sub-{subject}/anat/sub-{subject}_dseg.nii", boxes)
        for name in ("study", "seg"):
            self.path(f"{name}/dataset_description.json").write_text('{"Name": "x", "BIDSVersion": "1.8.0"}')
        examples = re.search(r"## Examples.*?```sh\n(.*?)```", README.read_text(), re.DOTALL)
        done = subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", examples.group(1)],
                              cwd=self.folder, env={**os.environ, "PATH": f"{BIN}:/usr/bin:/bin"},
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, without_progress(done.stderr)), (0, ""), done.stdout)
        self.assertIn("before  study/sub-01", done.stdout)
        self.assertIn("3 participants, 3 whole; 3 surfaces, 0 unusual", done.stdout)
        self.assertTrue(self.path("out/sub-03/anat/sub-03_mesh/regions/2.vtp").is_file())


if __name__ == "__main__":
    main()
