"""The examples of the docstrings run, the docstrings are complete, and the types hold."""

import doctest
import importlib.util
import inspect
import os
import subprocess
import sys
import unittest
from pathlib import Path

import adaptiso
from support import BRAIN

SOURCE = Path(os.environ["ADAPTISO_SOURCE"]) / "Wrapping" / "Python"


class Docstrings(unittest.TestCase):
    @unittest.skipUnless(BRAIN.exists(), "mricron-data is not installed")
    def test_examples_run(self):
        tried = 0
        for name in ("adaptiso", *(f"adaptiso.{part}" for part in (
                "_bem", "_images", "_labels", "_surface", "_mesh", "_quality", "_marching_cubes",
                "_simplify", "giant"))):
            module = sys.modules[name]
            result = doctest.testmod(module)
            self.assertEqual(result.failed, 0, name)
            tried += result.attempted
        self.assertGreater(tried, 30)

    def test_everything_public_is_documented(self):
        for name in adaptiso.__all__:
            thing = getattr(adaptiso, name)
            if name == "__version__" or inspect.ismodule(thing):
                continue
            self.assertGreater(len(inspect.getdoc(thing) or ""), 30, name)
            if inspect.isclass(thing) and not issubclass(thing, (tuple, Exception)):
                for member, value in vars(thing).items():
                    if not member.startswith("_") and (callable(value)
                                                       or isinstance(value, property)):
                        self.assertTrue(inspect.getdoc(value), f"{name}.{member}")

    def test_every_parameter_is_documented(self):
        for function in (adaptiso.surface, adaptiso.bem, adaptiso.labels, adaptiso.simplify, adaptiso.read, adaptiso.check, adaptiso.check_nested,
                         adaptiso.compare, adaptiso.marching_cubes, adaptiso.load,
                         *(getattr(adaptiso.giant, name) for name in adaptiso.giant.__all__
                           if name != "Plan")):
            text = inspect.getdoc(function)
            for parameter in inspect.signature(function).parameters:
                self.assertRegex(text, rf"(?m)^[\w, ]*\b{parameter}\b", f"{function.__name__}")


class Types(unittest.TestCase):
    @unittest.skipIf(importlib.util.find_spec("mypy") is None, "not installed: mypy")
    def test_mypy_is_content(self):
        done = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", os.devnull,
                               "--config-file", SOURCE / "mypy.ini", SOURCE / "adaptiso"],
                              text=True, capture_output=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_package_says_that_it_has_types(self):
        self.assertTrue((Path(adaptiso.__file__).parent / "py.typed").is_file())


if __name__ == "__main__":
    unittest.main(verbosity=2)
