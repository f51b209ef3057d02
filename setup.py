"""Builds the C++ half of the Python package by CMake; pyproject.toml says the rest.

ADAPTISO_CMAKE_ARGS: more arguments for CMake, as a shell splits them.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

TOP = Path(__file__).parent.resolve()


class BuildByCMake(build_ext):
    def build_extension(self, extension):
        target = Path(self.get_ext_fullpath(extension.name)).resolve()
        folder = Path(self.build_temp).resolve()
        run = subprocess.check_call
        run(["cmake", "-S", TOP, "-B", folder, "-G", "Ninja", "--log-level=WARNING",
             "-DCMAKE_BUILD_TYPE=Release", "-DADAPTISO_BUILD_PYTHON=ON",
             "-DADAPTISO_BUILD_APPLICATIONS=OFF", "-DADAPTISO_BUILD_TESTING=OFF",
             f"-DPython_EXECUTABLE={sys.executable}", "-DADAPTISO_PYTHON_DIR=.",
             *shlex.split(os.environ.get("ADAPTISO_CMAKE_ARGS", ""))])
        run(["cmake", "--build", folder, "--target", "adaptisoPython"])
        target.parent.mkdir(parents=True, exist_ok=True)
        [built] = (folder / "python" / "adaptiso").glob("_adaptiso.*.so")
        self.copy_file(built, target)


VERSION = re.search(r"project\(adaptiso VERSION ([\d.]+)", (TOP / "CMakeLists.txt").read_text())[1]
setup(version=VERSION, ext_modules=[Extension("adaptiso._adaptiso", sources=[])],
      cmdclass={"build_ext": BuildByCMake})
