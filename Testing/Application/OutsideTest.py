"""What a dataset, a record or a name that somebody sends can do: nothing outside its folder."""

import hashlib
import json
import os
import re
import shutil
import signal
import stat
import subprocess
import time

from support import (BAD_INPUT, BIN, CHECK_FAILED, OK, SOURCE, ApplicationTest, Image, ball, main,
                     noise, write_nifti)

SURFACES = ("--surfaces", "iso=100,largest")
FAST = ("--surfaces", "iso=100,largest", "--no-pictures")


def program(name):
    return str(BIN / f"adaptiso-{name}")


class OutsideTest(ApplicationTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("ball.nii"), ball())
        self.path("victim").write_text("precious\n")
        self.path("elsewhere").mkdir()

    def run_in(self, code, *command, timeout=60, **options):
        done = subprocess.run(list(map(str, command)), cwd=self.folder, capture_output=True,
                              text=True, timeout=timeout, errors="surrogateescape", **options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def study(self):
        for number in (1, 2):
            folder = self.path(f"study/sub-{number:02}/anat")
            folder.mkdir(parents=True)
            write_nifti(folder / f"sub-{number:02}_T1w.nii", ball())
        self.path("study/dataset_description.json").write_text(
            '{"Name": "x", "BIDSVersion": "1.8.0"}')

    def bids(self, code, *arguments, what=FAST, **options):
        return self.run_in(code, program("bids"), "study", "out", *arguments, *what, **options)

    def link(self, name, target="victim"):
        path = self.path(name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.symlink_to(self.path(target))

    def assert_untouched(self):
        self.assertEqual(self.path("victim").read_text(), "precious\n")
        self.assertEqual(list(self.path("elsewhere").rglob("*")), [])


class Links(OutsideTest):
    def test_in_the_place_of_the_groups_files_are_refused(self):
        self.study()
        self.bids(OK, "participant")
        for name in ("summary.html", "quality.tsv", "quality.json", "README", ".bidsignore",
                     "dataset_description.json"):
            self.link(f"out/{name}")
            done = self.bids(BAD_INPUT, "group")
            self.assertRegex(done.stderr, f"{re.escape(name)}: is(.*link| not of adaptiso-bids)")
            self.assert_untouched()
            self.path(f"out/{name}").unlink()
        self.bids(OK, "group")

    def test_in_the_place_of_participants_files_cost_that_scan(self):
        self.study()
        stem = "out/sub-01/anat/sub-01_desc-iso100_mesh"
        for name in (f"{stem}.vtp", f"{stem}.json", f"{stem}.vtp.adaptiso-mesh.json",
                     "out/sub-01/anat/sub-01_desc-iso_figures"):
            self.link(name)
            done = self.bids(CHECK_FAILED, "participant", what=SURFACES)
            self.assertRegex(done.stdout, r"(?m)^FAILED  .*sub-01_T1w.nii: .*is a link")
            self.assertRegex(done.stdout, r"(?m)^(done  |before)  .*sub-02_T1w.nii: ")
            self.assert_untouched()
            shutil.rmtree(self.path("out/sub-01"))

    def test_in_the_place_of_folders_cost_that_scan(self):
        self.study()
        for name in ("out/sub-01", "out/sub-01/anat"):
            self.link(name, "elsewhere")
            done = self.bids(CHECK_FAILED, "participant")
            self.assertRegex(done.stdout, r"(?m)^FAILED  .*sub-01_T1w.nii: .*link")
            self.assert_untouched()
            self.path(name).unlink()

    def test_in_the_place_of_pictures_are_refused(self):
        self.link("pictures/surface-1.png")
        done = self.run_mesh("ball.nii", "--iso", 100, "-o", "a.vtp", "--pictures", "pictures")
        self.assertNotEqual(done.returncode, OK)
        self.assertIn("surface-1.png: is a link", done.stderr)
        self.assert_untouched()

    def test_in_a_batchs_folder_are_refused(self):
        shutil.copy(self.path("ball.nii"), self.path("other.nii"))
        both = ("ball.nii", "other.nii", "--iso", 100, "--output-dir", "out")
        self.link("out/summary.html")
        self.assert_fails(BAD_INPUT, "summary.html: is a link", *both)
        self.path("out/summary.html").unlink()
        for name in ("ball-iso100.vtp", "ball-iso100.vtp.adaptiso-mesh.json", "ball.html"):
            self.link(f"out/{name}")
            done = self.run_mesh(*both, "--report", "{name}.html")
            self.assertEqual(done.returncode, CHECK_FAILED, done.stdout)
            self.assertRegex(done.stdout, "(?m)^FAILED  ball.nii: .*is a link")
            self.assertRegex(done.stdout, "(?m)^done    other.nii: ")
            self.assert_untouched()
            shutil.rmtree(self.path("out"))

    def test_are_followed_only_under_names_that_the_user_gave(self):
        self.link("mine.vtp", "target.vtp")
        self.mesh("ball.nii", "--iso", 100, "-o", "mine.vtp")
        self.assertTrue(self.path("mine.vtp").is_symlink())
        self.assertTrue(self.path("target.vtp").is_file())
        for name, arguments in (("ball-iso100.vtp", ()), ("x-iso100.vtp", ("-o", "x-iso{iso}.vtp")),
                                ("y-iso90.vtp", ("-o", "y.vtp", "--iso", 90))):
            self.link(name)
            self.assert_fails(BAD_INPUT, f"{name}: is a link", "ball.nii", "--iso", 100, *arguments)
            self.assert_untouched()
        self.link("out/ball-iso100.vtp")
        self.mesh("ball.nii", "--iso", 100, "-o", "ball2.vtp")
        shutil.copy(self.path("ball2.vtp"), self.path("ball-in.vtp"))
        self.link("out/ball-in.vtp")
        done = self.run_in(BAD_INPUT, program("simplify"), "ball-in.vtp", "--max-error", 1,
                           "-o", "out")
        self.assertIn("is a link", done.stderr)
        self.assert_untouched()

    def test_of_a_giants_folder_are_refused(self):
        self.run_in(OK, program("giant"), "plan", "work", "--input", "ball.nii", "--iso", 100,
                    "--tile", 32)
        plan = self.path("work/plan.json").read_bytes()
        for name in ("plan.json", "tiles"):
            where = self.path(f"work/{name}")
            shutil.rmtree(where) if where.is_dir() else where.unlink()
            self.link(f"work/{name}", "elsewhere" if name == "tiles" else "victim")
            done = self.run_in(BAD_INPUT, program("giant"), "plan", "work", "--input", "ball.nii",
                               "--iso", 100, "--tile", 32)
            self.assertIn("link", done.stderr)
            self.assert_untouched()
            where.unlink()
            self.path("work/plan.json").write_bytes(plan)

    def test_in_the_place_of_a_giants_tiles_are_refused_by_every_step(self):
        self.run_in(OK, program("giant"), "plan", "work", "--input", "ball.nii", "--iso", 100,
                    "--tile", 32)
        for name in ("tiles", "seams"):
            self.path(f"work/{name}").rmdir()
            self.link(f"work/{name}", "elsewhere")
            for step in ("tile", "seam", "join"):
                self.run_in(BAD_INPUT, program("giant"), step, "work")
            self.assert_untouched()
            self.path(f"work/{name}").unlink()
            self.path(f"work/{name}").mkdir()

    def test_of_a_subjects_folder_are_refused(self):
        self.path("subjects/bert").mkdir(parents=True)
        self.link("subjects/bert/bem", "elsewhere")
        ply = ("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
               "property float z\nelement face 4\nproperty list uchar int vertex_indices\n"
               "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
        for name in "abc":
            self.path(f"{name}.ply").write_text(ply)
        done = self.run_in(BAD_INPUT, program("bem"), "--surfaces", "a.ply", "b.ply", "c.ply",
                           "--input-coordinates", "ras", "-o", "model", "--subjects-dir",
                           "subjects", "--subject", "bert")
        self.assertIn("subjects/bert/bem: is a link", done.stderr)
        self.assert_untouched()

    def test_to_scans_and_participants_elsewhere_are_refused(self):
        self.study()
        write_nifti(self.path("elsewhere/patient.nii"), ball())
        self.path("elsewhere/anat").mkdir()
        shutil.copy(self.path("elsewhere/patient.nii"),
                    self.path("elsewhere/anat/sub-05_T1w.nii"))
        self.link("study/sub-03/anat/sub-03_T1w.nii", "elsewhere/patient.nii")
        self.link("study/sub-04/anat", "elsewhere/anat")
        self.link("study/sub-05", "elsewhere")
        self.path("study/sub-06/anat").mkdir(parents=True)
        self.path("study/sub-06/anat/sub-06_T1w.nii").symlink_to(
            "../../sub-01/anat/sub-01_T1w.nii")
        done = self.bids(CHECK_FAILED, "participant", "--skip-bids-validation")
        self.assertRegex(done.stdout, "(?m)^FAILED  .*sub-03_T1w.nii: .*link to outside")
        self.assertRegex(done.stdout, "(?m)^FAILED  sub-05: .*link to outside")
        self.assertRegex(done.stdout, "(?m)^FAILED  .*sub-04/anat: .*link to outside")
        self.assertRegex(done.stdout, "(?m)^done    .*sub-06_T1w.nii: ")
        self.assertEqual(list(self.path("out").rglob("sub-0[345]*.vtp")), [])
        self.assertFalse(self.path("elsewhere/anat/sub-05_desc-iso100_mesh.vtp").exists())

    def test_to_sessions_elsewhere_print_no_name_of_what_lies_there(self):
        self.study()
        secret = "sub-01_ses-2_acq-JaneDoe1970_T1w.nii"
        self.path("elsewhere/anat").mkdir(parents=True)
        shutil.copy(self.path("ball.nii"), self.path("elsewhere/anat") / secret)
        shutil.copy(self.path("ball.nii"), self.path("elsewhere/anat/Jane Doe_T1w.nii"))
        self.path("study/sub-03").mkdir()
        self.link("study/sub-01/ses-2", "elsewhere")
        self.link("study/sub-03/ses-1/anat", "elsewhere/anat")
        for more in ((), ("--skip-bids-validation",)):
            done = self.bids(CHECK_FAILED, "participant", *more)
            self.assertRegex(done.stdout, "(?m)^FAILED  .*sub-01/ses-2/anat: .*link to outside")
            self.assertRegex(done.stdout, "(?m)^FAILED  .*sub-03/ses-1/anat: .*link to outside")
            self.assertRegex(done.stdout, r"(?m)^(done  |before)  .*sub-02_T1w.nii: ")
            group = subprocess.run([program("bids"), "study", "out", "group", *more], text=True,
                                   cwd=self.folder, capture_output=True)
            for text in (done.stdout, done.stderr, group.stdout, group.stderr):
                self.assertNotIn("Doe", text)
            for file in self.path("out").rglob("*"):
                self.assertNotIn("Doe", file.name)
                if file.is_file():
                    self.assertNotIn(b"Doe", file.read_bytes())

    def test_to_tables_and_slices_elsewhere_are_not_read(self):
        samples = bytes(3 if 4 < i % 12 < 9 and 4 < i // 12 % 12 < 9 and 4 < i // 144 < 9 else 0
                        for i in range(12 ** 3))
        self.path("data").mkdir()
        write_nifti(self.path("data/map.nii"), Image((12, 12, 12), "B", samples))
        self.path("elsewhere/names.tsv").write_text("index\tname\n3\tsecret\n")
        self.link("data/map.tsv", "elsewhere/names.tsv")
        done = self.run_in(OK, program("labels"), "data/map.nii", "-o", "regions", "--json", "-")
        report = json.loads(done.stdout)
        self.assertIn("names-not-used", [w["code"] for w in report["warnings"]])
        self.assertNotIn("secret", done.stdout)
        self.run_in(OK, program("labels"), "data/map.nii", "-o", "named", "--names",
                    "data/map.tsv")
        self.assertIn("secret", self.path("named/regions.tsv").read_text())


class Records(OutsideTest):
    def planted(self, **change):
        """A record of a finished run whose output is the victim."""
        data = b"precious\n"
        name = {"file": "../../../victim", "bytes": len(data), "modifiedNs": 1, "changedNs": 1,
                "sha256": hashlib.sha256(data).hexdigest(), "option": "--output"}
        record = {"schema": "adaptiso-record/1", "program": {"name": "adaptiso-mesh"},
                  "build": "x", "ended": True, "date": "2030", "says": "x", "name": "sub-01",
                  "files": ["a"], "exitCode": 0, "signal": None, "error": None, "warnings": [],
                  "outputs": [], "seconds": 1.0, "report": {}, "options": [], "inputs": [],
                  "keptOutputs": [name]}
        return {**record, **change}

    def test_remove_and_link_nothing_outside(self):
        self.study()
        place = "out/sub-01/anat/sub-01_desc-iso100_mesh.vtp.adaptiso-mesh.json"
        kept = self.planted()["keptOutputs"][0]
        self.link("out/sub-01/anat/inner", "victim")
        for file in ("../../../victim", str(self.path("victim")), "x/../../../../victim", "inner"):
            self.path(place).write_text(json.dumps(self.planted(
                keptOutputs=[{**kept, "file": file}])))
            self.bids(OK, "participant", "--participant-label", "01")
            self.assert_untouched()
        for key, value in (("outputs", ["../../../victim"]), ("outputs", [str(self.path("victim"))]),
                           ("inputs", [{**kept, "place": "../../../victim"}])):
            self.path(place).write_text(json.dumps(self.planted(**{key: value})))
            done = self.bids(CHECK_FAILED, "group", "--participant-label", "01")
            self.assertIn("its record is damaged", done.stderr)
            self.assertNotIn("victim", self.path("out/summary.html").read_text())

    def test_in_a_batchs_folder_are_damaged_where_they_name_files_elsewhere(self):
        self.path("out").mkdir()
        kept = {**self.planted()["keptOutputs"][0], "file": str(self.path("victim"))}
        self.path("out/other.vtp.adaptiso-mesh.json").write_text(
            json.dumps(self.planted(keptOutputs=[kept])))
        write_nifti(self.path("two.nii"), ball())
        self.mesh("ball.nii", "two.nii", "--iso", 100, "--output-dir", "out")
        page = self.path("out/summary.html").read_text()
        self.assertIn("a damaged record", page)
        self.assertNotIn("victim", page)

    def test_remove_nothing_of_an_annex(self):
        self.study()
        objects = self.path(".git/annex/objects/aa")
        objects.mkdir(parents=True)
        shutil.copy(self.path("victim"), objects / "key")
        self.path("out/sub-01/anat").mkdir(parents=True)
        self.path("out/sub-01/anat/d").symlink_to("../../../.git/annex/objects/aa")
        kept = {**self.planted()["keptOutputs"][0], "file": "d/key"}
        self.path("out/sub-01/anat/sub-01_desc-iso100_mesh.vtp.adaptiso-mesh.json").write_text(
            json.dumps(self.planted(keptOutputs=[kept])))
        self.bids(OK, "participant", "--participant-label", "01")
        self.assertTrue((objects / "key").exists())

    def test_that_name_surfaces_which_are_not_there_count_for_nothing(self):
        self.study()
        self.bids(OK, "participant")
        for path in list(self.path("out").rglob("*.vtp")):
            record = path.with_name(path.name + ".adaptiso-mesh.json")
            said = json.loads(record.read_text())
            record.write_text(json.dumps({**said, "keptOutputs": [], "outputs": ["any.vtp"]}))
            path.unlink()
        self.assertIn("0 whole", self.bids(CHECK_FAILED, "group").stdout)
        self.assertNotIn("before", self.bids(OK, "participant").stdout)

    def test_with_values_of_other_types_are_damaged(self):
        self.study()
        self.bids(OK, "participant")
        record = next(self.path("out/sub-01").rglob("*.adaptiso-mesh.json"))
        said = json.loads(record.read_text())
        for asked in ({"product": 7}, {"options": ["x"]}, {"pictures": "x"}, {"allow": ["x; y"]}):
            record.write_text(json.dumps({**said, "asked": {**said["asked"], **asked}}))
            done = self.run_in(CHECK_FAILED, program("bids"), "study", "out", "group")
            self.assertIn("its record is damaged", done.stderr)
        for outputs in (["{name}.vtp"], said["outputs"] * 2, ["a\nb.vtp"]):
            record.write_text(json.dumps({**said, "outputs": outputs}))
            self.bids(CHECK_FAILED, "group", what=("--check", *FAST))

    def test_lead_to_no_file_elsewhere_by_their_options(self):
        self.study()
        self.path("out/sub-01/anat").mkdir(parents=True)
        shutil.copy(self.path("ball.nii"), self.path("study/sub-01/anat/sub-01_dseg.nii"))
        asked = {"product": "labels", "pictures": False, "strict": False, "allow": [],
                 "options": f"names={self.path('victim')}"}
        self.path("out/sub-01/anat/sub-01_mesh.adaptiso-labels.json").write_text(json.dumps(
            self.planted(program={"name": "adaptiso-labels"}, keptOutputs=[], asked=asked)))
        done = self.run_in(BAD_INPUT, program("bids"), "study", "out", "group")
        self.assertIn("not in BIDS_DIR or OUT_DIR", done.stderr)

    def test_take_label_maps_from_the_dataset_alone(self):
        self.study()
        self.path("out/sub-01/anat").mkdir(parents=True)
        asked = {"product": "labels", "pictures": False, "strict": False, "allow": [],
                 "options": "", "segmentations": "../elsewhere"}
        self.path("out/sub-01/anat/sub-01_mesh.adaptiso-labels.json").write_text(json.dumps(
            self.planted(program={"name": "adaptiso-labels"}, keptOutputs=[], asked=asked)))
        done = self.run_in(BAD_INPUT, program("bids"), "study", "out", "group")
        self.assertIn("outside of BIDS_DIR", done.stderr)

    def test_of_runs_with_pages_elsewhere_are_taken_again(self):
        write_nifti(self.path("two.nii"), ball())
        command = ("ball.nii", "two.nii", "--iso", 100, "--output-dir", "out", "--skip-existing",
                   "--report", f"{self.folder}/elsewhere/{{name}}.html")
        self.mesh(*command)
        done = self.mesh(*command)
        self.assertIn("2 of an earlier run", done.stdout)
        self.path("elsewhere/two.html").unlink()
        self.assertIn("1 of an earlier run", self.mesh(*command).stdout)


class Pipes(OutsideTest):
    def test_in_the_place_of_files_are_not_waited_for(self):
        self.study()
        for name in (".bidsignore", "participants.tsv", "dataset_description.json"):
            path = self.path(f"study/{name}")
            before = path.read_bytes() if path.exists() else None
            path.unlink(missing_ok=True)
            os.mkfifo(path)
            done = self.bids(BAD_INPUT, "participant", timeout=20)
            self.assertRegex(done.stderr, f"{re.escape(name)}: is no regular file")
            path.unlink()
            if before is not None:
                path.write_bytes(before)
        self.bids(OK, "participant")
        for name in ("dataset_description.json", "sub-01/anat/x.adaptiso-mesh.json"):
            os.mkfifo(self.path(f"out/{name}"))
            done = self.run_in(OK if "x." in name else BAD_INPUT, program("bids"), "study", "out",
                               "group", timeout=20)
            self.path(f"out/{name}").unlink()

    def test_in_a_batchs_folder_are_not_waited_for(self):
        self.path("out").mkdir()
        os.mkfifo(self.path("out/x.adaptiso-mesh.json"))
        write_nifti(self.path("two.nii"), ball())
        self.mesh("ball.nii", "two.nii", "--iso", 100, "--output-dir", "out")
        self.assertIn("a damaged record", self.path("out/summary.html").read_text())

    def test_in_folders_of_labels_and_giants_are_not_waited_for(self):
        write_nifti(self.path("map.nii"), Image((8, 8, 8), "B", bytes(
            1 if 2 < i % 8 < 6 and 2 < i // 8 % 8 < 6 and 2 < i // 64 < 6 else 0
            for i in range(512))))
        self.path("regions").mkdir()
        os.mkfifo(self.path("regions/report.json"))
        self.run_in(BAD_INPUT, program("labels"), "map.nii", "-o", "regions", "--force", timeout=20)
        self.path("work").mkdir()
        os.mkfifo(self.path("work/plan.json"))
        for step in (("plan", "work", "--input", "ball.nii", "--iso", 100), ("tile", "work")):
            self.run_in(BAD_INPUT, program("giant"), *step, timeout=20)


class DeepJson(OutsideTest):
    DEEP = "[" * 400_000

    def test_ends_nothing(self):
        deep = self.DEEP + "1" + "]" * 400_000
        write_nifti(self.path("map.nii"), Image((8, 8, 8), "B", bytes(
            1 if 2 < i % 8 < 6 and 2 < i // 8 % 8 < 6 and 2 < i // 64 < 6 else 0
            for i in range(512))))
        for text in (deep, '{"1": %s}' % deep, '[{"index": %s}]' % deep,
                     '[{"index": 1, "name": "x", "r": %s, "g": 1, "b": 1}]' % deep, self.DEEP):
            self.path("map.json").write_text(text)
            done = self.run_in(OK, program("labels"), "map.nii", "-o", "out", "--force")
            self.run_in(BAD_INPUT, program("labels"), "map.nii", "-o", "o", "--names", "map.json")
        for name in (".zarray", ".zgroup", ".zattrs", "attributes.json", "zarr.json"):
            folder = self.path(f"{name}.zarr")
            folder.mkdir()
            folder.joinpath(name).write_text('{"x": %s}' % deep)
            self.assert_fails(BAD_INPUT, ".", folder.name, "--iso", 1)
        self.path("out2").mkdir()
        self.path("out2/x.adaptiso-mesh.json").write_text(deep)
        write_nifti(self.path("two.nii"), ball())
        self.mesh("ball.nii", "two.nii", "--iso", 100, "--output-dir", "out2")
        self.study()
        self.path("study/dataset_description.json").write_text(deep)
        self.bids(BAD_INPUT, "participant")


class Terminals(OutsideTest):
    NAMES = ["a\033]0;evil\007.nii", "b\u009b2J.nii", "c\u202eiin.nii", "d\u2066.nii",
             os.fsdecode(b"e\x9b2J.nii")]
    STEERING = re.compile("[\0-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")

    def assert_plain(self, done):
        for text in (done.stdout, done.stderr):
            self.assertIsNone(self.STEERING.search(text), ascii(text))
            self.assertNotIn("\udc9b", text)

    def test_get_no_sequences_from_names(self):
        for name in self.NAMES:
            shutil.copy(self.path("ball.nii"), self.path(name))
        self.path("bad\033[2J.nii").write_text("no image")
        names = [*self.NAMES, "bad\033[2J.nii"]
        self.assert_plain(self.run_in(CHECK_FAILED, program("mesh"), *names, "--iso", 100,
                                      "--output-dir", "out"))
        for name in names:
            code = BAD_INPUT if name.startswith("bad") else OK
            for arguments in (("--iso", 100, "-o", "x.vtp"), ("--info",), ("--iso", 100, "--json", "-")):
                self.assert_plain(self.run_in(code, program("mesh"), name, *arguments))
            self.assert_plain(self.run_in(BAD_INPUT, program("check"), name))
            self.assert_plain(self.run_in(2, program("mesh"), "--no-such", name))

    def test_lines_are_not_forged_by_names(self):
        name = "n\ndone    good.nii: fine.nii"
        shutil.copy(self.path("ball.nii"), self.path(name))
        done = self.run_in(OK, program("mesh"), name, "ball.nii", "--iso", 100, "--output-dir", "out")
        self.assertEqual(len([line for line in done.stdout.splitlines() if line.startswith("done")]), 2)
        self.mesh("ball.nii", "--iso", 100, "-o", "x.vtp")
        forged = "n\nFAILED  good.vtp"
        shutil.copy(self.path("x.vtp"), self.path(forged))
        for command in (("check", forged), ("compare", forged, "x.vtp")):
            self.assertNotIn("\nFAILED", self.run_in(OK, program(command[0]), *command[1:]).stdout)

    def test_pages_have_none_of_them(self):
        for name in self.NAMES[:4]:
            shutil.copy(self.path("ball.nii"), self.path(name))
            self.mesh(name, "--iso", 100, "-o", "x.vtp", "--report", "page.html")
            self.assertIsNone(self.STEERING.search(self.path("page.html").read_text()))

    def test_names_that_are_folders_are_refused(self):
        shutil.copy(self.path("ball.nii"), self.path("...nii"))
        self.path("s.vtp").write_text("precious")
        self.assert_fails(BAD_INPUT, r": \.\. is no name for files", "...nii", "ball.nii", "--iso", 100,
                          "--output-dir", "out", "-o", "{name}/s.vtp")

    def test_names_with_a_dot_ahead_are_in_the_summary(self):
        self.path(".bad.nii").write_text("no image")
        self.run_in(CHECK_FAILED, program("mesh"), "ball.nii", ".bad.nii", "--iso", 100,
                    "--output-dir", "out")
        self.assertIn("1 of 2 failed", self.path("out/summary.html").read_text())

    def test_json_keeps_the_names(self):
        for name in self.NAMES[:4]:
            shutil.copy(self.path("ball.nii"), self.path(name))
            done = self.run_in(OK, program("mesh"), name, "--iso", 100, "-o", "x.vtp",
                               "--json", "-")
            self.assertEqual(json.loads(done.stdout)["input"]["file"], name)


    def test_a_giant_refuses_a_path_that_its_plan_cannot_hold(self):
        name = os.fsdecode(b"g\xfc.nii")
        shutil.copy(self.path("ball.nii"), self.path(name))
        done = self.run_in(BAD_INPUT, program("giant"), "plan", "work", "--input", name, "--iso", 1)
        self.assertIn("not UTF-8", done.stderr)


class Leftovers(OutsideTest):
    def test_of_others_stay(self):
        kept = [".adaptiso-notes.part2.txt", ".adaptiso-1-0.party", ".adaptiso-1-.part",
                ".adaptiso-.part", ".adaptiso-1-2-3.part", "adaptiso-1-0.part"]
        for name in (*kept, ".adaptiso-99-0.part.vtp", ".adaptiso-99-1.part"):
            self.path(f"out/{name}").parent.mkdir(exist_ok=True)
            self.path(f"out/{name}").write_text("x")
        self.mesh("ball.nii", "--iso", 100, "-o", "out/a.vtp")
        self.assertEqual(sorted(path.name for path in self.path("out").iterdir()),
                         sorted([*kept, "a.vtp"]))

    def test_a_replaced_file_keeps_no_setgid(self):
        self.mesh("ball.nii", "--iso", 100, "-o", "a.vtp")
        self.path("a.vtp").chmod(0o6755)
        self.mesh("ball.nii", "--iso", 100, "-o", "a.vtp")
        self.assertEqual(stat.S_IMODE(self.path("a.vtp").stat().st_mode), 0o755)

    def test_no_core_is_left(self):
        write_nifti(self.path("noise.nii"), noise())
        process = subprocess.Popen([program("mesh"), "noise.nii", "--iso", "100", "-o", "x.vtp"],
                                   cwd=self.folder, stderr=subprocess.DEVNULL)
        time.sleep(0.3)
        with open(f"/proc/{process.pid}/limits") as file:
            limits = file.read()
        process.send_signal(signal.SIGSEGV)
        self.assertLess(process.wait(timeout=60), 0)
        self.assertRegex(limits, r"Max core file size +0 +0 ")
        self.assertEqual(list(self.folder.glob("core*")), [])


class Libraries(OutsideTest):
    def test_above_the_program_are_not_loaded(self):
        if shutil.which("cc") is None:
            self.skipTest("needs a C compiler")
        self.path("x.c").write_text(
            '#include <stdio.h>\n__attribute__((constructor)) static void f(void)'
            '{ fclose(fopen("%s/loaded", "w")); }\n' % self.folder)
        copy = self.path("x/a/b/c/bin/adaptiso-mesh")
        copy.parent.mkdir(parents=True)
        shutil.copy(program("mesh"), copy)
        for folder in ("x/lib", "x/a/lib", "x/a/b/lib", "x/a/b/c/bin/lib",
                       "x/lib/x86_64-linux-gnu"):
            library = self.path(folder) / "adaptiso/itk/libadaptisoItkIO.so"
            library.parent.mkdir(parents=True)
            subprocess.run(["cc", "-shared", "-fPIC", "-o", library, self.path("x.c")], check=True)
        self.path("junk.bin").write_bytes(b"junk" * 300)
        self.run_in(BAD_INPUT, copy, "junk.bin", "--iso", 1)
        self.assertFalse(self.path("loaded").exists())


class Submitting(OutsideTest):
    def setUp(self):
        super().setUp()
        self.path("bin").mkdir()
        stub = self.path("bin/sbatch")
        stub.write_text('#!/bin/sh\nfor a; do case "$previous" in --wrap) sh -c "$a";; esac; '
                        'previous=$a; done\nprintf "%s\\n" "$@" >>"$LOG"\necho 1\n')
        stub.chmod(0o755)
        self.environment = {**os.environ, "LOG": str(self.path("log")),
                            "PATH": f"{self.path('bin')}:{BIN}:{os.environ['PATH']}"}

    def test_a_giant_runs_no_name_as_shell(self):
        work = f"work'; touch {self.folder}/injected; '"
        self.run_in(OK, "bash", SOURCE / "Examples/giant/submit.sh", work, "o'ut.ply", "--input",
                    "ball.nii", "--iso", "100", env=self.environment)
        self.assertFalse(self.path("injected").exists())
        self.assertIn(str(self.path("o'ut.ply")), self.path("log").read_text().splitlines())

    def test_a_cohort_takes_no_name_for_an_option(self):
        self.study()
        self.path("study/sub-03\n--json=victim").mkdir()
        done = self.run_in(BAD_INPUT, "bash", SOURCE / "Examples/cohort/submit.sh", "jobs",
                           "study", "out", env=self.environment)
        self.assertIn("is no name of a participant", done.stderr)
        self.assertFalse(self.path("jobs").exists())
        self.assert_untouched()


class FoundFiles(OutsideTest):
    def test_lead_field_runs_no_python_of_the_current_folder(self):
        self.path("contextlib.py").write_text("open('ran', 'w')\n")
        self.path("mne").mkdir()
        self.path("cap.tsv").write_text("name\tx\ty\tz\nNAS\t0\t1\t2\n")
        done = subprocess.run([program("bem"), "--t1", "ball.nii", "--electrodes", "cap.tsv", "--source-grid", "20",
                               "--lead-field", "mne", "-o", "m"], cwd=self.folder, capture_output=True, text=True)
        self.assertNotEqual(done.returncode, OK)
        self.assertFalse(self.path("ran").exists())
        self.assertFalse(self.path("m").exists())

    def test_files_found_in_a_subjects_folder_are_no_links_out_of_it(self):
        mri = self.path("subjects/bert/mri")
        mri.mkdir(parents=True)
        shutil.copy(self.path("ball.nii"), self.path("elsewhere/other.nii"))
        for name in ("aseg.mgz", "T1.mgz"):
            shutil.copy(self.path("ball.nii"), mri / "T1.mgz")
            (mri / name).unlink(missing_ok=True)
            (mri / name).symlink_to(self.path("elsewhere/other.nii"))
            done = self.run_in(BAD_INPUT, program("bem"), "-s", "bert", "-d", "subjects")
            self.assertIn(name, done.stderr)
            (mri / name).unlink()

    def test_a_log_names_no_folders_and_is_no_other_output(self):
        shutil.copy(self.path("ball.nii"), self.path("elsewhere/x.nii"))
        self.run_in(BAD_INPUT, program("mesh"), "elsewhere/x.nii", "--iso", "1e9", "-o", "x.stl", "--log", "log")
        self.assertIn("x.nii", self.path("log").read_text())
        self.assertNotIn("elsewhere", self.path("log").read_text())
        done = self.run_in(2, program("mesh"), "ball.nii", "--iso", "100", "-o", "s.stl", "--log", "s.stl")
        self.assertIn("is the name of another output too", done.stderr)
        self.path("list").write_text("ball.nii\n")
        self.run_in(BAD_INPUT, program("mesh"), "--list", "list", "--iso", "100", "-o", "{name}.stl", "--csv", "list")
        self.assertEqual(self.path("list").read_text(), "ball.nii\n")


class Hardening(OutsideTest):
    def test_of_all_programs(self):
        if os.environ.get("ADAPTISO_SANITIZE"):
            self.skipTest("built with sanitizers")
        if shutil.which("readelf") is None:
            self.skipTest("needs readelf")
        programs = [path for path in BIN.iterdir() if path.name.startswith("adaptiso-")]
        self.assertGreaterEqual(len(programs), 8)
        for path in programs:
            text = self.run_in(OK, "readelf", "-hldW", "--dyn-syms", path).stdout
            self.assertRegex(text, r"Type: +DYN", path.name)  # placed at random
            self.assertRegex(text, r"GNU_STACK .* RW ", path.name)
            self.assertIn("GNU_RELRO", text, path.name)
            self.assertRegex(text, r"BIND_NOW|FLAGS_1.*NOW", path.name)
            self.assertIn("__stack_chk_fail", text, path.name)
            self.assertRegex(text, r"__mem\w+_chk|__str\w+_chk|__snprintf_chk|__read_chk", path.name)


main()
