"""Documentation/Tutorial.md, every command of it. Needs Debian's python3-mne, python3-nibabel and
mricron-data; exits 77 (skipped) without them."""

import importlib.util
import json
import re
import sys
from pathlib import Path

from documents import check_printed, commands, run
from support import SOURCE, ApplicationTest, main

SCANS = Path("/usr/share/mricron/templates")


class Tutorial(ApplicationTest):
    def test_commands_end_in_a_forward_solution(self):
        done = run(commands("Tutorial.md", marks=True), self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(json.loads(self.path("checked.json").read_text())["passed"])
        # the electrodes are another head's; in a wrong frame they would be centimetres off
        self.assertRegex(done.stdout, r"electrodes are [0-7]\.\d mm off the skin")
        self.look_at_leadfield()
        self.look_at_page(done.stdout)

    def look_at_page(self, printed):
        """The page's printed lines are the programs', to the digit; its pictures are there and small."""
        self.assertEqual(check_printed(self, "Tutorial.md", printed), 2)
        page = (SOURCE / "Documentation" / "Tutorial.md").read_text()
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
