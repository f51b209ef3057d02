"""adaptiso-bids: participants side by side, what is made again and what is not, and the group."""

import csv
import gzip
import hashlib
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import time

from support import (BAD_INPUT, BIN, CHECK_FAILED, OK, USAGE, ApplicationTest, Image, ball,
                     from_function, main, noise, write_nifti)

BIDS = str(BIN / "adaptiso-bids")
SURFACES = ("--surfaces", "iso=100.5,largest", "--no-pictures")


class BidsTest(ApplicationTest):
    def setUp(self):
        super().setUp()
        self.study = self.path("study")
        for number in range(1, 8):
            self.scan(f"sub-{number:02}/anat/sub-{number:02}", ball(24, 8 + 0.1 * number))
        self.study.joinpath("dataset_description.json").write_text(
            '{"Name": "x", "BIDSVersion": "1.8.0"}')

    def scan(self, name, image, suffix="T1w"):
        path = self.study / f"{name}_{suffix}.nii"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_nifti(path, image)
        return path

    def bids(self, code, *arguments, what=SURFACES, **options):
        done = subprocess.run([BIDS, "study", "out", *map(str, arguments), *what], cwd=self.folder,
                              text=True, capture_output=True, timeout=300, **options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def told(self, *arguments, code=OK, what=SURFACES):
        """By the name of each scan: made again and why (None: first time), or False: not again."""
        done = self.bids(code, "participant", *arguments, "--json", "-", what=what)
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        return {line["name"]: not line["earlierRun"] and line["madeAgain"] for line in lines}

    def table(self):
        with open(self.path("out/quality.tsv"), newline="") as table:
            return list(csv.DictReader(table, delimiter="\t"))

    def tree(self, under="out"):
        """Names and bytes of what is made, without records, which hold times, and the page."""
        root = self.path(under)
        return {str(path.relative_to(root)): path.read_bytes() for path in root.rglob("*")
                if path.is_file() and ".adaptiso-" not in path.name and path.name != "summary.html"}


class Participants(BidsTest):
    def test_write_below_their_own_folders_only(self):
        processes = [subprocess.Popen([BIDS, "study", "out", "participant", "--participant-label",
                                       f"{number:02}", *SURFACES], cwd=self.folder,
                                      stdout=subprocess.DEVNULL) for number in range(1, 8)]
        self.assertEqual([process.wait(timeout=300) for process in processes], [OK] * 7)
        self.assertEqual(sorted(path.name for path in self.path("out").iterdir()),
                         [f"sub-{number:02}" for number in range(1, 8)])
        self.assertEqual(sorted(path.name for path in self.path("out/sub-03/anat").iterdir()),
                         ["sub-03_desc-iso100p5_mesh.json", "sub-03_desc-iso100p5_mesh.vtp",
                          "sub-03_desc-iso100p5_mesh.vtp.adaptiso-mesh.json"])

    def test_surfaces_are_those_of_adaptiso_mesh(self):
        self.bids(OK, "participant", "--participant-label", "sub-01")
        self.mesh("study/sub-01/anat/sub-01_T1w.nii", "--iso", 100.5, "--largest", "-o", "one.vtp")
        self.assertEqual(self.path("out/sub-01/anat/sub-01_desc-iso100p5_mesh.vtp").read_bytes(),
                         self.path("one.vtp").read_bytes())

    def test_names_are_alphanumeric_and_sidecars_say_the_source(self):
        self.scan("sub-08/ses-1/anat/sub-08_ses-1_acq-hi", ball(24, 8))
        self.bids(OK, "participant", "--participant_label", "01", "08",
                  what=("--surfaces", "iso=100.0,iso=-2.5,format=surf.gii", "--no-pictures"))
        made = self.tree()
        for name in made:
            self.assertRegex(name.split("/")[-1], r"^(\w+-[a-zA-Z0-9]+_)+mesh\.(surf\.gii|json)$")
        said = json.loads(made["sub-08/ses-1/anat/sub-08_ses-1_acq-hi_desc-isom2p5_mesh.json"])
        source = "bids:raw:sub-08/ses-1/anat/sub-08_ses-1_acq-hi_T1w.nii"
        self.assertEqual((said["Sources"], said["SpatialReference"]), ([source], source))
        self.assertEqual(said["Isovalue"], -2.5)
        self.assertIn("sub-01/anat/sub-01_desc-iso100_mesh.surf.gii", made)

    def test_sessions(self):
        for session in "12":
            self.scan(f"sub-08/ses-{session}/anat/sub-08_ses-{session}", ball(24, 8))
        told = self.told("--participant-label", "08", "--session-label", "ses-2")
        self.assertEqual(list(told), ["sub-08_ses-2"])

    def test_a_bad_scan_and_none_cost_their_own_lines(self):
        self.scan("sub-02/anat/sub-02", ball(24, 8)).write_text("no image")
        shutil.rmtree(self.study / "sub-03/anat")
        done = self.bids(CHECK_FAILED, "participant", "--participant-label", "01", "02", "03")
        self.assertRegex(done.stdout, r"(?m)^FAILED  sub-03: surfaces: no T1w image$")
        self.assertRegex(done.stdout, r"(?m)^FAILED  .*sub-02_T1w.nii: truncated")
        self.assertRegex(done.stdout, r"(?m)^done    .*sub-01_T1w.nii: ")
        self.assertRegex(done.stdout, r"(?m)^3 runs, 2 failed$")
        self.assertIn("  1 failed: surfaces: no T1w image: sub-03\n", done.stdout)

    def test_head_models_labels_and_checks(self):
        def head(x, y, z):
            r = (x * x + y * y + z * z) ** 0.5  # 4 mm voxels
            return 0 if r > 22 else 3 if r > 20 else 2 if r > 17 else 1
        image = from_function(56, "B", head, spacing=(4, 4, 4), origin=(0, 0, 0))
        self.scan("sub-01/anat/sub-01", Image(image.size, "B", bytes(image.samples), image.spacing),
                  "dseg")
        what = ("--surfaces", "iso=100", "--check", "--labels", "--labels-options", "max-error=0",
                "--no-pictures")
        self.bids(OK, "participant", "--participant-label", "01", what=what)
        self.bids(OK, "group", "--participant-label", "01", what=what)
        rows = self.table()
        self.assertEqual([(row["product"], row["part"], row["check"]) for row in rows],
                         [("surfaces", "iso100", "passed"), ("labels", "1", "n/a"),
                          ("labels", "2", "n/a"), ("labels", "3", "n/a")])
        self.assertTrue(self.path("out/sub-01/anat/sub-01_mesh/regions/3.vtp").exists())
        said = json.loads(self.path("out/sub-01/anat/sub-01_mesh.json").read_text())
        self.assertEqual(said["Sources"], ["bids:raw:sub-01/anat/sub-01_dseg.nii"])
        # a made-up ball is no head: told, recorded and not tried again
        bem = ("--bem", "--bem-options", "vertices=162,162,162", "--no-pictures")
        done = self.bids(CHECK_FAILED, "participant", "--participant-label", "01", what=bem)
        self.assertIn("FAILED", done.stdout)
        done = self.bids(CHECK_FAILED, "group", "--participant-label", "01", what=bem)
        self.assertRegex(done.stderr, "^adaptiso-bids: failed: sub-01: bem: [^\n]*\n$")

    def wrapped(self, script):
        """A folder with adaptiso-bids and, for adaptiso-mesh, a script that may call the real one."""
        folder = self.path("bin")
        folder.mkdir()
        for program in BIN.iterdir():
            if program.name.startswith("adaptiso-") and program.is_file():
                os.link(program, folder / program.name) if program.name == "adaptiso-bids" else \
                    (folder / program.name).symlink_to(program)
        mesh = folder / "adaptiso-mesh"
        mesh.unlink()
        mesh.write_text(f'#!/bin/sh\ncase "$*" in *sub-01_T1w.nii*) {script};; esac\n'
                        f'exec {BIN / "adaptiso-mesh"} "$@"\n')
        mesh.chmod(0o755)
        return folder / "adaptiso-bids"

    def ended(self, program):
        return subprocess.run([program, "study", "out", "participant", "--participant-label", "01",
                               "02", *SURFACES], cwd=self.folder, text=True, capture_output=True,
                              timeout=300)

    def test_the_exit_code_says_whether_another_try_may_help(self):
        for number, (script, code) in enumerate((
                ("exit 4", 4), ("exit 127", BAD_INPUT), ("kill -9 $$", BAD_INPUT),
                ("echo '{\"schema\": \"adaptiso-failure/1\", \"shortage\": true}'; exit 3", BAD_INPUT),
                ("echo adaptiso-mesh: x: truncated, no memory >&2; exit 3", CHECK_FAILED),
                ("ulimit -v 60000", BAD_INPUT))):
            with self.subTest(script):
                if number:
                    shutil.rmtree(self.path("bin"))
                shutil.rmtree(self.path("out"), ignore_errors=True)
                done = self.ended(self.wrapped(script))
                self.assertEqual(done.returncode, code, done.stdout + done.stderr)
                self.assertRegex(done.stdout, "(?m)^done    .*sub-02_T1w.nii")

    def test_a_run_that_fails_leaves_the_surface_that_is_as_it_should_be(self):
        what = ("--surfaces", "iso=100.5,iso=60.5", "--no-pictures")
        self.bids(OK, "participant", "--participant-label", "01", "02", what=what)
        anat = self.path("out/sub-01/anat")
        (anat / "sub-01_desc-iso60p5_mesh.vtp").unlink()
        before = (anat / "sub-01_desc-iso100p5_mesh.vtp").read_bytes()
        done = subprocess.run([self.wrapped("exit 4"), "study", "out", "participant",
                               "--participant-label", "01", "02", *what], cwd=self.folder,
                              text=True, capture_output=True, timeout=300)
        self.assertEqual(done.returncode, 4, done.stdout + done.stderr)
        self.assertEqual((anat / "sub-01_desc-iso100p5_mesh.vtp").read_bytes(), before)

    def test_electrodes_are_inputs_too(self):
        what = ("--bem", "--bem-options", "vertices=162,162,162,electrodes=cap.tsv", "--no-pictures")
        self.path("cap.tsv").write_text("name\tx\ty\tz\nCz\t0\t0\t9\n")
        self.bids(CHECK_FAILED, "participant", "--participant-label", "01", what=what)
        record = next(self.path("out/sub-01/anat").glob("*.adaptiso-bem.json"))
        kept = {each["file"] for each in json.loads(record.read_text())["inputs"]}
        self.assertEqual(kept, {"sub-01_T1w.nii", "cap.tsv"})

    def test_heads_of_children_are_made_by_the_age_of_participants_tsv(self):
        self.path("study/participants.tsv").write_text("participant_id\tage\nsub-01\t8.5\nsub-02\t30\nsub-77\t9\n")

        def ages(*options):
            what = ("--bem", "--bem-options", ",".join(("vertices=162", *options)), "--no-pictures")
            self.bids(CHECK_FAILED, "participant", "--participant-label", "01", "02", what=what)
            records = sorted(self.path("out").rglob("*.adaptiso-bem.json"))
            return [next((option["sha256"] for option in json.loads(each.read_text())["options"]
                          if option["name"] == "--age"), None) for each in records]

        def digest(text):
            return hashlib.sha256(text.encode()).hexdigest()

        self.assertEqual(ages(), [digest("8.5"), None])
        self.assertEqual(ages("age=12"), [digest("12")] * 2)
        self.path("study/participants.json").write_text('{"age": {"Units": "months"}}')
        self.assertEqual(ages(), [digest(repr(8.5 * (1 / 12))), digest("2.5")])
        self.path("study/participants.json").write_text('{"age": {"Units": "parsec"}}')
        done = self.bids(CHECK_FAILED, "participant", "--participant-label", "01", what=("--bem", "--no-pictures"))
        self.assertRegex(done.stderr, "participants.json: the unit of 'age', parsec, is none of years.*no ages are taken")
        done = self.bids(OK, "participant", "--participant-label", "01", what=("--surfaces", "iso=100", "--no-pictures"))
        self.assertNotIn("participants.json", done.stderr)  # whose ages no surface asks for
        self.path("study/participants.json").unlink()
        self.bids(CHECK_FAILED, "group", what=("--bem", "--bem-options", "vertices=162,age=12", "--no-pictures"))
        self.assertIn("participants.tsv: lists participants without a folder: sub-77",
                      self.path("out/summary.html").read_text())

    def test_wrong_usage(self):
        self.path("notes.txt").write_text("mine")
        for code, pattern, arguments in (
                (USAGE, "LEVEL", ("both",)),
                (USAGE, "--surfaces lagrest: adaptiso-mesh has no such option; did you mean largest",
                 ("participant", "--surfaces", "iso=1,lagrest")),
                (USAGE, "--surfaces output=x: is set by", ("participant", "--surfaces=--iso=1,--output=x")),
                (USAGE, "--surfaces: its value is missing; one that begins with dashes is given as --surfaces=--iso=1,--largest",
                 ("participant", "--surfaces", "--iso=1,--largest")),
                (USAGE, "--surfaces iso=1: is given twice", ("participant", "--surfaces", "iso=1,iso=1.0")),
                (USAGE, "--surfaces format=doc", ("participant", "--surfaces", "iso=1,format=doc")),
                (USAGE, "--bem-options: needs --bem", ("participant", "--bem-options", "meg")),
                (USAGE, "--check: needs --surfaces", ("participant", "--bem", "--check")),
                (USAGE, "max-error", ("participant", "--participant-label", "01", "--surfaces",
                                      "iso=1,max-error=-3")),
                (BAD_INPUT, "--json notes.txt: exists and is no JSON report",
                 ("participant", "--surfaces", "iso=1", "--json", "notes.txt")),
                (BAD_INPUT, "there is no folder sub-99", ("participant", "--participant-label", "99")),
                (BAD_INPUT, "out: is not there; run the participant level first", ("group",))):
            with self.subTest(pattern):
                shutil.rmtree(self.path("out"), ignore_errors=True)
                done = self.bids(code, *arguments, what=())
                self.assertIn(pattern, done.stdout + done.stderr)
        done = subprocess.run([BIDS, "study", "./study/", "participant"], cwd=self.folder, text=True,
                              capture_output=True)
        self.assertEqual(done.returncode, USAGE)
        self.assertIn("is BIDS_DIR", done.stderr)

    def test_a_participant_of_wrong_names_fails_alone(self):
        self.scan("sub-02/anat/sub-01", ball(24, 8))
        self.scan("sub-0_8/anat/sub-0_8", ball(24, 8))
        done = self.bids(CHECK_FAILED, "participant")
        self.assertRegex(done.stdout, r"(?m)^FAILED  sub-02: sub-01: lies in the folder of sub-02; .*"
                                      r"--skip-bids-validation$")
        self.assertRegex(done.stdout, r"(?m)^FAILED  sub-0_8: ")
        self.assertEqual(len([line for line in done.stdout.splitlines() if line.startswith("done")]), 6)
        done = self.bids(CHECK_FAILED, "group")
        self.assertRegex(done.stderr, r"(?m)^adaptiso-bids: failed: sub-02: sub-01: lies in")
        self.assertEqual(sorted(row["participant_id"] for row in self.table()
                                if row["state"] == "failed"), ["sub-02", "sub-0_8"])
        self.bids(OK, "participant", "--participant-label", "02", "--skip-bids-validation")
        self.study.joinpath("dataset_description.json").write_text("{}")
        self.assertIn("has no Name", self.bids(BAD_INPUT, "participant").stderr)

    def test_an_image_that_is_there_twice_costs_its_own_line(self):
        scan = self.study / "sub-01/anat/sub-01_T1w.nii"
        self.bids(OK, "participant", "--participant-label", "01")
        scan.with_suffix(".nii.gz").write_bytes(gzip.compress(scan.read_bytes()))
        done = self.bids(CHECK_FAILED, "participant", "--participant-label", "01", "02")
        self.assertRegex(done.stdout, r"(?m)^FAILED  .*sub-01_T1w.nii: lies beside "
                                      r"sub-01_T1w.nii.gz, another image of its name; keep one, ")
        self.assertRegex(done.stdout, r"(?m)^done    .*sub-02_T1w.nii: ")
        done = self.bids(CHECK_FAILED, "group", "--participant-label", "01", "02")
        self.assertRegex(done.stderr, r"^adaptiso-bids: failed: sub-01: surfaces.*keep one\n$")
        scan.unlink()
        self.bids(OK, "participant", "--participant-label", "01", "02")
        self.bids(OK, "group", "--participant-label", "01", "02")

    def test_bidsignore_is_obeyed(self):
        self.scan("sub-08/anat/sub-08_acq-bad", ball(24, 8))
        self.scan("sub-08/anat/sub-08_acq-good", ball(24, 8))
        self.study.joinpath(".bidsignore").write_text(
            "# comment\n/sub-01\n**/*_acq-bad_*\nsub-0[3-6]/\nsub-02/anat/*\n!sub-04/\n")
        self.assertEqual(set(self.told(code=CHECK_FAILED)), {"sub-04", "sub-07", "sub-08_acq-good"})

    def test_participants_that_are_listed_and_not_there_are_warned_of(self):
        rows = "\n".join(f"sub-{number:02}\t3" for number in (1, 2, 3, 4, 5, 6, 9))
        self.study.joinpath("participants.tsv").write_text(f"participant_id\tage\n{rows}\n\n")
        done = self.bids(OK, "participant")
        self.assertEqual(done.stderr.splitlines(), [
            "adaptiso-bids: warning: participants.tsv: does not list sub-07",
            "adaptiso-bids: warning: participants.tsv: lists participants without a folder: sub-09"])
        report = json.loads(self.bids(OK, "group", "--json", "-").stdout)
        self.assertEqual([warning["code"] for warning in report["warnings"]],
                         ["subject-not-listed", "subject-not-there"])
        self.assertEqual(self.bids(OK, "group", "--participant-label", "01", "02").stderr, "")

    def test_side_files_of_any_program_are_read(self):
        self.scan("sub-08/anat/sub-08_acq-bad", ball(24, 8))
        ignored = "/sub-01\n**/*_acq-bad_*\nsub-0[3-6]/\nsub-02/anat/*\n/\n"
        listed = "participant_id\tage\nsub-07\t3\nn/a\t4\n"
        for text in ("\ufeff" + ignored, ignored.replace("\n", "\r\n"), ignored.replace("\n", "\r")):
            self.study.joinpath(".bidsignore").write_bytes(text.encode())
            self.assertEqual(set(self.told(code=CHECK_FAILED)), {"sub-07"})
        self.study.joinpath(".bidsignore").write_bytes(ignored.encode("utf-16"))
        done = self.bids(BAD_INPUT, "participant")
        self.assertIn(".bidsignore: is text in UTF-16; save it as UTF-8", done.stderr)
        self.study.joinpath(".bidsignore").unlink()
        for text, said in (("\ufeff" + listed.replace("\n", "\r"), "does not list sub-01"),
                           ("id\tage\n01\t3\n", "its first line names no column 'participant_id'")):
            self.study.joinpath("participants.tsv").write_bytes(text.encode())
            done = self.bids(OK, "participant", "--participant-label", "01")
            self.assertIn(f"warning: participants.tsv: {said}", done.stderr)

    def test_content_that_is_not_fetched_fails_with_the_command(self):
        scan = self.study / "sub-02/anat/sub-02_T1w.nii"
        scan.unlink()
        scan.symlink_to("../../.git/annex/objects/x/y/MD5E-s9--0123.nii/MD5E-s9--0123.nii")
        done = self.bids(CHECK_FAILED, "participant", "--participant-label", "01", "02")
        self.assertRegex(done.stdout, r"(?m)^FAILED  .*sub-02_T1w.nii: .*(git annex|datalad) get")
        self.assertRegex(done.stdout, r"(?m)^done    .*sub-01_T1w.nii: ")

    def test_version_as_bids_apps_have_it(self):
        for option in ("-v", "--version"):
            done = subprocess.run([BIDS, option], text=True, capture_output=True)
            self.assertRegex(done.stdout, r"^adaptiso-bids \d+\.\d+\.\d+\n")


class MadeAgain(BidsTest):
    def setUp(self):
        super().setUp()
        self.assertEqual(set(self.told("--participant-label", "01", "02").values()), {None})
        self.surface = self.path("out/sub-01/anat/sub-01_desc-iso100p5_mesh.vtp")

    def again(self, *arguments, what=SURFACES):
        return self.told("--participant-label", "01", "02", *arguments, what=what)

    def test_goes_by_content(self):
        self.assertEqual(self.again(), {"sub-01": False, "sub-02": False})
        whole = self.surface.read_bytes()
        for change, reason in (
                (lambda: self.surface.write_bytes(whole[:-1] + b"x"), "has changed"),
                (self.surface.unlink, "is gone"),
                (self.surface.with_suffix(".json").unlink, "mesh.json is gone"),
                (lambda: write_nifti(self.study / "sub-01/anat/sub-01_T1w.nii", ball(24, 9)),
                 "the input sub-01_T1w.nii has changed")):
            with self.subTest(reason):
                change()
                again = self.again()
                self.assertIn(reason, again["sub-01"])
                self.assertIs(again["sub-02"], False)

    def test_times_and_threads_are_no_change(self):
        os.utime(self.study / "sub-01/anat/sub-01_T1w.nii")
        os.utime(self.surface)
        self.assertEqual(self.again("--threads", 1, "--jobs", 2), {"sub-01": False, "sub-02": False})

    def test_the_order_of_options_is_no_change(self):
        for what in ("largest,iso=100.5", "iso=100.50,largest"):
            self.assertEqual(self.again(what=("--surfaces", what, "--no-pictures")),
                             {"sub-01": False, "sub-02": False})

    def test_other_options_replace_what_was_made_by_these(self):
        what = ("--surfaces", "iso=100.5", "--no-pictures")
        self.assertEqual(self.again(what=what)["sub-01"], "other options were given")
        self.assertEqual(self.again(what=what)["sub-01"], False)

    def test_no_surface_of_an_old_scan_stays_when_the_new_one_is_bad(self):
        (self.study / "sub-01/anat/sub-01_T1w.nii").write_text("no image")
        self.told("--participant-label", "01", code=CHECK_FAILED)
        self.assertEqual([name for name in self.tree() if name.startswith("sub-01")], [])

    def test_another_value_of_otsu_leaves_one_surface(self):
        what = ("--surfaces", "iso=auto", "--no-pictures")
        self.told("--participant-label", "03", what=what)
        first = set(self.tree())
        write_nifti(self.study / "sub-03/anat/sub-03_T1w.nii",
                    from_function(24, "h", lambda x, y, z: 700 if x * x + y * y + z * z < 50 else 13))
        self.told("--participant-label", "03", what=what)
        second = {name for name in self.tree() if name.startswith("sub-03")}
        self.assertEqual(len(second), 2)  # with its sidecar
        self.assertEqual(second & first, set())

    def test_files_of_others_stay(self):
        (self.surface.parent / "notes.txt").write_text("mine")
        self.surface.write_bytes(b"edited by hand")
        self.again()
        self.assertEqual((self.surface.parent / "notes.txt").read_text(), "mine")

    def test_killed_jobs_leave_nothing_half(self):
        long = self.scan("sub-03/anat/sub-03", noise(80))
        for ending in (signal.SIGKILL, signal.SIGTERM):
            process = subprocess.Popen([BIDS, "study", "out", "participant", "--participant-label", "03",
                                        "--surfaces", "iso=128", "--no-pictures"], cwd=self.folder,
                                       stdout=subprocess.DEVNULL)
            record = self.path("out/sub-03/anat/sub-03_desc-iso128_mesh.vtp.adaptiso-mesh.json")
            for _ in range(1000):
                if record.exists():
                    break
                time.sleep(0.01)
            process.send_signal(ending)
            process.wait(timeout=60)
            time.sleep(0.3)
            self.assertEqual([name for name in self.tree() if name.startswith("sub-03")], [])
        write_nifti(long, ball(24, 8))
        self.assertEqual(self.told("--participant-label", "03", what=("--surfaces", "iso=128", "--no-pictures")),
                         {"sub-03": "it was not run to its end"})
        self.assertEqual(len([name for name in self.tree() if name.startswith("sub-03")]), 2)

    def test_what_another_batch_has_made_meanwhile_is_not_made_again(self):
        self.surface.unlink()
        second = self.path("out/sub-02/anat/sub-02_desc-iso100p5_mesh.vtp")
        second.unlink()
        # the batch is held while it works on the first participant, until another has made the second
        first = self.path("study/sub-01/anat/sub-01_T1w.nii")
        content = first.read_bytes()
        write_nifti(first, ball(160, 60))
        slow = subprocess.Popen([BIDS, "study", "out", "participant", "--participant-label", "01", "02",
                                 *SURFACES, "--json", "-"], cwd=self.folder, stdout=subprocess.PIPE, text=True)
        for _ in range(1000):
            if self.path("out/sub-01/anat/sub-01_desc-iso100p5_mesh.vtp.adaptiso-mesh.json").exists():
                break
            time.sleep(0.01)
        os.kill(slow.pid, signal.SIGSTOP)
        self.assertNotEqual(self.told("--participant-label", "02"), {"sub-02": False})
        os.kill(slow.pid, signal.SIGCONT)
        lines = [json.loads(line) for line in slow.communicate(timeout=300)[0].splitlines()]
        self.assertEqual({line["name"]: line["earlierRun"] for line in lines},
                         {"sub-01": False, "sub-02": True})
        first.write_bytes(content)

    def test_two_at_once_end_with_the_same(self):
        alone = self.tree()
        shutil.rmtree(self.path("out"))
        for _ in range(3):
            both = [subprocess.Popen([BIDS, "study", "out", "participant", "--participant-label", "01",
                                      "02", *SURFACES], cwd=self.folder, stdout=subprocess.DEVNULL)
                    for _ in range(2)]
            self.assertEqual([process.wait(timeout=300) for process in both], [OK, OK])
            self.assertEqual(self.tree(), alone)
            self.assertEqual(self.again(), {"sub-01": False, "sub-02": False})
            self.surface.unlink()


class Group(BidsTest):
    def test_tells_of_surfaces_that_are_not_asked_for_now(self):
        self.bids(OK, "participant", what=("--surfaces", "iso=120", "--no-pictures"))
        self.bids(OK, "group", what=("--surfaces", "iso=120", "--no-pictures"))
        self.bids(OK, "participant", what=("--surfaces", "iso=100.5,iso=110,largest", "--no-pictures"))
        self.bids(OK, "participant")  # replaces the surfaces of both isovalues
        self.bids(CHECK_FAILED, "group")
        left = [row for row in self.table() if row["state"] == "leftover"]
        self.assertEqual([(row["participant_id"], row["part"]) for row in left],
                         [(f"sub-{number:02}", "iso120") for number in range(1, 8)])
        auto = ("--surfaces", "iso=auto", "--no-pictures")  # the file's name says what it came to
        shutil.rmtree(self.path("out"))
        self.bids(OK, "participant", what=auto)
        self.bids(OK, "group", what=auto)
        self.assertRegex(left[0]["reason"], r"sub-01_desc-iso120_mesh.vtp is of an isovalue .* not asked for now")

    def test_is_whole(self):
        self.bids(OK, "participant", "--check", "--jobs", 2)
        done = self.bids(OK, "group", "--check")
        self.assertIn("7 participants, 7 whole; 7 surfaces, 0 unusual", done.stdout)
        rows = self.table()
        self.assertEqual([row["participant_id"] for row in rows],
                         [f"sub-{number:02}" for number in range(1, 8)])
        for number, row in enumerate(rows, 1):
            self.assertEqual((row["state"], row["check"], row["part"]), ("done", "passed", "iso100p5"))
            # 0.5 of a step of 10 inside the sphere; the mesh is 0.15 off at most, chords less
            radius = 8 + 0.1 * number - 0.05
            self.assertAlmostEqual(float(row["volume_mm3"]), 4 / 3 * 3.14159265 * radius ** 3,
                                   delta=4 * 3.14159265 * radius ** 2 * 0.2)
            self.assertEqual((row["components"], row["genus"], row["crossing_pairs"]), ("1", "0", "0"))
        columns = list(rows[0])
        said = json.loads(self.path("out/quality.json").read_text())
        self.assertEqual(set(said), set(columns))
        self.assertTrue(all(said[column]["Description"] for column in columns))
        self.assertEqual(said["area_mm2"]["Units"], "mm^2")
        description = json.loads(self.path("out/dataset_description.json").read_text())
        self.assertEqual(description["GeneratedBy"][0]["Name"], "adaptiso-bids")
        self.assertEqual(description["DatasetLinks"], {"raw": "../study"})
        self.assertIn("All 7 done", self.path("out/summary.html").read_text())
        for name in (".bidsignore", "README"):
            self.assertTrue(self.path(f"out/{name}").read_text())

    def test_names_who_is_missing_and_why(self):
        self.scan("sub-02/anat/sub-02", ball(24, 8)).write_text("no image")
        shutil.rmtree(self.study / "sub-03/anat")
        numbers = [f"{number:02}" for number in (1, 2, 3, 5, 6, 7)]
        self.bids(CHECK_FAILED, "participant", "--participant-label", *numbers)
        self.path("out/sub-05/anat/sub-05_desc-iso100p5_mesh.vtp").unlink()
        write_nifti(self.study / "sub-06/anat/sub-06_T1w.nii", ball(24, 9))
        self.bids(OK, "participant", "--participant-label", "07",
                  what=("--surfaces", "iso=100.5", "--no-pictures"))
        (self.study / "sub-01").rename(self.study / "sub-10")
        (self.study / "sub-10/anat/sub-01_T1w.nii").rename(self.study / "sub-10/anat/sub-10_T1w.nii")
        done = self.bids(CHECK_FAILED, "group")
        told = {line.split(": ")[2]: line for line in done.stderr.splitlines()}
        for subject, pattern in (("sub-02", "failed: .*truncated"), ("sub-03", "missing: .*no T1w image"),
                                 ("sub-04", "missing: .*not run"), ("sub-05", "missing: .*mesh.vtp is gone"),
                                 ("sub-06", "missing: .*input sub-06_T1w.nii has changed"),
                                 ("sub-07", "missing: .*other options were given"),
                                 ("sub-10", "missing: .*not run"), ("sub-01", "leftover: ")):
            self.assertRegex(told[subject], pattern)
        self.assertEqual(len(told), 8)
        states = {row["participant_id"]: (row["state"], row["area_mm2"]) for row in self.table()}
        self.assertEqual(states["sub-02"], ("failed", "n/a"))
        self.assertEqual({area for _, area in states.values()}, {"n/a"})
        report = json.loads(self.bids(CHECK_FAILED, "group", "--json", "-").stdout)
        self.assertEqual((report["passed"], len(report["missing"])), (False, 8))

    def test_files_of_other_programs_stay(self):
        self.bids(OK, "participant", "--participant-label", "01")
        for name, text, pattern in (
                ("dataset_description.json", '{"GeneratedBy": [{"Name": "fmriprep"}]}', "fmriprep"),
                ("dataset_description.json", "no JSON", "of another dataset"),
                ("README", "mine", "not of adaptiso-bids"),
                (".bidsignore", "x", "not of adaptiso-bids")):
            with self.subTest(name):
                self.path(f"out/{name}").write_text(text)
                done = self.bids(BAD_INPUT, "group", "--participant-label", "01")
                self.assertRegex(done.stderr, f"{name}: is .*{pattern}")
                self.assertEqual(self.path(f"out/{name}").read_text(), text)
                self.assertFalse(self.path("out/quality.tsv").exists())
                self.path(f"out/{name}").unlink()
        self.bids(OK, "group", "--participant-label", "01")
        self.bids(OK, "group", "--participant-label", "01")  # its own
        done = self.bids(USAGE, "group", what=("--labels", "--segmentations", "out"))
        self.assertIn("is the folder of --segmentations", done.stderr)

    def test_leftovers_are_told_without_taking_what_is_good(self):
        self.scan("sub-01/anat/sub-01_acq-hi", ball(24, 9))
        self.bids(OK, "participant", "--participant-label", "01", "02")
        (self.study / "sub-01/anat/sub-01_T1w.nii").unlink()
        for number in range(2, 8):
            shutil.rmtree(self.study / f"sub-{number:02}")
        done = self.bids(CHECK_FAILED, "group")
        line = next(line for line in done.stderr.splitlines() if "leftover: sub-01:" in line)
        patterns = line.split("remove ")[1].split(" there")[0].split(" and ")
        anat = self.path("out/sub-01/anat")
        gone = {path.name for pattern in patterns for path in anat.glob(pattern)}
        self.assertTrue(gone)
        self.assertFalse([name for name in gone if "acq-hi" in name])

    def test_labels_of_segmentations_not_named_now_are_no_leftovers(self):
        image = ball(24, 8)
        path = self.path("seg/sub-01/anat/sub-01_space-T1w_dseg.nii")
        path.parent.mkdir(parents=True)
        self.path("seg/dataset_description.json").write_text('{"Name": "s", "BIDSVersion": "1.8.0"}')
        write_nifti(path, from_function(12, "B", lambda x, y, z: 1 if x * x + y * y + z * z < 16 else 0))
        self.bids(OK, "participant", "--participant-label", "01",
                  what=(*SURFACES, "--labels", "--segmentations", "seg"))
        for number in range(2, 8):
            shutil.rmtree(self.study / f"sub-{number:02}")
        self.bids(OK, "group")

    def test_takes_the_options_of_the_participant_level(self):
        what = ("--surfaces", "iso=100.5,largest", "--check")  # and pictures
        self.bids(OK, "participant", what=what)
        self.bids(OK, "participant", "--participant-label", "07", what=("--surfaces", "iso=100.5"))
        self.bids(OK, "participant", "--participant-label", "07", what=what)
        done = self.bids(OK, "group", what=())
        self.assertIn("7 participants, 7 whole; 7 surfaces", done.stdout)
        self.assertIn("options: --surfaces iso=100.5,largest --check", done.stdout)
        whole = self.tree()
        self.assertEqual({row["check"] for row in self.table()}, {"passed"})
        self.bids(OK, "group", what=what)
        self.assertEqual(self.tree(), whole)
        # of others nothing is there, and the same again takes the participant level's
        done = self.bids(CHECK_FAILED, "group", what=("--surfaces", "iso=100.5"))
        self.assertIn("7 participants, 0 whole", done.stdout)
        self.bids(OK, "group", what=())
        self.assertEqual(self.tree(), whole)

    def test_prints_options_that_give_the_same_table_again(self):
        """Every option that changes which files are made, or how a run is recorded."""
        self.scan("sub-01/anat/sub-01", ball(24, 8), "dseg")
        seg = self.study / "derivatives/seg of these"
        for number in range(1, 8):
            path = seg / f"sub-{number:02}/anat/sub-{number:02}_dseg.nii"
            path.parent.mkdir(parents=True)
            write_nifti(path, from_function(12, "B", lambda x, y, z: 3 if abs(x) < 3 > abs(y) and abs(z) < 3 else 0))
        for what in (("--surfaces", "iso=100.5", "--no-pictures"),
                     ("--surfaces", "iso=100.5"),
                     ("--surfaces", "iso=100.5,format=stl", "--no-pictures", "--check", "--check-options", "profile=view"),
                     ("--surfaces", "iso=100.5", "--strict", "--allow", "guessed-spacing,unit-converted", "--no-pictures"),
                     ("--labels", "--labels-options", "format=stl,file-names=name", "--segmentations", str(seg),
                      "--no-pictures")):
            with self.subTest(what):
                shutil.rmtree(self.path("out"), ignore_errors=True)
                self.bids(OK, "participant", what=what)
                done = self.bids(OK, "group", what=())
                whole = self.tree()
                printed = re.search(r"^options: (.*)$", done.stdout, re.MULTILINE)[1]
                again = self.bids(OK, "group", what=shlex.split(printed))
                self.assertEqual(again.stdout, done.stdout)
                self.assertNotIn(str(self.study.parent), self.path("out/summary.html").read_text())
                self.assertEqual(self.tree(), whole)
                self.assertNotIn(None, self.told(what=shlex.split(printed)).values())
                self.assertNotIn(True, [bool(again) for again in self.told(what=shlex.split(printed)).values()])

    def test_counts_results_whose_pictures_are_not_there(self):
        what = ("--surfaces", "iso=100.5")
        self.bids(OK, "participant", what=(*what, "--no-pictures"))
        self.assertIn("7 participants, 7 whole", self.bids(OK, "group", what=what).stdout)
        self.bids(OK, "participant", what=what)
        for figures in self.path("out").rglob("*_figures"):
            shutil.rmtree(figures)
        self.assertIn("7 participants, 7 whole", self.bids(OK, "group", what=()).stdout)

    def test_takes_what_most_participants_were_asked_for(self):
        self.bids(OK, "participant")
        self.bids(OK, "participant", "--participant-label", "07",
                  what=("--surfaces", "iso=100.5", "--no-pictures"))
        done = self.bids(CHECK_FAILED, "group", what=())
        self.assertIn("7 participants, 6 whole", done.stdout)
        # asked for anew in other words: nothing is made again, the words are kept
        other = ("--surfaces", "largest,iso=100.50", "--no-pictures")
        self.assertIs(self.told(what=other)["sub-01"], False)
        self.assertIn("options: --surfaces largest,iso=100.50", self.bids(OK, "group", what=()).stdout)

    def test_marks_no_outlier_of_no_effect(self):
        for number in range(1, 8):  # volumes by 0.03 % each, and one by 0.5 %
            spacing = 1.002 if number == 7 else 1 + 1e-4 * number
            self.scan(f"sub-{number:02}/anat/sub-{number:02}", ball(24, 8, (spacing,) * 3))
        self.bids(OK, "participant", what=("--surfaces", "iso=100.5,method=mc", "--no-pictures"))
        self.assertIn("0 unusual", self.bids(OK, "group", what=()).stdout)
        done = self.bids(OK, "group", "--outlier-percent", "0.1", what=())
        self.assertIn("1 unusual", done.stdout)
        marks = next(row["outliers"] for row in self.table() if row["outliers"] != "n/a")
        self.assertRegex(marks, r"volume_mm3:\+\d+\.\d\(\+0\.\d+%\)$")

    def test_marks_outliers(self):
        self.scan("sub-04/anat/sub-04", ball(24, 11))
        self.bids(OK, "participant", "--jobs", 2)
        done = self.bids(OK, "group")
        self.assertIn("7 surfaces, 1 unusual", done.stdout)
        marked = {row["participant_id"]: row["outliers"] for row in self.table() if row["outliers"] != "n/a"}
        self.assertEqual(list(marked), ["sub-04"])
        self.assertRegex(marked["sub-04"], r"^area_mm2:\+\d+\.\d\(\+\d+%\),volume_mm3:\+\d+\.\d\(\+\d+%\)$")
        page = self.path("out/summary.html").read_text()
        self.assertIn("All 7 done, 1 unusual", page)
        self.assertLess(page.index("sub-04"), page.index("sub-01"))
        self.bids(OK, "group", "--outlier", 100)
        self.assertEqual({row["outliers"] for row in self.table()}, {"n/a"})

    def test_an_unsound_surface_is_told(self):
        self.bids(OK, "participant")
        what = (*SURFACES, "--check", "--check-options", "profile=bem,min-angle=59")
        self.bids(CHECK_FAILED, "participant", what=what)
        done = self.bids(CHECK_FAILED, "group", what=what)
        self.assertRegex(done.stderr, "(?m)^adaptiso-bids: unsound: sub-01: surfaces iso100p5: ")

    def test_the_table_does_not_depend_on_who_made_what_when(self):
        self.bids(OK, "participant")
        self.bids(OK, "group")
        first = self.tree()
        shutil.move(self.path("out"), self.path("first"))
        for number in (5, 2, 7, 1, 3, 6, 4):
            self.bids(OK, "participant", "--participant-label", f"{number:02}", "--threads", 1)
        self.bids(OK, "group")
        self.assertEqual(self.tree(), first)

    def test_thumbnails_are_there(self):
        what = ("--surfaces", "iso=100.5")
        self.bids(OK, "participant", "--participant-label", "01", what=what)
        self.bids(OK, "group", "--participant-label", "01", what=what)
        self.assertIn('<img src="sub-01/anat/sub-01_desc-iso_figures/contours-axial.png"',
                      self.path("out/summary.html").read_text())


if __name__ == "__main__":
    main()
