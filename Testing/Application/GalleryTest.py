"""The pictures of Documentation/Gallery.md and of README.md, made again by the page's own commands and compared. Needs
Debian's python3-numpy, python3-pil and mricron-data; exits 77 (skipped) without them."""

import importlib.util
import re
import subprocess
import sys
import unittest
from pathlib import Path

from support import BIN, SOURCE

FOLDER = SOURCE / "Documentation" / "gallery"
PAGE = SOURCE / "Documentation" / "Gallery.md"


class Gallery(unittest.TestCase):
    def test_pictures_are_as_they_are_drawn(self):
        done = subprocess.run([sys.executable, "-B", FOLDER / "draw.py", BIN, "--check"], text=True, capture_output=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_each_has_the_command_that_makes_it(self):
        sections = PAGE.read_text().split("\n## ")[1:]
        self.assertEqual(len(sections), 10)
        shown = set()
        for section in sections:
            self.assertEqual(len(re.findall(r"(?m)^adaptiso-", section)), 1, section)
            shown.update(re.findall(r"\(gallery/([\w-]+)\.png\)", section))
        self.assertEqual(shown | {"first-screen"}, {path.stem for path in FOLDER.glob("*.png")})

    def test_are_small_and_stand_on_light_and_dark(self):
        from PIL import Image
        for path in FOLDER.glob("*.png"):
            self.assertLess(path.stat().st_size, 150_000, path)
            image = Image.open(path).convert("RGBA")
            self.assertEqual(image.getpixel((0, 0))[3], 0, path)
            opaque = [pixel[:3] for pixel in image.getdata() if pixel[3] > 200]
            grey = sorted(sum(pixel) / 3 for pixel in opaque)
            self.assertLess(grey[len(grey) // 10], 225, path)  # not all white
            self.assertGreater(grey[-len(grey) // 10], 60, path)  # nor all black


if __name__ == "__main__":
    missing = [name for name in ("numpy", "PIL") if not importlib.util.find_spec(name)]
    if missing or not Path("/usr/share/mricron/templates/ch2.nii.gz").exists():
        print(f"skipped: needs {', '.join(missing) or 'mricron-data'}")
        sys.exit(77)
    unittest.main(verbosity=2)
