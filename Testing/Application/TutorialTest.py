"""Documentation/Tutorial.md, every command of it. Needs Debian's python3-mne, python3-nibabel and
mricron-data; exits 77 (skipped) without them."""

import importlib.util
import json
import re
import sys
from pathlib import Path

from documents import run, script
from support import SOURCE, ApplicationTest, main

SCANS = Path("/usr/share/mricron/templates")


class Tutorial(ApplicationTest):
    def test_commands_end_in_a_forward_solution(self):
        done = run(script("Tutorial.md"), self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(json.loads(self.path("checked.json").read_text())["passed"])
        # the electrodes are another head's: 5.9 mm; in a wrong frame they would be centimetres off
        self.assertRegex(done.stdout, r"electrodes are [0-7]\.\d mm off the skin")
        self.assertRegex(done.stdout, r"leadfield of 94 electrodes and \d{3} dipoles")
        self.look_at_leadfield()
        self.look_at_page(done.stdout)

    def look_at_page(self, printed):
        """What the page says is printed is, but for digits; its pictures are there and small."""
        page = (SOURCE / "Documentation" / "Tutorial.md").read_text()
        blank = re.compile(r"[\d,.]+")
        lines = {blank.sub("0", line) for line in printed.splitlines()}
        blocks = re.findall(r"\nprints\n\n```\n(.*?)```", page, re.DOTALL)
        self.assertEqual(len(blocks), 2)
        for line in "".join(blocks).splitlines():
            if not re.match(r"[\d.]+ s \(", line):  # seconds of some stages may round to nothing
                self.assertIn(blank.sub("0", line), lines)
        pictures = re.findall(r"!\[[^]]+\]\((\S+?)\)", page)
        self.assertEqual(len(pictures), 2)
        for picture in pictures:
            self.assertLess((SOURCE / "Documentation" / picture).stat().st_size, 150_000)
        self.assertIn("All ", self.path("ch2-model.html").read_text())

    def look_at_leadfield(self):
        import mne
        import numpy as np
        forward = mne.read_forward_solution(self.path("ch2-fwd.fif"), verbose="error")
        gain = forward["sol"]["data"]
        self.assertTrue(np.isfinite(gain).all())
        # in V for 1 Am: a source of 10 nAm makes 0.1 to 10 uV at the electrode that sees it best
        largest = np.abs(gain).max(axis=0)
        self.assertGreater(largest.min(), 10)
        self.assertLess(largest.max(), 1000)


if __name__ == "__main__":
    missing = [name for name in ("mne", "nibabel") if not importlib.util.find_spec(name)]
    if missing or not (SCANS / "ch2.nii.gz").exists():
        print(f"skipped: needs {', '.join(missing) or SCANS}")
        sys.exit(77)
    main()
