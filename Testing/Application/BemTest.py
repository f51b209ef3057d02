"""adaptiso-bem as users call it: inputs, outputs, promises, failures."""

import importlib.util
import json
import math
import os
import re
import struct
import subprocess
import unittest
from pathlib import Path

from support import BAD_INPUT, CHECK_FAILED, OK, USAGE, Image, main, write_4d_nifti, write_nifti
from bemSupport import (BEM, CHECK, NAMES, QUICK, RADII, README, STEP, BemTest, head, read_tri,
                        volume)
from headDefects import DEFECTS, good, write_off


class Model(BemTest):
    def test_folder_holds_the_model(self):
        self.bem(*self.labels(), "-o", "model", "--gifti", "--vtp")
        expected = [f"{name}.{kind}" for name in NAMES for kind in ("surf", "tri", "gii", "vtp")]
        self.assertEqual(sorted(os.listdir(self.path("model"))),
                         sorted(expected + ["model.geom", "model.cond", "report.json", "README.md"]))
        report = self.report()
        self.assertTrue(report["model"])
        self.assertTrue(all(check["passed"] for check in report["checks"]))
        self.assertEqual([s["vertices"] for s in report["surfaces"]], [162] * 3)
        sizes = {p.name: p.stat().st_size for p in self.path("model").iterdir()}
        for file in report["output"]["files"]:
            self.assertEqual(file["bytes"], sizes[file["file"]])

    def test_surfaces_are_the_spheres(self):
        self.bem(*self.labels(), "-o", "model")
        for name, radius, surface in zip(NAMES, RADII, self.report()["surfaces"]):
            points, triangles = read_tri(self.path("model") / f"{name}.tri")
            self.assertEqual((len(points), len(triangles)), (162, 320))
            distances = [math.dist(p, (0, 0, 0)) for p in points]
            # binary voxels of 4 mm: half of one
            self.assertLess(max(abs(d - radius) for d in distances), 2)
            self.assertLess(abs(sum(distances) / 162 - radius), 0.7)
            # 320 chords of 19 mm take 2.4 % off the volume of a sphere of 66 mm
            self.assertAlmostEqual(volume(points, triangles) / (4 / 3 * math.pi * radius ** 3), 0.97,
                                   delta=0.04)
            self.assertAlmostEqual(volume(points, triangles) / surface["volumeMm3"], 1, 6)

    def test_four_layers(self):
        image = head(radii=(54, 60, 66, 72), values=(4, 1, 2, 3))
        write_nifti(self.path("seg.nii"), image)
        tissues = [word for pair in ("brain=4", "csf=1", "skull=2", "scalp=3")
                   for word in ("--tissue", pair)]
        arguments = ("--labels", "seg.nii", *tissues, "--layers", "4", "--voxel", "3",
                     "--closing", "4", "--min-gap", "2,2,1.5")
        self.bem(*arguments, "--vertices", "162", "--simnibs", "--brainstorm", "--fif",
                 "--fieldtrip", "-o", "model")
        names = ("brain", *NAMES)
        report = self.report()
        self.assertEqual([s["name"] for s in report["surfaces"]], list(names))
        self.assertEqual(report["options"]["layers"], 4)
        self.assertEqual(report["options"]["conductivity"]["csf"], 1.79)
        self.assertGreaterEqual(report["gaps"][0]["mm"], 1.5)
        for name, radius in zip(names, (54, 60, 66, 72)):
            points, _ = read_tri(self.path("model") / f"{name}.tri")
            self.assertLess(max(abs(math.dist(p, (0, 0, 0)) - radius) for p in points), 2)
        geometry = (self.path("model") / "model.geom").read_text()
        for line in ("Interfaces 4", "Domain Brain: -Cortex", "Domain CSF: +Cortex -Inner",
                     "Domain Skull: +Inner -Outer", "Domain Skin: +Outer -Scalp",
                     "Domain Air: +Scalp"):
            self.assertIn(line, geometry)
        self.assertIn("CSF 1.79", (self.path("model") / "model.cond").read_text())
        for name in ("gm.stl", "tess_brain_bem.mat", "brain.surf"):
            self.assertTrue((self.path("model") / name).exists(), name)

        # without numbers: as many as the layers' thickness asks for, no more than solvers take
        self.bem(*arguments, "-o", "by-thickness")
        surfaces = self.report("by-thickness")["surfaces"]
        self.assertLessEqual(sum(s["vertices"] for s in surfaces), 10000)
        for surface in surfaces:  # every layer is 6 mm thick; edges are 4 to 5 mm long
            self.assertAlmostEqual(surface["edgeMm"]["mean"], 5, delta=0.5)

        self.bem("--surfaces", *(f"model/{name}.surf" for name in names), "--layers", "4", "-o", "again")
        again = self.report("again")["surfaces"]
        self.assertEqual([(s["vertices"], s["denseTriangles"]) for s in again], [(162, 0)] * 4)

    def test_five_layers(self):
        radii = (46, 54, 60, 66, 72)
        write_nifti(self.path("seg.nii"), head(radii=radii, values=(5, 4, 1, 2, 3)))
        tissues = [word for pair in ("white=5", "brain=4", "csf=1", "skull=2", "scalp=3")
                   for word in ("--tissue", pair)]
        self.bem("--labels", "seg.nii", *tissues, "--layers", "5", "--voxel", "3", "--closing", "4",
                 "--min-gap", "2,2,1.5,0.7", "--vertices", "162", "--bem-fmm", "--fif", "-o", "model")
        names = ("white_matter", "brain", *NAMES)
        report = self.report()
        self.assertEqual([s["name"] for s in report["surfaces"]], list(names))
        self.assertEqual((report["options"]["layers"], report["options"]["minGreyMm"]), (5, 0.7))
        for name, radius in zip(names, radii):
            points, _ = read_tri(self.path("model") / f"{name}.tri")
            self.assertLess(max(abs(math.dist(p, (0, 0, 0)) - radius) for p in points), 2)
        for gap, inner, outer in zip(report["gaps"], radii, radii[1:]):
            self.assertAlmostEqual(gap["mm"], outer - inner, delta=3)  # of flat triangles
        index = (self.path("model") / "tissue_index.txt").read_text().splitlines()
        self.assertEqual(index[1:], [
            ">Skin : skin.stl : 0.465 : FreeSpace", ">Skull : bone.stl : 0.01 : Skin",
            ">CSF : csf.stl : 1.654 : Skull", ">Gray : gm.stl : 0.275 : CSF",
            ">White : wm.stl : 0.126 : Gray"])
        for name in ("wm.stl", "headmodel.mat", "bem.fif", "white_matter.surf"):
            self.assertTrue((self.path("model") / name).exists(), name)

    def test_spongy_bone_is_a_surface_within_the_skull(self):
        """A shell of 6 mm in a skull of 12 mm; then a skull that is spongy throughout."""
        for radii, volume in (((52, 55, 61, 64, 72), 61**3 - 55**3), ((52, 52, 64, 64, 72), 61**3 - 55**3)):  # voxels of 3 mm
            image = head(radii=radii, values=(1, 2, 8, 2, 3))
            if radii[0] == radii[1]:
                image = head(radii=(52, 64, 72), values=(1, 8, 3))
            write_nifti(self.path("seg.nii"), image)
            tissues = [word for pair in ("brain=1", "skull=2,8", "scalp=3") for word in ("--tissue", pair)]
            self.bem("--labels", "seg.nii", *tissues, *QUICK, "--bem-fmm", "-o", "plain", "--force")
            self.bem("--labels", "seg.nii", *tissues, "--tissue", "spongy=8", *QUICK, "--bem-fmm", "--vtp", "-o", "model", "--force")
            bone = self.report()["spongyBone"]
            self.assertIsNone(self.report("plain")["spongyBone"])
            self.assertGreaterEqual(min(bone["innerSkullGapMm"], bone["outerSkullGapMm"]), 0.5)
            self.assertAlmostEqual(bone["volumeMm3"] / (4 / 3 * math.pi * volume), 1, delta=0.12)
            index = (self.path("model") / "tissue_index.txt").read_text().splitlines()
            self.assertEqual(index[-1], ">Spongy : spongy.stl : 0.025 : Skull")
            for name in ("spongy.stl", "spongy_bone.surf", "spongy_bone.vtp"):
                if Path(CHECK).exists():
                    done = subprocess.run([CHECK, str(self.path("model") / name), "--profile", "print"], capture_output=True, text=True)
                    self.assertEqual(done.returncode, OK, done.stdout)
            for name in ("inner_skull.tri", "outer_skull.surf", "skin.stl", "model.geom"):
                self.assertEqual((self.path("model") / name).read_bytes(), (self.path("plain") / name).read_bytes(), name)

    def test_spongy_bone_is_refused_where_it_makes_no_sense(self):
        labels = self.labels()
        self.fails(USAGE, r"--tissue spongy=... needs a skull: not with --meg", *labels, "--tissue", "spongy=8", "--meg", "-o", "m")
        self.fails(BAD_INPUT, r"holds no label of the tissue spongy bone", *labels, "--tissue", "spongy=8", "-o", "m")
        self.fails(BAD_INPUT, r"label 1 is named twice", *labels, "--tissue", "spongy=1", "-o", "m")
        image = head(radii=(52, 64, 72), values=(1, 2, 3))
        samples = bytearray(image.samples)
        samples[samples.index(2)] = 8  # one voxel, at the outer skull
        write_nifti(self.path("seg.nii"), Image(image.size, "B", bytes(samples), image.spacing, image.origin))
        done = self.bem("--labels", "seg.nii", "--tissue", "brain=1", "--tissue", "skull=2", "--tissue", "spongy=8", "--tissue", "scalp=3",
                        *QUICK, "-o", "model")
        self.assertIn("warning: the labels' spongy bone has no piece of 50 mm3", done.stderr)
        self.assertIsNone(self.report()["spongyBone"])

    def test_five_layers_are_refused_where_they_make_no_sense(self):
        labels = self.labels()
        self.fails(USAGE, r"--layers 5 needs --tissue white", *labels, "--tissue", "csf=4", "--layers", "5", "-o", "m")
        self.fails(USAGE, r"--layers 5 needs --aseg or --white", "--t1", "seg.nii", "--layers", "5", "-o", "m")
        self.fails(USAGE, r"five numbers and --layers 5 need each other", "--t1", "seg.nii", "--white", "lh.white",
                   "--layers", "5", "--conductivity", "0.33,0.01,0.43", "-o", "m")

    def test_four_layers_are_refused_where_they_make_no_sense(self):
        labels = self.labels()
        self.fails(USAGE, r"--layers 4 needs --tissue csf", *labels, "--layers", "4", "-o", "m")
        self.fails(USAGE, r"--layers 4 or 5 and --meg", *labels, "--layers", "4", "--meg", "-o", "m")
        self.fails(USAGE, r"--layers 4 does not go with --ct", "--ct", "seg.nii", "--layers", "4", "-o",
                   "m")
        self.fails(USAGE, r"--pial needs --t1", "--labels", "seg.nii", "--pial", "lh.pial",
                   "-o", "m")
        self.fails(USAGE, r"--aseg needs --t1", *labels, "--aseg", "seg.nii", "-o", "m")
        self.fails(USAGE, r"four numbers need --layers 4", *labels, "--conductivity",
                   "0.33,1.79,0.01,0.43", "-o", "m")
        self.fails(USAGE, r"--surfaces needs 4 files", "--surfaces", "a.stl", "b.stl", "c.stl",
                   "--layers", "4", "-o", "m")

    def test_frames_and_units(self):
        centre = (12, -8, 20)
        arguments = self.labels(image=head(centre=centre))
        expected = {("ras", "mm"): centre, ("lps", "mm"): (-12, 8, 20),
                    # tkRAS of the conformed volume: RAS less the middle of the image at (2, 2, 2)
                    ("tkras", "m"): (0.010, -0.010, 0.018)}
        for (frame, unit), middle in expected.items():
            self.bem(*arguments, "-o", "model", "--force", "--coordinates", frame, "--units", unit)
            points, triangles = read_tri(self.path("model") / "outer_skin.tri")
            scale = 0.001 if unit == "m" else 1
            for axis in range(3):
                mean = sum(p[axis] for p in points) / len(points)
                self.assertAlmostEqual(mean / scale, middle[axis] / scale, delta=0.7)
            self.assertGreater(volume(points, triangles), 0)
            text = (self.path("model") / "README.md").read_text()
            self.assertIn("metres (potentials in volts)" if unit == "m" else "millimetres", text)

    def test_conductivities_are_in_cond_and_readme(self):
        self.bem(*self.labels(), "-o", "model", "--conductivity", "0.33,0.0041,0.43")
        self.assertEqual((self.path("model") / "model.cond").read_text(),
                         "# Properties Description 1.0 (Conductivities)\n\nBrain 0.33\n"
                         "Skull 0.0041\nSkin 0.43\nAir 0\n")
        self.assertIn("conductivity=(0.33, 0.0041, 0.43)",
                      (self.path("model") / "README.md").read_text())

    def test_mnes_file_of_all_surfaces_is_read_again(self):
        self.bem(*self.labels(), "--fif", "-o", "model")
        again = self.bem("--surfaces", "model/bem.fif", "--volume", "seg.nii", "-o", "again")
        self.assertEqual([part["role"] for part in self.report("again")["input"]["files"]], ["volume"] + ["surface"] * 3)
        self.assertNotIn("moved", again.stderr)
        for a, b in zip(self.report()["surfaces"], self.report("again")["surfaces"]):
            self.assertEqual((a["name"], a["vertices"]), (b["name"], b["vertices"]))
            self.assertAlmostEqual(a["volumeMm3"] / b["volumeMm3"], 1, 6)
        done = subprocess.run([CHECK, "--nested", "model/bem.fif", "--json", "-"], cwd=self.folder,
                              text=True, capture_output=True)
        names = [surface["file"] for surface in json.loads(done.stdout[done.stdout.index("{"):])["surfaces"]]
        self.assertEqual(names, [f"bem.fif:{name}" for name in ("inner_skull", "outer_skull", "outer_skin")])
        self.assertEqual(done.returncode, 0, done.stderr)
        self.fails(USAGE, "--surfaces needs 3 files", "--surfaces", "model/head-dense.fif", "-o", "one")
        whole = (self.path("model") / "bem.fif").read_bytes()
        for option in "--json", "--report":
            done = subprocess.run([CHECK, "--nested", "model/bem.fif", option, "model/bem.fif"], cwd=self.folder,
                                  text=True, capture_output=True)
            self.assertIn("is the input, which is never overwritten", done.stderr)
            self.assertEqual((done.returncode, (self.path("model") / "bem.fif").read_bytes()), (3, whole))

    def test_one_surface_for_meg(self):
        arguments = self.labels()
        text = self.bem(*arguments[:4], *QUICK, "--meg", "-o", "model").stdout
        self.assertIn("next: adaptiso-check --profile bem model/inner_skull.surf --report", text)
        self.assertEqual(sorted(os.listdir(self.path("model"))),
                         ["README.md", "inner_skull.surf", "inner_skull.tri", "model.cond",
                          "model.geom", "report.json"])
        self.assertIn("Domains 2", (self.path("model") / "model.geom").read_text())

    def test_adaptive_edges(self):
        arguments = self.labels()[:-4]
        self.bem(*arguments, "--edge-length", "8:20", "-o", "model")
        for surface in self.report()["surfaces"]:
            self.assertLess(surface["edgeMm"]["mean"], 20)
            self.assertGreater(surface["edgeMm"]["mean"], 8 * 0.7)

    def test_a_number_of_vertices_for_each_surface(self):
        arguments = self.labels()
        arguments = [*arguments[:-4], *arguments[-2:]]  # without --vertices
        self.assertNotIn("--vertices", arguments)
        self.bem(*arguments, "--vertices", "162,300,200", "-o", "model")
        self.assertEqual([s["vertices"] for s in self.report()["surfaces"]], [162, 300, 200])

    def test_what_is_not_as_in_the_labels_is_told(self):
        # a skull of 1.5 mm, which is made 2 mm thick or more; voxels of 4 mm show 1 to 4 of it
        self.bem(*self.labels(image=head(radii=(60, 61.5, 72)), name="thin.nii"), "-o", "thin")
        report = self.report("thin")
        skull = report["skull"]
        self.assertLess(skull["segmentedMedianMm"], 2.5)
        self.assertGreater(skull["modelMedianMm"], skull["segmentedMedianMm"])
        notes = " ".join(report["notes"])
        self.assertRegex(notes, r"skull: \d\.\d+ mm thick in the segmentation .* mm in the model")
        self.assertRegex(notes, r"outer_skin: encloses [\d,]+ cm3, [\d,]+ cm3 in the segmentation \(")
        for surface, radius in zip(report["surfaces"], (60, 61.5, 72)):
            self.assertAlmostEqual(surface["segmentedVolumeMm3"] / (4 / 3 * math.pi * radius ** 3), 1,
                                   delta=0.03)
        # a hole of 30 mm radius in a skull of 8 mm
        image = head(radii=(60, 68, 76))
        n = image.size[0]
        samples = bytearray(image.samples)
        for at, label in enumerate(samples):
            i, j, k = at % n, at // n % n, at // n // n
            y, z = (STEP * (v - (n - 1) / 2) for v in (j, k))
            if label == 2 and i > n / 2 and y * y + z * z < 30 * 30:
                samples[at] = 3
        holed = Image(image.size, "B", bytes(samples), image.spacing, image.origin)
        arguments = self.labels(image=holed, name="holed.nii")
        done = self.bem(*arguments, "-o", "holed")
        report = self.report("holed")
        warning, = [w for w in report["input"]["warnings"] if w["code"] == "skull-closed"]
        cap = 2 * math.pi * 60 ** 2 * (1 - math.cos(math.asin(30 / 64)))  # seen from the middle
        # 162 vertices are 18 mm apart
        self.assertGreater(report["skull"]["largestHoleMm2"], 0.6 * cap)
        self.assertLess(report["skull"]["largestHoleMm2"], 1.4 * cap)
        x, y, z = report["skull"]["holePointMm"]  # LPS
        self.assertLess(math.dist((-x, -y, z), (55, 0, 0)), 8)
        self.assertRegex(warning["text"], r"^a hole of [\d.]+ cm2 .* mm RAS, is closed in the surfaces")
        self.assertIn(warning["text"], done.stderr)
        self.assertEqual(self.run_bem(*arguments, "-o", "strict", "--strict").returncode, CHECK_FAILED)
        self.bem(*self.labels(), "-o", "usual")
        self.assertEqual([w for w in self.report("usual")["input"]["warnings"]
                          if w["code"].startswith("skull")], [])

    def test_gap_is_kept_where_the_labels_touch(self):
        arguments = self.labels(image=head(radii=(60, 61, 62)), name="thin.nii")
        self.bem(*arguments, "--min-gap", "4,3", "-o", "model")
        gaps = [gap["mm"] for gap in self.report()["gaps"]]
        self.assertGreaterEqual(gaps[0], 4 - 1e-9)
        self.assertGreaterEqual(gaps[1], 3 - 1e-9)

    def test_same_bytes_for_every_number_of_threads(self):
        arguments = self.labels()
        for threads in (1, 2, 5):
            self.bem(*arguments, "-o", f"m{threads}", "--threads", threads)
        for name in NAMES:
            one = (self.path("m1") / f"{name}.surf").read_bytes()
            for threads in (2, 5):
                self.assertEqual(one, (self.path(f"m{threads}") / f"{name}.surf").read_bytes())

    def test_files_hold_no_trace_of_input_user_or_folder(self):
        self.bem(*self.labels("Mustermann.nii"), "-o", "model", "--gifti", "--vtp")
        for path in self.path("model").iterdir():
            data = path.read_bytes()
            if path.name != "report.json":  # holds the name as given, without folders
                self.assertNotIn(b"Mustermann", data, path.name)
            self.assertNotIn(self.folder.name.encode(), data, path.name)


class Presets(BemTest):
    def test_presets_are_label_lists(self):
        for preset, values in (("charm", (3, 7, 5)), ("headreco", (1, 4, 5)), ("aseg", (17, 165, 0))):
            image = head(values=values)
            if preset == "aseg":
                image.kind = "h"  # 258 does not fit a byte
                image.samples = [v or 0 for v in image.samples]
                outer = head(values=(0, 0, 1)).samples
                image.samples = [258 if o else v for v, o in zip(image.samples, outer)]
            write_nifti(self.path(f"{preset}.nii"), image)
            self.bem("--labels", f"{preset}.nii", "--preset", preset, *QUICK, "-o", preset)
            self.assertEqual(len(self.report(preset)["surfaces"]), 3)

    def test_a_head_mask_gives_the_skin_that_labels_lack(self):
        """TotalSegmentator: brain 90, skull 91 and a mask of the body; the same head as with labels."""
        write_nifti(self.path("total.nii"), head(values=(90, 91, 0)))
        write_nifti(self.path("body.nii"), head(values=(1, 1, 1)))
        self.bem("--labels", "total.nii", "--preset", "totalsegmentator", "--head-mask", "body.nii", *QUICK,
                 "-o", "total")
        write_nifti(self.path("all.nii"), head(values=(90, 91, 5)))
        self.bem("--labels", "all.nii", "--preset", "totalsegmentator", "--tissue", "scalp=5", *QUICK, "-o",
                 "all")
        for name in ("inner_skull.surf", "outer_skin.tri"):
            self.assertEqual((self.path("total") / name).read_bytes(), (self.path("all") / name).read_bytes())
        self.fails(USAGE, "totalsegmentator has no scalp: give --head-mask", "--labels", "total.nii", "--preset", "totalsegmentator", "-o", "m")
        small = head(values=(1, 1, 1))
        small.spacing = tuple(2 * s for s in small.spacing)
        write_nifti(self.path("other.nii"), small)
        self.fails(BAD_INPUT, "--head-mask other.nii: the head mask is on another grid than the labels",
                   "--labels", "total.nii", "--preset", "totalsegmentator", "--head-mask", "other.nii", "-o", "m")

    def test_probabilities_and_ct(self):
        names = []
        for n, values in enumerate(((100, 0, 0), (100, 0, 0), (55, 0, 0), (0, 255, 0), (0, 0, 255))):
            names.append(f"c{n + 1}.nii")
            write_nifti(self.path(names[-1]), head(values=values))
        self.bem("--probabilities", *names, *QUICK, "-o", "model")
        self.assertEqual(self.report()["input"]["source"], "probabilities")

        ct = head(values=(1, 2, 1))
        ct.kind, ct.samples = "h", [(-1000, 40, 1000)[v] for v in ct.samples]
        write_nifti(self.path("ct.nii"), ct)
        self.bem("--ct", "ct.nii", *QUICK, "-o", "ct")
        for name, radius in zip(NAMES, RADII):
            points, _ = read_tri(self.path("ct") / f"{name}.tri")
            # half a voxel of 4 mm
            self.assertLess(max(abs(math.dist(p, (0, 0, 0)) - radius) for p in points), 2.5)


@unittest.skipUnless(Path(CHECK).exists(), "needs adaptiso-check")
class PlantedDefects(BemTest):
    """The 19 defects of the checker, given to the maker: a model that the checker passes, or a
    finding with its place; never a model with the defect."""

    MENDED_AT_ONCE = {"an inner vertex pokes out", "all triangles are flipped",
                      "a narrow dent of the outer surface goes through an inner face",
                      "an isolated vertex", "a triangle soup", "a gap of 0.05 mm",
                      "a triangle names a vertex twice", "a second closed component",
                      "two triangles without area, of a collapsed vertex",
                      "a hole", "one triangle is flipped", "a coordinate is NaN"}
    MADE_ANEW = {"a handle", "a spike crosses its own surface"}
    REFUSED = {"inner and outer are swapped": "swapped",
               "all in metres": "in metres?", "the inner surface in metres": "in metres?",
               "all in micrometres": "in micrometres?",
               "the inner surface is 300 mm away": "apart"}

    def test_every_defect_is_mended_or_refused(self):
        self.assertEqual(self.MENDED_AT_ONCE | self.MADE_ANEW | set(self.REFUSED), set(DEFECTS))
        for name, plant in DEFECTS.items():
            with self.subTest(name):
                self.try_defect(name, plant(good()))

    def try_defect(self, name, model):
        files = [self.path(f"s{n}.off") for n in range(3)]
        for path, mesh in zip(files, model):
            write_off(path, mesh)
        # voxels of 3 mm where surfaces are made anew: for speed
        done = self.run_bem("--surfaces", *files, "--voxel", "3", "-o", "model", "--force")
        report = self.report()
        if name in self.REFUSED:
            self.assertEqual(done.returncode, CHECK_FAILED, done.stderr)
            self.assertRegex(report["findings"][0]["what"], re.escape(self.REFUSED[name]))
            self.assertLessEqual(set(os.listdir(self.path("model"))),
                                 {"report.json", "spots.png"})
            return
        self.assertEqual(done.returncode, OK, done.stderr)
        self.assertEqual("made anew" in " ".join(report["notes"]), name in self.MADE_ANEW)
        for kind in ("surf", "tri"):
            files = [self.path("model") / f"{surface}.{kind}" for surface in NAMES]
            check = subprocess.run([CHECK, "--nested", *files, "--min-gap", "2"],
                                   capture_output=True, text=True)
            self.assertEqual(check.returncode, OK, check.stdout)
        if name in self.MENDED_AT_ONCE:
            for surface in report["surfaces"]:
                self.assertLessEqual(abs(surface["vertices"] - 642), 1)  # the dent has one more
        for surface, radius in zip(report["surfaces"], (80, 86, 92)):
            volume_mm3 = 4 / 3 * math.pi * radius ** 3
            self.assertAlmostEqual(surface["volumeMm3"] / volume_mm3, 0.99, delta=0.015)


class Output(BemTest):
    def test_dry_run_writes_nothing_but_json(self):
        done = self.bem(*self.labels(), "--dry-run", "--json", "r.json")
        self.assertEqual(self.names(), ["r.json", "seg.nii"])
        self.assertIn("nothing written", done.stdout)
        self.assertEqual(json.loads(self.path("r.json").read_text())["model"], False)

    def test_nothing_is_replaced_unless_asked_for(self):
        arguments = self.labels()
        self.path("model").mkdir()
        self.bem(*arguments, "-o", "model")  # an empty folder is filled
        self.fails(BAD_INPUT, "exists and is not empty; --force replaces", *arguments, "-o", "model")
        first = (self.path("model") / "inner_skull.tri").read_bytes()
        more = ["300" if a == "162" else a for a in arguments]
        self.bem(*more, "-o", "model", "--force", "--gifti")
        self.assertNotEqual(first, (self.path("model") / "inner_skull.tri").read_bytes())
        self.bem(*arguments, "-o", "model/", "--force")
        self.assertFalse((self.path("model") / "inner_skull.gii").exists())
        (self.path("model") / "thesis.tex").write_text("precious")
        self.fails(BAD_INPUT, "holds thesis.tex", *arguments, "-o", "model", "--force")

    def test_folder_that_cannot_be(self):
        arguments = self.labels()
        self.path("file").write_text("x")
        self.path("link").symlink_to("elsewhere")
        self.fails(BAD_INPUT, "there is no folder nowhere", *arguments, "-o", "nowhere/model")
        self.fails(BAD_INPUT, "exists and is no folder", *arguments, "-o", "file")
        self.fails(BAD_INPUT, "exists and is no folder", *arguments, "-o", "link", "--force")
        self.fails(BAD_INPUT, "holds an input", *arguments, "-o", ".", "--force")

    def test_subject_gets_its_surfaces(self):
        arguments = self.labels()
        where = ("--subjects-dir", "subjects", "--subject", "anna")
        self.fails(BAD_INPUT, "no such subject", *arguments, "-o", "model", *where)
        self.path("subjects/anna/bem").mkdir(parents=True)
        self.bem(*arguments, "-o", "model", *where)
        for name in NAMES:
            self.assertEqual((self.path("subjects/anna/bem") / f"{name}.surf").read_bytes(),
                             (self.path("model") / f"{name}.surf").read_bytes())
        self.fails(BAD_INPUT, "--force replaces it", *arguments, "-o", "new", *where)
        self.bem(*arguments, "-o", "model", "--force", *where)
        inner = self.path("subjects/anna/bem/inner_skull.surf")
        inner.unlink()
        inner.symlink_to("watershed")
        self.fails(BAD_INPUT, "is a link", *arguments, "-o", "new", "--force", *where)

    def test_a_subject_stands_for_its_images_and_its_folder(self):
        mri = self.path("subjects/anna/mri")
        mri.mkdir(parents=True)
        bem = self.path("subjects/anna/bem")
        self.fails(BAD_INPUT, r"subjects/anna/mri/T1\.mgz", "-s", "anna", "-d", "subjects", *QUICK)
        self.assertFalse(bem.exists())
        write_nifti(mri / "T1.mgz", head(values=(100, 10, 200)))
        write_nifti(mri / "brainmask.mgz", head(radii=(30, 31, 32)))  # BemClientsTest takes a right one
        self.fails(BAD_INPUT, r"--brain-mask subjects/anna/mri/brainmask\.mgz", "-s", "anna", "-d", "subjects", *QUICK)
        self.assertFalse(bem.exists())
        surf = self.path("subjects/anna/surf")
        surf.mkdir()
        solved = ("-s", "anna", "-d", "subjects", "--montage", "10-20", "--lead-field", "mne", *QUICK)
        for name in ("lh.pial", "rh.pial", "lh.white"):
            (surf / name).write_text("no surface")
        self.fails(BAD_INPUT, r"subjects/anna/surf/lh\.pial", "-s", "anna", "-d", "subjects", *QUICK)
        (mri / "aseg.mgz").write_text("no image")
        self.fails(BAD_INPUT, r"subjects/anna/mri/aseg\.mgz", "-s", "anna", "-d", "subjects", "--layers", 4, *QUICK)
        (mri / "brainmask.mgz").unlink()
        self.fails(BAD_INPUT, r"subjects/anna/mri/aseg\.mgz", "-s", "anna", "-d", "subjects", *QUICK)
        if importlib.util.find_spec("mne"):
            self.fails(USAGE, "--lead-field needs --sources", *solved)
            (surf / "rh.white").write_text("no surface")
            self.fails(BAD_INPUT, r"subjects/anna/mri/aseg\.mgz", *solved)
        self.bem(*self.labels(), "-s", "anna", env={**os.environ, "SUBJECTS_DIR": "subjects"})
        for name in NAMES:
            self.assertEqual((bem / f"{name}.surf").read_bytes(),
                             self.path(f"subjects/anna/adaptiso-bem/{name}.surf").read_bytes())
        # one surface in place of three: the others stay, and MNE-Python would read them too
        done = self.bem(*self.labels(), "-s", "anna", "-d", "subjects", "--meg", "--force")
        self.assertIn("anna/bem: keeps outer_skull.surf, outer_skin.surf of another model, which MNE-Python would mix with this one",
                      done.stderr)
        # mri_watershed's brain.surf is no surface of the model
        (bem / "brain.surf").write_bytes((bem / "inner_skull.surf").read_bytes())
        self.assertNotIn("another model", self.bem(*self.labels(), "-s", "anna", "-d", "subjects", "--force").stderr)
        self.fails(BAD_INPUT, "subjects/berta: there is no such subject folder", *self.labels(), "-s", "berta", "-d", "subjects")

    def test_interrupted_run_leaves_nothing(self):
        arguments = self.labels()
        run = subprocess.Popen([BEM, *arguments, "-o", "model"], cwd=self.folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            run.wait(timeout=0.3)
        except subprocess.TimeoutExpired:
            run.terminate()
            self.assertEqual(run.wait(timeout=60), -15)
            self.assertEqual(self.names(), ["seg.nii"])

    def test_quiet_prints_nothing(self):
        done = self.bem(*self.labels(), "-o", "model", "--quiet")
        self.assertEqual((done.stdout, done.stderr), ("", ""))


def finer(arguments):
    """With as many vertices as show a narrow part."""
    return ["642" if argument == "162" else argument for argument in arguments]


class Plausibility(BemTest):
    FIGURES = {"necks": {"neckReachMm"}, "notCutFlat": {"flatShare"}, "edgesInProportion": {"edgeRatio"},
               "innerSkullVolume": {"innerSkullCm3"}, "dents": {"dentMm"},
               "skullThickness": {"skullMedianMm", "skullThickMm", "skullThickToThin"},
               "scalpThickness": {"scalpMedianMm", "scalpThickMm"}, "edgesAgainstGap": {"coarseShare"},
               "vertexCounts": {"vertexRatio"}}

    def test_what_is_noted_has_a_value_beyond_its_limits(self):
        def is_beyond(figure):
            least, most, value = figure["least"], figure["most"], figure["value"]
            return (least is not None and value < least) or (most is not None and value > most)

        noted = set()
        for image in (head(), head(n=44, origin=(-86, -64, -86))):
            self.bem(*finer(self.labels(image=image)), "-o", "model", "--force")
            report = self.report()
            for note in report["plausibility"]:
                figures = [each for each in report["limits"]
                           if each["of"] == note["of"] and each["name"] in self.FIGURES[note["name"]]]
                self.assertEqual({each["name"] for each in figures}, self.FIGURES[note["name"]])
                self.assertEqual(any(map(is_beyond, figures)), note["outcome"] == "noted", note)
                if note["outcome"] == "noted":
                    noted.add(note["name"])
            self.assertEqual(len(report["limits"]),
                             sum(len(self.FIGURES[note["name"]]) for note in report["plausibility"]))
        self.assertLessEqual({"innerSkullVolume", "notCutFlat"}, noted)

    def test_is_told_in_report_and_text(self):
        done = self.bem(*self.labels(), "-o", "model")
        notes = {(note["name"], note["of"]): note for note in self.report()["plausibility"]}
        self.assertEqual({name for name, _ in notes},
                         {"necks", "notCutFlat", "edgesInProportion", "innerSkullVolume", "dents",
                          "skullThickness", "scalpThickness", "edgesAgainstGap", "vertexCounts"})
        # 60 mm: 905 cm3, a child's
        volume = notes["innerSkullVolume", "inner_skull"]
        self.assertEqual(volume["outcome"], "noted")
        self.assertRegex(volume["finding"], r"^(8[5-9]|90)\d cm3; adults have 950 to 1900 cm3; of a child give adaptiso-bem --age$")
        noted = [note for note in notes.values() if note["outcome"] == "noted"]
        self.assertRegex(done.stdout, rf"\n\d+ of \d+ checks passed; {len(noted)} of {len(notes)} "
                                      "questions of plausibility noted")
        self.assertIn("\n  noted: inner_skull: volume of the inner skull: ", done.stdout)
        self.assertRegex(done.stdout, "\nhead model written to model/\n")

    def test_a_head_cut_beside_the_brain_is_a_warning(self):
        # the image ends at y = -66, where the outer skull does; the scalp behind is not in it
        self.bem(*finer(self.labels(image=head(n=44, origin=(-86, -64, -86)))), "-o", "model")
        cut, = [w for w in self.report()["warnings"] if w["code"] == "head-cut"]
        self.assertRegex(cut["text"], r"^outer_skin: .* on the image's back face: the head is cut there")

    def test_limits_are_those_of_the_age(self):
        # 60 mm: 905 cm3; at half a year 513 to 1217
        self.bem(*self.labels(), "--age", "0.5", "-o", "model")
        volume, = [n for n in self.report()["plausibility"] if n["name"] == "innerSkullVolume"]
        self.assertEqual(volume["outcome"], "passed")
        self.assertRegex(volume["finding"], r"cm3, usual of heads of 0.5 years: 513 to 1217 cm3$")
        self.assertEqual(self.report()["options"]["ageYears"], 0.5)
        self.assertAlmostEqual(self.report()["options"]["skullMm"], 2.47, delta=0.01)

    def test_a_cut_head_is_noted_with_its_place(self):
        # the image ends at z = -66, where the outer skull does; the skin would reach 6 mm lower
        arguments = finer(self.labels(image=head(n=44, origin=(-86, -86, -64))))
        self.bem(*arguments, "-o", "model")
        flat, = [note for note in self.report()["plausibility"]
                 if (note["name"], note["of"]) == ("notCutFlat", "outer_skin")]
        self.assertEqual((flat["outcome"], flat["pointsIn"]), ("noted", "lps"))
        self.assertRegex(flat["finding"], r"^\d+ of 642 vertices .* on the image's lower face")
        self.assertAlmostEqual(flat["pointsMm"][0][2], -68, delta=3)  # the least scalp below
        self.assertNotIn("head-cut", [w["code"] for w in self.report()["warnings"]])


class Necks(BemTest):
    """A tube 12 mm wide that leaves the inner skull by 25 mm."""

    def tongue_mm(self, *arguments):
        image = head()
        samples, n = bytearray(image.samples), 44
        for k in range(n):
            for j in range(n):
                for i in range(n):
                    x, y, z = (STEP * (v - (n - 1) / 2) for v in (i, j, k))
                    if math.hypot(x - 2, y - 2) <= 6 and -85 <= z < 0:
                        samples[i + n * (j + n * k)] = 1
        image = Image(image.size, "B", bytes(samples), image.spacing, image.origin)
        self.bem(*finer(self.labels(image=image)), "-o", "model", "--force", "--meg", *arguments)
        points, _ = read_tri(self.path("model/inner_skull.tri"))
        return -60 - min(point[2] for point in points)

    def test_are_cut_unless_told_otherwise(self):
        self.assertGreater(self.tongue_mm("--cut-necks", "0"), 15)
        self.assertEqual([note for note in self.report()["notes"] if "neck" in note], [])
        neck = self.report()["plausibility"][0]
        self.assertEqual((neck["name"], neck["outcome"]), ("necks", "noted"))
        # a stub, half a voxel of 4 mm and what voxels of 3 mm add
        self.assertLess(self.tongue_mm(), 6)
        self.assertEqual(self.report()["options"]["cutNecksMm"], 8)
        self.assertRegex(" ".join(self.report()["notes"]), "inner skull: a neck of .* was cut off")
        self.assertEqual(self.report()["plausibility"][0]["outcome"], "passed")


class BadInput(BemTest):
    def test_usage(self):
        write_nifti(self.path("a.nii"), Image((2, 2, 2), "B", bytes(8)))
        cases = {
            "one of --t1, --labels": ("-o", "m"),
            "and one only": ("--t1", "a.nii", "--ct", "a.nii", "-o", "m"),
            "--brain-mask needs --t1": ("--ct", "a.nii", "--brain-mask", "a.nii", "-o", "m"),
            "--labels needs --preset": ("--labels", "a.nii", "-o", "m"),
            "skull=... and scalp=": ("--labels", "a.nii", "--tissue", "brain=1", "-o", "m"),
            "must be white, brain, csf, skull, spongy or scalp": ("--labels", "a.nii", "--tissue", "eyes=1", "-o", "m"),
            "labels or ranges": ("--labels", "a.nii", "--tissue", "brain=1,x", "-o", "m"),
            "ranges of them": ("--labels", "a.nii", "--tissue", "brain=3-1", "-o", "m"),
            "labels or ranges of": ("--labels", "a.nii", "--tissue", f"brain={-2**63}-{2**63 - 1}", "-o", "m"),
            "--preset needs --labels": ("--t1", "a.nii", "--preset", "charm", "-o", "m"),
            "--surfaces needs 3 files": ("--surfaces", "a.stl", "-o", "m"),
            "--surfaces needs 1 files": ("--surfaces", "a.stl", "b.stl", "--meg", "-o", "m"),
            "-o DIR is needed": ("--t1", "a.nii"),
            "need each other": ("--t1", "a.nii", "-o", "m", "--subject", "x"),
            "name of a folder": ("--t1", "a.nii", "-o", "m", "--subjects-dir", "s", "--subject",
                                 "../x"),
            "0 < MIN <= MAX": ("--t1", "a.nii", "-o", "m", "--edge-length", "9:3"),
            "MIN:MAX": ("--t1", "a.nii", "-o", "m", "--edge-length", "9"),
            "0.5 mm or more": ("--t1", "a.nii", "-o", "m", "--min-gap", "0.4"),
            "one number, or 3": ("--t1", "a.nii", "-o", "m", "--vertices", "642,642"),
            "one to four numbers": ("--t1", "a.nii", "-o", "m", "--min-gap", "1,2,3,4,5"),
            "above 0 and at most 10": ("--t1", "a.nii", "-o", "m", "--conductivity", "0.3,0,0.3"),
            "--max-skull must be more": ("--t1", "a.nii", "-o", "m", "--max-skull", "1"),
            "--skull must lie between": ("--t1", "a.nii", "-o", "m", "--skull", "30"),
            "the skull's usual thickness at --age does not lie between --min-gap": (
                "--t1", "a.nii", "-o", "m", "--age", "0", "--min-gap", "3"),
            "--csf -1: must be a number from 0 to 20, in mm": ("--t1", "a.nii", "-o", "m", "--csf", "-1"),
            "--vertices": ("--t1", "a.nii", "-o", "m", "--vertices", "3"),
            "--cut-necks 21: must be a number from 0 to 20, in mm":
                ("--t1", "a.nii", "-o", "m", "--cut-necks", "21"),
            "--smoothing 11: must be a number from 0 to 10, in mm":
                ("--t1", "a.nii", "-o", "m", "--smoothing", "11"),
            "--skin-hu must lie above air": ("--ct", "a.nii", "-o", "m", "--skin-hu", "400"),
            "--conductivity: a conductivity of 30 S/m":
                ("--t1", "a.nii", "-o", "m", "--conductivity", "1,2,30"),
        }
        for pattern, arguments in cases.items():
            with self.subTest(pattern):
                self.fails(USAGE, re.escape(pattern), *arguments)

    def test_a_mask_of_several_volumes(self):
        write_nifti(self.path("a.nii"), Image((2, 2, 2), "B", bytes(8)))
        write_4d_nifti(self.path("4d.nii"), [Image((2, 2, 2), "B", bytes(8))] * 2)
        self.fails(BAD_INPUT, "4d.nii: holds 2 volumes, must hold one here", "--t1", "a.nii", "--brain-mask", "4d.nii",
                   "-o", "m")

    def test_images_without_a_head(self):
        write_nifti(self.path("flat.nii"), Image((20, 20, 20), "B", bytes(8000)))
        self.fails(BAD_INPUT, r"^adaptiso-bem: --t1 flat\.nii: all samples are equal; there is no "
                              "head", "--t1", "flat.nii", "-o", "m")
        self.fails(BAD_INPUT, "no label of the tissue brain", "--labels", "flat.nii", "--preset",
                   "charm", "-o", "m")
        self.fails(BAD_INPUT, r"^adaptiso-bem: --ct flat\.nii: the samples lie in 0 to 0 and are "
                              "not in Hounsfield units", "--ct", "flat.nii", "-o", "m")
        self.fails(BAD_INPUT, "there are 1 maps", "--probabilities", "flat.nii", "-o", "m")
        self.fails(BAD_INPUT, r"missing\.nii", "--t1", "missing.nii", "-o", "m")
        self.fails(BAD_INPUT, r"^adaptiso-bem: --labels seg\.nii: label 2 is named twice",
                   *self.labels(), "--tissue", "brain=2-2", "-o", "m")
        self.fails(BAD_INPUT, r"^adaptiso-bem: --t1 seg\.nii: holds 4 labels and no grey values; give it as the "
                              r"label map \(--labels\)", "--t1", "seg.nii", "-o", "m")
        labels = self.labels()
        scaled = bytearray(self.path("seg.nii").read_bytes())
        scaled[112:120] = struct.pack("<ff", 0.75, 0)  # scl_slope, scl_inter
        self.path("seg.nii").write_bytes(scaled)
        self.fails(BAD_INPUT, r"--labels seg\.nii \(its header scales the stored values: scl_slope 0\.75, "
                              r"scl_inter 0\): .*no label of the tissue", *labels, "-o", "m")
        self.path("seg.nii").unlink()
        self.fails(BAD_INPUT, r"missing\.stl", "--surfaces", "missing.stl", "--meg", "-o", "m")


class Report(BemTest):
    def test_keys_are_the_documented_ones(self):
        skin = RADII[-1]
        self.bem(*self.labels(), "--montage", "10-20", "--nasion", f"0,{skin},0",
                 f"--left-ear=-{skin},0,0", "--right-ear", f"{skin},0,0", f"--inion=0,-{skin},0", "--source-grid", 10, "-o", "model")
        section = README.read_text().split("## The report")[1]
        documented = set()
        for row in re.findall(r"^\| (`.*?`) \|", section, re.MULTILINE):
            documented.update(re.findall(r"`([^`]+)`", row))

        def keys(value, path=""):
            if isinstance(value, dict):
                return {leaf for key, inner in value.items()
                        for leaf in keys(inner, f"{path}.{key}" if path else key)}
            if isinstance(value, list) and value and isinstance(value[0], dict):
                return {leaf for item in value for leaf in keys(item, path)}
            return {path}

        self.assertEqual(keys(self.report()), documented)


if __name__ == "__main__":
    main()
