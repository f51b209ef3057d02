"""ParaView's plugin in ParaView's own programs, on a virtual screen: both filters run, and are seen.

Needs Debian's paraview, xvfb and what is in python3-paraview, which can't be installed beside
python3-vtk9: Testing/run.sh unpacks it into build/paraview. pvpython puts Debian's folder of modules
before PYTHONPATH; with python3-vtk9's modules in it ParaView crashes, so the script puts its own first."""

import json
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np
from support import BRAIN, InFolder

import adaptiso

ROOT = Path(os.environ["ADAPTISO_PARAVIEW"]) / "usr"
MODULES = ROOT / "lib/python3/dist-packages"
PLUGIN = Path(adaptiso.__file__).with_name("paraview_plugin.py")

SCRIPT = """
import json, os, sys
sys.path[:0] = os.environ["PYTHONPATH"].split(":")
from paraview.simple import *
from paraview import servermanager
LoadPlugin(sys.argv[1], ns=globals())
reader = OpenDataFile(sys.argv[2])
surface = AdaptisoIsosurface(Input=reader)
surface.Isovalues = [46.5]
surface.CoordinateFrame = "RAS (mm)"
surface.MaximumErrormm = 0.3
surface.UpdatePipeline()
small = AdaptisoSimplify(Input=surface)
small.MaximumErrormm = 3
small.TargetReduction = 0.9
view = CreateView("RenderView")
view.ViewSize = [1000, 500]
view.OrientationAxesVisibility = 0
view.Background = [1, 1, 1]
view.UseColorPaletteForBackground = 0
left, right = Show(surface, view), Show(small, view)
for display in (left, right):
    display.Representation = "Surface With Edges"
    ColorBy(display, None)
    display.EdgeColor = [0.2, 0.2, 0.2]
    display.DiffuseColor = display.AmbientColor = [0.9, 0.8, 0.6]
right.Position = [-170, 0, 0]
Render(view)  # the first one moves the camera
view.CameraPosition, view.CameraFocalPoint = [-85, 600, 80], [-85, -18, 8]
view.CameraViewUp, view.CameraViewAngle = [0, 0, 1], 18
Render(view)
SaveScreenshot(sys.argv[3], view)
fetched = servermanager.Fetch(surface)
print(json.dumps({
    "surface": surface.GetDataInformation().GetNumberOfCells(),
    "small": small.GetDataInformation().GetNumberOfCells(),
    "bound": fetched.GetFieldData().GetArray("ErrorBound").GetTuple1(0),
    "space": fetched.GetFieldData().GetAbstractArray("SPACE").GetValue(0),
    "label": surface.GetProperty("MaximumError").GetXMLLabel()}))
"""


@unittest.skipUnless(BRAIN.exists(), "mricron-data is not installed")
class Plugin(InFolder):
    def test_both_filters_run_and_are_seen(self):
        (self.folder / "script.py").write_text(SCRIPT)
        # Debian's ParaView has no reader of NIfTI
        scan = adaptiso.read(BRAIN)
        # every other voxel takes seconds, the picture of Documentation/ParaView.md all of them
        step = 1 if "ADAPTISO_PARAVIEW_PICTURE" in os.environ else 2
        array = np.asfortranarray(scan.array[::step, ::step, ::step])
        affine = scan.affine @ np.diag([step, step, step, 1])
        image = self.folder / "brain.mha"
        image.write_bytes(f"""ObjectType = Image
NDims = 3
BinaryData = True
Offset = {" ".join(map(str, affine[:3, 3]))}
ElementSpacing = {step} {step} {step}
DimSize = {" ".join(map(str, array.shape))}
ElementType = MET_UCHAR
ElementDataFile = LOCAL
""".encode() + array.tobytes(order="F"))
        picture = Path(os.environ.get("ADAPTISO_PARAVIEW_PICTURE", self.folder / "both.png"))
        wanted = adaptiso.surface(array, 46.5, affine=affine, max_error=0.3)
        for program in ("pvbatch", ROOT / "bin/pvpython"):
            picture.unlink(missing_ok=True)
            done = subprocess.run(
                [program, self.folder / "script.py", PLUGIN, image, picture], text=True,
                capture_output=True, env={
                    **os.environ, "DISPLAY": self.screen(),
                    "PYTHONPATH": os.pathsep.join([str(PLUGIN.parents[1]), str(MODULES)])})
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertNotIn("ERR", done.stderr)
            said = json.loads(done.stdout.splitlines()[-1])
            self.assertEqual(said["surface"], len(wanted.faces))
            self.assertLessEqual(said["bound"], 0.3)
            self.assertLess(said["small"], 0.2 * said["surface"])
            self.assertGreater(said["small"], 0)
            self.assertEqual((said["space"], said["label"]), ("RAS", "Maximum Error (mm)"))
            self.look_at(picture)

    def screen(self):
        """The name of a virtual screen that lasts as long as the test."""
        server = subprocess.Popen(["Xvfb", "-noreset", "-displayfd", "1", "-screen", "0", "1280x800x24"],
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(server.stdout.close)
        self.addCleanup(server.wait)
        self.addCleanup(server.terminate)
        return ":" + server.stdout.readline().strip()

    def look_at(self, picture):
        """Both surfaces are there, side by side, on white."""
        from PIL import Image
        pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
        is_surface = pixels.sum(axis=2) < 740
        middle = pixels.shape[1] // 2
        for half in (is_surface[:, :middle], is_surface[:, middle:]):
            self.assertGreater(half.mean(), 0.05)
            self.assertLess(half.mean(), 0.8)
        # the coarser one has fewer, wider triangles: fewer edges are drawn
        edges = (pixels.sum(axis=2) < 200)
        self.assertGreater(edges[:, :middle].sum(), 1.2 * edges[:, middle:].sum())


if __name__ == "__main__":
    needed = [name for name in ("Xvfb", "pvbatch") if shutil.which(name) is None]
    if not (MODULES / "paraview").is_dir():
        needed.append(f"{MODULES}/paraview")
    if needed:
        print("not installed:", ", ".join(needed))
        sys.exit(77)
    unittest.main(verbosity=2)
