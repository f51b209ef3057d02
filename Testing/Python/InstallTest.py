"""The installed package: by CMake into a prefix; by pip into a virtual environment (that builds anew,
and is tried with ADAPTISO_PIP=1 only)."""

import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from support import InFolder

SCRIPT = """
import adaptiso, numpy as np
volume = np.zeros((8, 8, 8)); volume[2:6, 2:6, 2:6] = 1
print(adaptiso.__file__, adaptiso.check(adaptiso.surface(volume, 0.5)).failed)
"""


class Installed(InFolder):
    def said(self, python, **environment):
        return subprocess.check_output([python, "-B", "-c", SCRIPT], text=True, cwd=self.folder,
                                       env={"PATH": "/usr/bin:/bin", **environment}).split(" ", 1)

    def test_by_cmake_into_a_prefix(self):
        subprocess.check_output([os.environ["ADAPTISO_CMAKE"], "--install",
                                 os.environ["ADAPTISO_BUILD"], "--component", "python",
                                 "--prefix", self.folder])
        package = self.folder / "lib" / "python3" / "dist-packages"
        file, failed = self.said(sys.executable, PYTHONPATH=str(package))
        self.assertEqual(Path(file), package / "adaptiso" / "__init__.py")
        self.assertEqual(failed, "[]\n")
        for name in ("py.typed", "_adaptiso.pyi"):
            self.assertTrue((package / "adaptiso" / name).is_file(), name)
        self.check_itks_readers(package)

    def check_itks_readers(self, package):
        """They are found where the programs' package puts them."""
        library = Path("lib/adaptiso/itk/libadaptisoItkIO.so")
        if not (Path(os.environ["ADAPTISO_BUILD"]) / library).exists():
            return
        (self.folder / library).parent.mkdir(parents=True)
        shutil.copy(Path(os.environ["ADAPTISO_BUILD"]) / library, self.folder / library)
        (self.folder / "image.vtk").write_text("""# vtk DataFile Version 3.0
one line
ASCII
DATASET STRUCTURED_POINTS
DIMENSIONS 2 2 2
SPACING 1 1 1
ORIGIN 0 0 0
POINT_DATA 8
SCALARS scalars short 1
LOOKUP_TABLE default
1 2 3 4 5 6 7 8
""")
        self.assertEqual("VTK image (ITK)\n", subprocess.check_output(
            [sys.executable, "-B", "-c", "import adaptiso; print(adaptiso.read('image.vtk').format)"],
            cwd=self.folder, text=True, stderr=subprocess.DEVNULL,
            env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(package)}))

    @unittest.skipUnless(os.environ.get("ADAPTISO_PIP"), "ADAPTISO_PIP is not set")
    def test_by_pip_into_a_virtual_environment(self):
        venv = self.folder / "venv"
        subprocess.check_output([sys.executable, "-m", "venv", "--system-site-packages", venv])
        subprocess.check_output([venv / "bin" / "pip", "install", "--no-build-isolation",
                                 "--no-deps", "--no-index", os.environ["ADAPTISO_SOURCE"]])
        file, failed = self.said(venv / "bin" / "python")
        self.assertTrue(Path(file).is_relative_to(venv), file)
        self.assertEqual(failed, "[]\n")


if __name__ == "__main__":
    unittest.main(verbosity=2)
