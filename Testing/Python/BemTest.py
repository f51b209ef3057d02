"""Head models: the bytes of adaptiso-bem, truth on paper, what MNE makes of them, what is refused."""

import copy
import functools
import json
import os
import pickle
import shutil
import unittest
import unittest.mock

import adaptiso
import numpy as np
from adaptiso._arguments import Warned
from support import InFolder, needs, program

NAMES = ("inner_skull", "outer_skull", "outer_skin")
RADII = (60, 66, 72)
STEP = 4
#: voxels of 4 mm, so that all is quick; the working grid is 3 mm
QUICK = {"voxel": 3, "vertices": 162, "closing": 4}
ARGUMENTS = ["--voxel", 3, "--vertices", 162, "--closing", 4]
TISSUES = {"brain": [1], "skull": [2], "scalp": [3]}


def affine(n=44, centre=(0, 0, 0)):
    matrix = np.diag([STEP, STEP, STEP, 1.0])
    matrix[:3, 3] = np.array(centre) - STEP * (n - 1) / 2
    return matrix


def spheres(values=(1, 2, 3), radii=RADII, n=44):
    """Labels of three spheres around the middle, i fastest."""
    i, j, k = np.indices((n, n, n)) * STEP - STEP * (n - 1) / 2
    radius = np.sqrt(i * i + j * j + k * k)
    table = np.array([*values, 0], np.uint8)
    return np.asfortranarray(table[np.searchsorted(radii, radius)])


def phantom(n=44):
    """A T1 of three spheres: bright brain, dark skull, bright scalp; and the brain's mask."""
    t1 = np.array([0, 100, 20, 140], np.uint8)[spheres(n=n)]
    return np.asfortranarray(t1), np.asfortranarray((spheres(n=n) == 1).astype(np.uint8))


@functools.cache
def three_spheres():
    """One for all tests: nothing of a model changes."""
    return adaptiso.bem(labels=spheres(), tissues=TISSUES, affine=affine(), **QUICK)


class Truth(unittest.TestCase):
    def setUp(self):
        self.model = three_spheres()

    def test_surfaces_are_the_spheres(self):
        self.assertEqual(tuple(self.model.surfaces), NAMES)
        for (name, mesh), radius in zip(self.model.surfaces.items(), RADII):
            self.assertEqual((len(mesh.vertices), len(mesh.faces)), (162, 320))
            distance = np.linalg.norm(mesh.vertices, axis=1)
            self.assertLess(np.abs(distance - radius).max(), 2)  # binary voxels of 4 mm: half of one
            self.assertLess(abs(distance.mean() - radius), 0.7)
            self.assertGreater(mesh.volume, 0)
            self.assertEqual(mesh.frame, "ras")

    def test_the_check_is_the_checker_s(self):
        self.assertTrue(self.model.check)
        found = adaptiso.check_nested(list(self.model.surfaces.values()), names=list(NAMES),
                                      min_gap=2)
        for key in ("passed", "surfaces", "nesting"):
            self.assertEqual(self.model.check.report[key], found.report[key], key)

    def test_pickles_have_all_but_the_image(self):
        again = pickle.loads(pickle.dumps(self.model))
        self.assertEqual(again.surfaces, self.model.surfaces)
        self.assertEqual(again.check, self.model.check)
        self.assertEqual(repr(again), repr(self.model))
        self.assertEqual(pickle.loads(pickle.dumps(again)).report, self.model.report)
        for one, other in zip(again.to_mne(), self.model.to_mne()):
            np.testing.assert_array_equal(one["rr"], other["rr"])
        for call in (again.report_html, lambda: again.save("nowhere")):
            with self.assertRaisesRegex(adaptiso.Error, "in the process that made it"):
                call()
        self.assertIs(copy.deepcopy(self.model), self.model)
        self.model.surfaces.clear()
        self.assertEqual(tuple(self.model.surfaces), NAMES)

    def test_the_page_shows_the_model(self):
        page = self.model.report_html()
        self.assertTrue(page.startswith("<!DOCTYPE html>"))
        for text in ("PASSED", "inner_skull", "Head model of three layers", *NAMES):
            self.assertIn(text, page)

    def test_repr_tells_the_surfaces(self):
        self.assertEqual(repr(self.model), "<adaptiso.HeadModel: " + ", ".join(
            f"{name} of 162 vertices" for name in NAMES) + ">")
        rebuilt, (state, threads) = self.model.__reduce__()
        guessed = {**state, "warnings": [Warned("", "guessed-brain")]}
        self.assertRegex(repr(rebuilt(guessed, threads)), "162 vertices; the brain was guessed>$")

    def test_orders_of_samples_make_no_difference(self):
        for labels in (np.ascontiguousarray(spheres()), spheres().astype(np.int32)):
            other = adaptiso.bem(labels=labels, tissues=TISSUES, affine=affine(), **QUICK)
            self.assertEqual(list(other.surfaces.values()), list(self.model.surfaces.values()))
            self.assertTrue(labels.flags.writeable)

    def test_one_surface_for_meg(self):
        model = adaptiso.bem(labels=spheres(), tissues={"brain": [1]}, affine=affine(), meg=True,
                             **QUICK)
        self.assertEqual(list(model.surfaces), ["inner_skull"])
        self.assertEqual([surface["id"] for surface in model.to_mne()], [1])

    def test_progress_is_told_and_can_stop(self):
        stages = []
        adaptiso.bem(labels=spheres(), tissues=TISSUES, affine=affine(), **QUICK,
                     progress=lambda stage, done: stages.append(stage))
        self.assertIn("remesh", stages)

        def stop(stage, done):
            raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            adaptiso.bem(labels=spheres(), tissues=TISSUES, affine=affine(), progress=stop, **QUICK)


@needs("nibabel")
class Bytes(InFolder):
    def image(self, name, samples, matrix=None):
        import nibabel
        path = self.folder / name
        nibabel.save(nibabel.Nifti1Image(samples, affine() if matrix is None else matrix), path)
        return path

    def compare(self, arguments, model, **options):
        """The folder is the program's, but for who made it and how long it took."""
        theirs, ours = self.folder / "theirs", self.folder / "ours"
        program("adaptiso-bem", *arguments, "-o", theirs, "--force")
        model.save(ours, replace=True, **options)
        self.assertEqual(sorted(file.name for file in ours.iterdir()),
                         sorted(file.name for file in theirs.iterdir()))
        for file in theirs.iterdir():
            if file.suffix not in (".json", ".md"):
                self.assertEqual((ours / file.name).read_bytes(), file.read_bytes(), file.name)
        readmes = [(folder / "README.md").read_text().replace("adaptiso (Python)", "adaptiso-bem")
                   for folder in (ours, theirs)]
        self.assertEqual(*readmes)
        reports = [json.loads((folder / "report.json").read_text()) for folder in (ours, theirs)]
        del reports[1]["result"]  # for a batch, which Python has none of
        self.assertEqual(*map(list, reports))
        for report in reports:
            for key in ("program", "seconds", "peakMemoryMb"):
                report.pop(key)
            report["options"].pop("picture", None)  # Python draws none
            for file in report["output"]["files"]:
                if file["file"] == "README.md":
                    file.pop("bytes")
        self.assertEqual(*reports)

    def test_of_labels(self):
        path = self.image("seg.nii", spheres())
        self.compare(["--labels", path, "--tissue", "brain=1", "--tissue", "skull=2", "--tissue",
                      "scalp=3", "--gifti", "--vtp", *ARGUMENTS],
                     adaptiso.bem(labels=path, tissues=TISSUES, **QUICK), gifti=True, vtp=True)

    def test_of_labels_with_a_head_mask(self):
        """Brain and skull as TotalSegmentator has them; the skin is its body's."""
        path = self.image("seg.nii", spheres((90, 91, 0)))
        body = self.image("body.nii", (spheres() > 0).astype(np.uint8))
        arguments = ["--labels", path, "--head-mask", body, "--gifti", "--vtp", *ARGUMENTS]
        options = {"labels": path, "head_mask": body, **QUICK}
        named = adaptiso.bem(tissues="totalsegmentator", **options)
        self.compare(["--preset", "totalsegmentator", *arguments],
                     named, gifti=True, vtp=True)
        self.assertEqual(adaptiso.bem(tissues={"brain": [90], "skull": [91]}, **options).surfaces,
                         named.surfaces)

    def test_of_a_t1_with_its_mask_in_other_frames_and_units(self):
        t1, mask = phantom()
        tilted = affine(centre=(12, -8, 20)) @ np.array(
            [[0.99, -0.14, 0, 0], [0.14, 0.99, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        paths = self.image("t1.nii", t1, tilted), self.image("mask.nii", mask, tilted)
        self.compare(["--t1", paths[0], "--brain-mask", paths[1], "--coordinates", "lps", "--units",
                      "m", "--min-gap", "3,2.5", "--conductivity", "0.33,0.0041,0.43", *ARGUMENTS],
                     adaptiso.bem(t1=paths[0], brain_mask=paths[1], min_gap=(3, 2.5),
                                  conductivity=(0.33, 0.0041, 0.43), **QUICK),
                     units="m", frame="lps")

    def test_of_probabilities_and_of_a_ct(self):
        maps = [self.image(f"c{n + 1}.nii", spheres(values)) for n, values in enumerate(
            ((100, 0, 0), (100, 0, 0), (55, 0, 0), (0, 255, 0), (0, 0, 255)))]
        self.compare(["--probabilities", *maps, *ARGUMENTS],
                     adaptiso.bem(probabilities=maps, **QUICK))
        ct = self.image("ct.nii", np.asfortranarray(
            np.array([-1000, 40, 1000, 40], np.int16)[spheres()]))
        self.compare(["--ct", ct, "--meg", *ARGUMENTS], adaptiso.bem(ct=ct, meg=True, **QUICK))

    def test_of_surfaces(self):
        model = three_spheres()
        files = []
        for name, mesh in model.surfaces.items():
            files.append(self.folder / f"{name}.vtp")
            mesh.save(files[-1])
        theirs, ours = self.folder / "theirs", self.folder / "ours"
        program("adaptiso-bem", "--surfaces", *files, "-o", theirs)
        adaptiso.bem(surfaces=files).save(ours)
        adaptiso.bem(surfaces={name: (mesh.vertices, mesh.faces) for name, mesh in model.surfaces.items()}
                     ).save(self.folder / "arrays")
        for name in NAMES:
            truth = (theirs / f"{name}.tri").read_bytes()
            self.assertEqual((ours / f"{name}.tri").read_bytes(), truth)
            self.assertEqual((self.folder / "arrays" / f"{name}.tri").read_bytes(), truth)

    def test_a_saved_surface_is_the_model_s(self):
        path = self.image("seg.nii", spheres())
        model = adaptiso.bem(labels=path, tissues=TISSUES, **QUICK)
        model.save(self.folder / "model")
        for name, mesh in model.surfaces.items():
            mesh.save(self.folder / f"{name}.surf")
            self.assertEqual((self.folder / f"{name}.surf").read_bytes(),
                             (self.folder / "model" / f"{name}.surf").read_bytes())

    def test_nothing_else_is_replaced(self):
        model = adaptiso.bem(labels=spheres(), tissues={"brain": [1]}, affine=affine(), meg=True,
                             **QUICK)
        folder = self.folder / "model"
        model.save(folder)
        before = sorted(path.name for path in folder.iterdir())
        with self.assertRaisesRegex(adaptiso.Error, "replace=True"):
            model.save(folder)
        (folder / "notes.txt").write_text("mine")
        with self.assertRaisesRegex(adaptiso.Error, "holds notes.txt"):
            model.save(folder, replace=True)
        (folder / "notes.txt").unlink()
        model.save(folder, replace=True)
        self.assertEqual(sorted(path.name for path in folder.iterdir()), before)
        with self.assertRaises(adaptiso.Error):
            model.save(self.folder / "no" / "model")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["model"])


FOUR = {"brain": [1], "csf": [2], "skull": [3], "scalp": [4]}


def four_spheres():
    return spheres((1, 2, 3, 4), (52, 60, 66, 72))


class Tetrahedra(InFolder):
    image, compare = Bytes.image, Bytes.compare

    @needs("nibabel")
    def test_are_the_program_s(self):
        path = self.image("seg.nii", spheres())
        named = ["--tissue", "brain=1", "--tissue", "skull=2", "--tissue", "scalp=3"]
        for mesher in filter(shutil.which, ("tetgen", "gmsh")):
            with self.subTest(mesher):
                model = adaptiso.bem(labels=str(path), tissues=TISSUES, tetrahedra=mesher, element_size=12, **QUICK)
                layers = model.report["tetrahedra"]["layers"]
                self.assertEqual([layer["tissue"] for layer in layers], ["brain", "skull", "scalp"])
                self.assertIn("tetrahedra", model.report["seconds"])
                self.compare(["--labels", path, *named, *ARGUMENTS, "--tetrahedra", mesher, "--element-size", 12], model)

    def test_a_mesher_that_is_missing_or_fails_is_said(self):
        def bem(**options):
            return adaptiso.bem(labels=spheres(), tissues=TISSUES, affine=affine(), **QUICK, **options)
        for options, pattern in (({"tetrahedra": "netgen"}, "tetrahedra 'netgen': must be"),
                                 ({"element_size": 0.1}, "element_size 0.1: must be a number from 0.5 to 50, in mm")):
            with self.assertRaisesRegex(adaptiso.Error, pattern):
                bem(**options)
        tools = self.folder / "tools"
        tools.mkdir()
        with unittest.mock.patch.dict(os.environ, PATH=str(tools)):
            with self.assertRaisesRegex(adaptiso.Error, "tetrahedra tetgen: tetgen is not installed"):
                bem(tetrahedra="tetgen")
            (tools / "tetgen").write_text("#!/bin/sh\nexit 3\n")
            (tools / "tetgen").chmod(0o755)
            with self.assertRaisesRegex(adaptiso.Error, r"tetgen: made no tetrahedra \(exit code 3\)"):
                bem(tetrahedra="tetgen")


class FourLayers(InFolder):
    def test_the_brain_is_a_sphere_within_the_skull(self):
        model = adaptiso.bem(labels=four_spheres(), tissues=FOUR, affine=affine(), layers=4,
                             conductivity=(0.33, 1.7, 0.0041, 0.43), **QUICK)
        self.assertEqual(tuple(model.surfaces), ("brain", *NAMES))
        for mesh, radius in zip(model.surfaces.values(), (52, *RADII)):
            distance = np.linalg.norm(mesh.vertices, axis=1)
            self.assertLess(abs(distance.mean() - radius), 0.7)
        self.assertTrue(model.check)
        self.assertEqual(model.report["options"]["layers"], 4)
        # MNE has three: all within the inner skull conducts as the brain
        self.assertEqual([(surface["id"], surface["sigma"]) for surface in model.to_mne()],
                         [(4, 0.43), (3, 0.0041), (1, 0.33)])
        self.assertIn("brain of 162 vertices", repr(model))

    def test_five_have_white_matter(self):
        model = adaptiso.bem(labels=spheres((5, 1, 2, 3, 4), (44, 52, 60, 66, 72)), tissues={**FOUR, "white": [5]},
                             affine=affine(), layers=5, **QUICK)
        self.assertEqual(tuple(model.surfaces), adaptiso._bem.SURFACES)
        self.assertEqual(model.report["options"]["conductivity"],
                         {"white": 0.126, "brain": 0.275, "csf": 1.654, "skull": 0.01, "scalp": 0.465})
        self.assertEqual([surface["sigma"] for surface in model.to_mne()], [0.465, 0.01, 0.275])

    @needs("nibabel")
    def test_bytes_are_the_program_s(self):
        import nibabel
        nibabel.save(nibabel.Nifti1Image(four_spheres(), affine()), self.folder / "seg.nii")
        theirs, ours = self.folder / "theirs", self.folder / "ours"
        named = ["--tissue", "brain=1", "--tissue", "csf=2", "--tissue", "skull=3", "--tissue", "scalp=4"]
        program("adaptiso-bem", "--labels", self.folder / "seg.nii", *named, "--layers", 4, *ARGUMENTS,
                "--montage", "10-20", "--nasion", "0,71,-9", "--left-ear=-70,0,-15", "--right-ear",
                "70,0,-15", "--fif", "--fieldtrip", "--brainstorm", "--simnibs", "--besa",
                "-o", theirs)
        model = adaptiso.bem(
            labels=self.folder / "seg.nii", tissues=FOUR, layers=4, montage="10-20", head_shape=True,
            landmarks={"nasion": (0, 71, -9), "left_ear": (-70, 0, -15), "right_ear": (70, 0, -15)},
            **QUICK)
        model.save(ours, fif=True, fieldtrip=True, brainstorm=True, simnibs=True, besa=True)
        self.assertEqual(sorted(file.name for file in ours.iterdir()),
                         sorted(file.name for file in theirs.iterdir()))
        for file in theirs.iterdir():
            if file.suffix not in (".json", ".md") or file.name == "coordsystem.json":
                self.assertEqual((ours / file.name).read_bytes(), file.read_bytes(), file.name)

    @needs("nibabel")
    def test_sources_are_the_programs_to_the_byte(self):
        import nibabel
        cortex = adaptiso.surface((spheres(radii=(40, 66, 72)) == 1).astype(np.uint8), 0.5, affine=affine())
        cortex.save(self.folder / "lh.vtp")
        nibabel.save(nibabel.Nifti1Image(np.asfortranarray(spheres()), affine()), self.folder / "seg.nii")
        for options, arguments in (
                ({"sources": [cortex], "source_count": 50},
                 ["--sources", self.folder / "lh.vtp", "--source-count", 50]),
                ({"source_grid": 15}, ["--source-grid", 15])):
            model = adaptiso.bem(labels=spheres(), tissues=TISSUES, affine=affine(), **options, **QUICK)
            model.save(self.folder / "ours", replace=True)
            program("adaptiso-bem", "--labels", self.folder / "seg.nii", "--tissue", "brain=1",
                    "--tissue", "skull=2", "--tissue", "scalp=3", *arguments, *ARGUMENTS, "-o",
                    self.folder / "theirs", "--force")
            for name in ("dipoles.txt", "sources-src.fif"):
                self.assertEqual((self.folder / "ours" / name).read_bytes(),
                                 (self.folder / "theirs" / name).read_bytes(), name)
        with self.assertRaisesRegex(adaptiso.Error, "sources and source_grid"):
            adaptiso.bem(labels=spheres(), tissues=TISSUES, affine=affine(), sources=[cortex], source_grid=10)
        far = adaptiso.Mesh(cortex.vertices + 200, cortex.faces)
        with self.assertRaisesRegex(adaptiso.Error, "sources: 100.0 % of the sources lie outside inner_skull"):
            adaptiso.bem(labels=spheres(), tissues=TISSUES, affine=affine(), sources=[far], **QUICK)
        for options, rule in (({"sources": [cortex] * 3}, "sources must be one or two surfaces"),
                              ({"sources": []}, "sources must be one or two surfaces"),
                              ({"sources": [cortex] * 2}, "sources: both surfaces are the same"),
                              ({"source_count": 50}, "source_count needs sources"),
                              ({"source_count": 4098, "source_grid": 15}, "source_count needs sources")):
            with self.assertRaisesRegex(adaptiso.Error, rule):
                adaptiso.bem(labels=spheres(), tissues=TISSUES, affine=affine(), **options, **QUICK)

    def test_stated_frames_are_of_all_surfaces_in_order(self):
        ready = [self.folder / f"{name}.stl" for name in NAMES]
        for name, path in zip(NAMES, ready):
            three_spheres().surfaces[name].save(path)
        cortex = adaptiso.Mesh(three_spheres().surfaces["inner_skull"].vertices / 2 + (9, 0, 0),
                               three_spheres().surfaces["inner_skull"].faces)
        lps = adaptiso.Mesh(cortex.vertices * (-1, -1, 1), cortex.faces)
        lps.save(self.folder / "lh.stl")
        options = {"surfaces": ready, "sources": [self.folder / "lh.stl"]}
        model = adaptiso.bem(**options, input_coordinates=["ras"] * 3 + ["lps"], vertices=162)
        model.save(self.folder / "model")
        places = np.loadtxt(self.folder / "model" / "dipoles.txt")[:, :3]
        np.testing.assert_allclose(places.mean(axis=0), cortex.vertices.mean(axis=0), atol=0.01)
        for words in (["ras"] * 3, ["lps"], ["ras"] * 5):
            with self.assertRaisesRegex(adaptiso.Error, "one for each surface"):
                adaptiso.bem(**options, input_coordinates=words)

    @needs("nibabel")
    def test_pial_surfaces_and_aseg_are_taken_as_by_the_program(self):
        import nibabel
        t1, mask = phantom()
        distance = np.linalg.norm(np.stack(np.indices((44,) * 3), -1) * STEP - STEP * 21.5, axis=-1)
        pial = adaptiso.surface(np.asfortranarray(-distance), -48, affine=affine())
        # 2 white matter, 3 cortex, 24 CSF
        aseg = np.where(distance < 40, 2, np.where(distance < 50, 3, np.where(mask == 1, 24, 0))).astype(np.uint8)
        pial.save(self.folder / "lh.vtp")
        for name, samples in (("t1", t1), ("mask", mask), ("aseg", aseg)):
            nibabel.save(nibabel.Nifti1Image(np.asfortranarray(samples), affine()),
                         self.folder / f"{name}.nii")
        for layers, options, arguments, note in (
                (4, {"brain_mask": mask, "pial": [pial]}, ["--brain-mask", "mask.nii", "--pial", "lh.vtp"],
                 "brain surface: holds the pial surfaces"),
                (5, {"aseg": aseg}, ["--aseg", "aseg.nii"], "brain surface: by the labels")):
            model = adaptiso.bem(t1=t1, affine=affine(), layers=layers, **options, **QUICK)
            self.assertIn(note, model.report["notes"])
            model.save(self.folder / "ours", replace=True)
            paths = [self.folder / word if "." in word else word for word in arguments]
            program("adaptiso-bem", "--t1", self.folder / "t1.nii", *paths, "--layers", layers, *ARGUMENTS,
                    "-o", self.folder / "theirs", "--force")
            for name in adaptiso._bem.SURFACES[-layers:]:
                self.assertEqual((self.folder / "ours" / f"{name}.tri").read_bytes(),
                                 (self.folder / "theirs" / f"{name}.tri").read_bytes(), name)
        for name, radius in (("brain", 50), ("white_matter", 40)):
            places = np.linalg.norm(model.surfaces[name].vertices, axis=1)
            self.assertLess(abs(places.mean() - radius), 1)  # voxels of 4 mm


class Electrodes(unittest.TestCase):
    def test_places_by_name_come_onto_the_skin(self):
        places = {"Cz": (0, 0, 80), "T7": (-90.0, 0, 0)}
        model = adaptiso.bem(labels=spheres(), tissues=TISSUES, affine=affine(), electrodes=places,
                             **QUICK)
        self.assertEqual(list(model.electrodes), ["Cz", "T7"])
        for name, place in places.items():
            on_skin = np.array(model.electrodes[name])
            self.assertLess(abs(np.linalg.norm(on_skin) - 72), 2)
            cosine = on_skin @ np.array(place) / np.linalg.norm(on_skin) / np.linalg.norm(place)
            self.assertGreater(cosine, 0.995)
        self.assertEqual(model.landmarks, {})

    def test_places_that_are_missing_are_left_out_with_a_warning(self):
        places = {"Cz": (0, 0, 80), "EOG": (np.nan,) * 3, "ECG": None, "T7": np.array([-90.0, 0, 0])}
        model = adaptiso.bem(labels=spheres(), tissues=TISSUES, affine=affine(), electrodes=places,
                             **QUICK)
        (warning,) = [w for w in model.report["warnings"] if w["code"] == "electrodes-left-out"]
        self.assertIn("2 of its 4 points have no place and were left out: EOG, ECG", warning["text"])
        self.assertEqual(list(model.electrodes), ["Cz", "T7"])

    def test_a_montage_has_its_positions(self):
        model = adaptiso.bem(
            labels=spheres(), tissues=TISSUES, affine=affine(), montage="10-20",
            landmarks={"nasion": (0, 72, 0), "left_ear": (-72, 0, 0), "right_ear": (72, 0, 0)}, **QUICK)
        self.assertEqual(len(model.electrodes), 21)
        self.assertGreater(model.electrodes["Cz"][2], 70)
        self.assertEqual(set(model.landmarks), {"Nasion", "LPA", "RPA"})
        np.testing.assert_allclose(model.landmarks["LPA"], (-72, 0, 0))

    def test_what_cannot_be_used_is_refused(self):
        common = {"labels": spheres(), "tissues": TISSUES, "affine": affine(), **QUICK}
        for options in ({"electrodes": {"Cz": (0, 0)}}, {"electrodes": {3: (0, 0, 80)}},
                        {"electrodes": {"Cz": (0, 0, 800)}}, {"electrodes": "nowhere.elc"},
                        {"electrodes": {"Cz": (0, 0, 80)}, "montage": "10-20"}, {"montage": "10-30"},
                        {"electrodes": {}}, {"landmarks": {"nasion": (0, 1, 2)}}, {"landmarks": "here"},
                        {"meg": True, "montage": "10-20"}, {"layers": 4}, {"layers": 2},
                        {"electrodes_in": "ras"}, {"aseg": spheres()}, {"lesion": spheres()}, {"pial": []},
                        {"conductivity": (1, 1, 1, 1)}, {"layers": 4, "meg": True}):
            with self.assertRaises(adaptiso.Error, msg=str(options)) as caught:
                adaptiso.bem(**{**common, **options})
            self.assertNotIn("\n", str(caught.exception))
        with self.assertRaisesRegex(adaptiso.Error, "landmarks="):
            adaptiso.bem(**common).save("nowhere", besa=True)


class Failures(unittest.TestCase):
    def test_a_model_that_cannot_be_is_an_error_that_shows_where(self):
        metres = [(mesh.vertices / 1000, mesh.faces) for mesh in three_spheres().surfaces.values()]
        with self.assertRaises(adaptiso.NoModel) as caught:
            adaptiso.bem(surfaces=metres)
        self.assertIn("size", str(caught.exception))
        model = caught.exception.model
        self.assertEqual(len(model.surfaces), 3)
        self.assertFalse(model.check)
        self.assertFalse(model.report["model"])
        self.assertGreater(len(model.report["findings"]), 0)
        self.assertIn("FAILED", model.report_html())
        again = pickle.loads(pickle.dumps(caught.exception))  # as of a pool of processes
        self.assertEqual(str(again), str(caught.exception))
        self.assertEqual(again.model.surfaces, model.surfaces)
        with self.assertRaisesRegex(adaptiso.Error, "no model to save"):
            model.save("nowhere")

    def test_a_head_mask_goes_with_labels_and_on_their_grid(self):
        labels, body = spheres((90, 91, 0)), (spheres() > 0).astype(np.uint8)
        common = {"tissues": "totalsegmentator", "labels": labels, "affine": affine()}
        with self.assertRaisesRegex(adaptiso.Error, "^labels needs tissues brain=..., skull=... and scalp=...$"):
            adaptiso.bem(labels=labels)
        for part, named in (("totalsegmentator has no scalp: give head_mask", {**common}),
                            ("head_mask: the head mask", {**common, "head_mask": body[:-1]}),
                            ("head_mask needs labels", {"t1": labels, "head_mask": body})):
            with self.assertRaisesRegex(adaptiso.Error, part):
                adaptiso.bem(**named)
        self.assertEqual(len(adaptiso.bem(meg=True, **common, **QUICK).surfaces), 1)

    def test_what_cannot_be_used_is_refused_with_one_line(self):
        labels, t1 = spheres(), np.zeros((9, 9, 9))
        for options in (
                {}, {"t1": t1, "ct": t1}, {"t1": t1, "labels": labels}, {"labels": labels},
                {"t1": None}, {"t1": 3}, {"t1": "nowhere.nii"}, {"t1": t1},
                {"t1": np.zeros((0, 3, 3))}, {"t1": t1[0]}, {"t1": t1.astype(complex)},
                {"t1": t1, "brain_mask": t1}, {"t1": t1, "brain_mask": "nowhere.nii"},
                {"ct": t1}, {"ct": t1, "skin_hu": 400}, {"probabilities": t1},
                {"probabilities": [t1]}, {"probabilities": []}, {"labels": labels, "tissues": "spm"},
                {"labels": labels, "tissues": {"brain": [1]}},
                {"labels": labels, "tissues": {"brain": [1], "skull": [1], "scalp": [3]}},
                {"labels": labels, "tissues": {"brain": ["one"], "skull": [1], "scalp": [3]}},
                {"labels": labels, "tissues": {"brain": [9], "skull": [2], "scalp": [3]}},
                {"labels": labels, "tissues": TISSUES, "vertices": 3},
                {"labels": labels, "tissues": TISSUES, "vertices": np.array(0.5)},
                {"labels": labels, "tissues": {"brain": np.array("one"), "skull": [1], "scalp": [3]}},
                {"labels": labels, "tissues": TISSUES, "vertices": [162, 162]},
                {"labels": labels, "tissues": TISSUES, "edge_length": (5, 3)},
                {"labels": labels, "tissues": TISSUES, "edge_length": (0.01, 0.02)},
                {"labels": labels, "tissues": TISSUES, "min_gap": 0.1},
                {"labels": labels, "tissues": TISSUES, "conductivity": (1, 2)},
                {"labels": labels, "tissues": TISSUES, "conductivity": (0.3, -1, 0.3)},
                {"labels": labels, "tissues": TISSUES, "smoothing": np.nan},
                {"t1": t1, "skull": 30}, {"t1": t1, "max_skull": 1}, {"t1": t1, "tissues": TISSUES},
                {"surfaces": [1, 2, 3]}, {"surfaces": []}, {"surfaces": "a.stl"},
                {"surfaces": [(np.eye(3), [[0, 1, 2]])] * 3}, {"t1": t1, "volume": t1},
                {"t1": t1, "meg": "yes"}, {"t1": t1, "threads": -1}):
            with self.assertRaises(adaptiso.Error, msg=str(options)) as caught:
                adaptiso.bem(**{"affine": affine(), **options})
            self.assertNotIn("\n", str(caught.exception))


@needs("mne")
class Mne(InFolder):
    def test_takes_the_surfaces_as_it_would_its_own(self):
        """mne.make_bem_model's dicts of the saved files, but for rounding to float32."""
        import mne
        mne.set_log_level("ERROR")
        model = adaptiso.bem(labels=spheres(), tissues=TISSUES, affine=affine(centre=(9, -4, 30)),
                             conductivity=(0.33, 0.0041, 0.43), **QUICK)
        model.save(self.folder / "bem")
        (self.folder / "anna").mkdir()
        (self.folder / "bem").rename(self.folder / "anna" / "bem")
        theirs = mne.make_bem_model("anna", ico=None, conductivity=(0.33, 0.0041, 0.43),
                                    subjects_dir=self.folder)
        ours = model.to_mne()
        for their, our in zip(theirs, ours):
            for key in ("id", "sigma", "coord_frame", "np", "ntri"):
                self.assertEqual(our[key], their[key], key)
            np.testing.assert_array_equal(our["tris"], their["tris"])
            np.testing.assert_allclose(our["rr"], their["rr"], rtol=0, atol=1e-8)
        solutions = [mne.make_bem_solution(surfaces)["solution"] for surfaces in (theirs, ours)]
        # float32 places differ by 4e-6 of the head; entries are up to 0.02
        np.testing.assert_allclose(*solutions, rtol=1e-4, atol=1e-6)
        bem = mne.make_bem_solution(model.to_mne())
        mne.write_bem_solution(self.folder / "a-bem-sol.fif", bem)
        self.assertEqual(len(mne.read_bem_solution(self.folder / "a-bem-sol.fif")["surfs"]), 3)


if __name__ == "__main__":
    unittest.main(verbosity=2)
