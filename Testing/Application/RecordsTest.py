"""What a batch believes of an earlier run, and the page that it builds from the records of all."""

import fcntl
import gzip
import json
import os
import signal
import subprocess
import time
from pathlib import Path

from support import BAD_INPUT, CHECK_FAILED, MESH, OK, ball, main, noise, write_metaimage, write_nifti
from BatchTest import CHECK, BatchTest, Page
from DicomTest import Sphere

RECORD = ".adaptiso-mesh.json"


class RecordsTest(BatchTest):
    def reasons(self, *arguments, code=OK, **options):
        """Why each input was made again: None, it was not there; False, it was left alone."""
        return [not line["earlierRun"] and line["madeAgain"]
                for line in self.lines(code, *arguments, "--skip-existing", **options)]

    def write_same_time(self, path, content):
        """Other bytes under the size and time of change that the file has."""
        before = path.stat()
        path.write_bytes(content)
        os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))

    def rows(self, page="out/summary.html"):
        """Verdict and what came of it by name and program, in the page's order; and the title."""
        text = self.path(page).read_text()
        self.assertEqual(Page(text).open, [])
        table = text[text.index('<table id="runs"'):]
        table = table[:table.index("</table>")]
        cells = [cell.replace("\xa0", " ") for cell in Page(table).cells]
        width = cells.index("Ended, UTC") + 1  # columns that would say nothing are left out
        rows = [dict(zip(cells[:width], cells[n:n + width])) for n in range(width, len(cells), width)]
        title = text[text.index('<p class="headline">'):]
        return ({(row["Name"], row.get("Program", "adaptiso-mesh").removeprefix("adaptiso-")):
                 (row["State"][2:], row["Result"]) for row in rows},
                title[title.index(">") + 1:title.index("</p>")])


class Skipping(RecordsTest):
    ARGUMENTS = ("a.nii", "b.nii", "--iso", 100, "-o", "{name}.stl", "--output-dir", "out")

    def setUp(self):
        super().setUp()
        self.assertEqual(self.reasons(*self.ARGUMENTS), [None, None])
        self.surface = self.path("out/a.stl")
        self.whole = self.surface.read_bytes()

    def test_a_truncated_surface_is_made_again_and_said_why(self):
        self.surface.write_bytes(self.whole[:100])
        done = self.batch(OK, *self.ARGUMENTS, "--skip-existing")
        self.assertRegex(done.stdout, r"(?m)^done    a.nii: .*; made again: a.stl has changed$")
        self.assertRegex(done.stdout, r"(?m)^before  b.nii: ")
        self.assertEqual(self.surface.read_bytes(), self.whole)
        self.assertEqual(self.reasons(*self.ARGUMENTS), [False, False])

    def test_every_kind_of_difference(self):
        a = self.path("a.nii").read_bytes()
        record = self.path("out/a.stl" + RECORD)

        def flip(path, at):
            content = bytearray(path.read_bytes())
            content[at] ^= 1
            self.write_same_time(path, bytes(content))

        def edit(**changes):
            record.write_text(json.dumps(json.loads(record.read_text()) | changes))
        for change, reason in (
                (lambda: flip(self.surface, 100), "a.stl has changed"),
                (self.surface.unlink, "a.stl is gone"),
                (lambda: flip(self.path("a.nii"), len(a) - 1), "the input a.nii has changed"),
                (lambda: self.path("a.nii").write_bytes(a), "the input a.nii has changed"),
                (record.unlink, "a.stl has no record"),
                (lambda: record.write_text(record.read_text()[:-20]), "its record is damaged"),
                (lambda: record.write_text("[]"), "its record is damaged"),
                (lambda: record.write_bytes(b"\xff\0"), "its record is damaged"),
                (lambda: edit(keptOutputs=7), "its record is damaged"),
                (lambda: edit(keptOutputs=[], outputs=[]), "it lacks a surface"),
                (lambda: edit(schema="adaptiso-record/9"), "its record is of another version"),
                (lambda: edit(build="adaptiso-mesh 0.0.1"), "another version has made it"),
                (lambda: edit(ended=False), "it was not run to its end"),
                (lambda: edit(exitCode=3), "its last run failed"),
                (lambda: edit(options=[]), "other options were given")):
            with self.subTest(reason):
                change()
                self.assertEqual(self.reasons(*self.ARGUMENTS), [reason, False])
                self.assertEqual(self.surface.read_bytes(), self.whole)
                self.assertEqual(self.reasons(*self.ARGUMENTS), [False, False])

    def test_a_touched_or_moved_file_is_the_same(self):
        os.utime(self.surface)
        os.utime(self.path("a.nii"))
        self.path("out").rename(self.path("elsewhere"))
        self.path("images").mkdir()
        for name in "ab":
            self.path(f"{name}.nii").rename(self.path(f"images/{name}.nii"))
        self.assertEqual(self.reasons("images/a.nii", "images/b.nii", *self.ARGUMENTS[2:-1],
                                      self.path("elsewhere")), [False, False])

    def test_other_options(self):
        self.assertEqual(self.reasons(*self.ARGUMENTS, "--method", "mc"),
                         ["other options were given"] * 2)
        self.assertEqual(self.reasons(*self.ARGUMENTS, "--method", "boxes"),
                         ["another --method was given"] * 2)

    def test_a_report_that_was_not_asked_for_before_or_has_changed(self):
        report = ("--report", "{name}.html", "--pictures", "{name}-pictures")
        self.assertEqual(self.reasons(*self.ARGUMENTS, *report),
                         ["a.html was not made", "b.html was not made"])
        self.assertEqual(self.reasons(*self.ARGUMENTS, *report), [False, False])
        picture = sorted(self.path("out/b-pictures").iterdir())[0]
        picture.write_bytes(b"")
        self.path("out/a.html").write_text("")
        self.assertEqual(self.reasons(*self.ARGUMENTS, *report),
                         ["a.html has changed", picture.name + " has changed"])
        self.path("out/a.html").unlink()  # a run without a report needs none
        self.assertEqual(self.reasons(*self.ARGUMENTS), [False, False])

    def test_a_failed_run_is_tried_again(self):
        self.lines(CHECK_FAILED, *self.ARGUMENTS, "bad.nii")
        self.assertEqual(self.reasons(*self.ARGUMENTS, "bad.nii", code=CHECK_FAILED),
                         [False, False, "its last run failed"])

    def test_records_name_no_folder_and_no_option_s_value(self):
        self.path("doe^john").mkdir()
        self.path("doe^john/a.nii").write_bytes(self.path("a.nii").read_bytes())
        self.lines(OK, "doe^john/a.nii", "--iso", 100, "--output-dir", "out")
        self.assertNotIn("doe", self.path("out/a-iso100.vtp" + RECORD).read_text())


class Inputs(RecordsTest):
    """All that an input consists of."""

    def assert_needed(self, change, *arguments):
        self.assertEqual(self.reasons(*arguments), [None])
        self.assertEqual(self.reasons(*arguments), [False])
        change()
        self.assertRegex(self.reasons(*arguments)[0], "^the input .* has changed$")

    def test_a_header_s_data_file(self):
        write_metaimage(self.path("whole.mha"), ball(24, 8))
        header, data = self.path("whole.mha").read_bytes().split(b"LOCAL\n")
        self.path("scan.mhd").write_bytes(header + b"scan.raw\n")
        self.path("scan.raw").write_bytes(data)
        other = ball(24, 7).packed()
        self.assert_needed(lambda: self.write_same_time(self.path("scan.raw"), other),
                           "scan.mhd", "--iso", 100)

    def test_a_pair_of_files(self):
        write_nifti(self.path("whole.nii"), ball(24, 8))
        content = bytearray(self.path("whole.nii").read_bytes())
        content[344:348] = b"ni1\0"
        content[108:112] = bytes(4)
        self.path("pair.hdr").write_bytes(content[:348])
        self.path("pair.img.gz").write_bytes(gzip.compress(bytes(content[352:])))
        self.path("pair.img").write_bytes(content[352:])
        self.path("pair.img.gz").unlink()
        self.assert_needed(lambda: self.path("pair.img").write_bytes(ball(24, 7).packed()),
                           "pair.hdr", "--iso", 100)

    def test_a_dicom_folder(self):
        Sphere().write(self.path("scan"), range(0, 81, 4))
        arguments = ("scan", "--iso", "250", "--output-dir", "scan/out")
        # what is written into the folder itself belongs to no input; slice 0 is at one end
        self.assert_needed(self.path("scan/0").unlink, *arguments)

    def test_an_image_of_an_option(self):
        self.mesh("a.nii", "--iso", 100, "-o", "a.stl")
        arguments = ("a.stl", "--volume", "a.nii", "--iso", 100, "--output-dir", "checked")
        self.assertEqual(self.reasons(*arguments, program=CHECK), [None])
        self.assertEqual(self.reasons(*arguments, program=CHECK), [False])
        write_nifti(self.path("a.nii"), ball(24, 7))
        self.assertEqual(self.reasons(*arguments, program=CHECK, code=CHECK_FAILED),
                         ["the input a.nii has changed"])


class Surfaces(RecordsTest):
    """One record for each run, beside its first surface."""

    def test_a_second_isovalue_has_its_own(self):
        arguments = ("a.nii", "--output-dir", "out")
        self.assertEqual(self.reasons(*arguments, "--iso", 100), [None])
        self.assertEqual(self.reasons(*arguments, "--iso", 90), [None])
        self.assertEqual(self.reasons(*arguments, "--iso", 100), [False])
        self.assertEqual(self.reasons(*arguments, "--iso", 90), [False])
        both = (*arguments, "--iso", 90, "--iso", 100)
        self.assertEqual(self.reasons(*both), ["other options were given"])
        self.assertEqual(self.reasons(*arguments, "--iso", 100), [False])
        lines = self.lines(OK, *both, "--skip-existing")
        self.assertTrue(lines[0]["earlierRun"])
        self.assertEqual(lines[0]["outputs"], ["a-iso90.vtp", "a-iso100.vtp"])
        self.assertEqual([surface["isovalue"] for surface in lines[0]["report"]["surfaces"]],
                         [90, 100])
        self.assertEqual(sorted(p.name for p in self.path("out").glob("*" + RECORD)),
                         ["a-iso100.vtp" + RECORD, "a-iso90.vtp" + RECORD])

    def test_of_one_run_are_told_apart(self):
        arguments = ("a.nii", "--output-dir", "out")
        self.assertEqual(self.reasons(*arguments, "--iso", 90, "--iso", "auto"), [None])
        self.assertEqual(self.reasons(*arguments, "--iso", "auto"), [None])
        self.path("out/a-iso90.vtp").write_text("")
        self.assertEqual(self.reasons(*arguments, "--iso", "auto"), [False])
        self.assertEqual(self.reasons(*arguments, "--iso", 90, "--iso", "auto"),
                         ["a-iso90.vtp has changed"])

    def test_of_folders_of_their_own(self):
        for folder in ("x", "y"):
            self.path(f"out/{folder}").mkdir(parents=True)
        arguments = ("a.nii", "--iso", 100, "--output-dir", "out", "-o")
        self.assertEqual(self.reasons(*arguments, "x/{name}.stl"), [None])
        self.assertEqual(self.reasons(*arguments, "y/{name}.stl"), [None])
        self.assertEqual(self.reasons(*arguments, "x/{name}.stl"), [False])
        self.assertEqual(len(self.rows()[0]), 1)  # of one name: two lines of the page
        self.assertIn("All 2 done", self.rows()[1])

    def test_two_inputs_that_write_one_surface_are_refused(self):
        write_nifti(self.path("a1.nii"), ball(24, 8))
        write_nifti(self.path("a11.nii"), ball(24, 8))
        done = self.batch(BAD_INPUT, "a1.nii", "a11.nii", "--iso", 0, "--iso", 10, "-o", "{name}{iso}.stl")
        self.assertRegex(done.stderr, "both would write a110.stl")


class SummaryPage(RecordsTest):
    """One page of all records of all programs."""

    def setUp(self):
        super().setUp()
        self.mesh_batch = ("a.nii", "b.nii", "bad.nii", "--iso", 100, "-o", "{name}.stl",
                           "--output-dir", "out")
        self.lines(CHECK_FAILED, *self.mesh_batch)

    def test_keeps_failures_whoever_runs_last(self):
        self.assertEqual(self.rows()[1], "1 of 3 failed")
        self.lines(OK, "out/a.stl", "out/b.stl", "--output-dir", "out", program=CHECK)
        rows, title = self.rows()
        self.assertEqual(title, "1 of 5 failed")
        self.assertEqual(list(rows)[0], ("bad", "mesh"))  # what failed is first
        self.assertEqual(rows["a.stl", "check"][0], "done")
        self.lines(OK, "c.nii", *self.mesh_batch[3:])
        self.assertEqual(self.rows()[1], "1 of 6 failed")

    def test_shows_what_is_gone_or_changed(self):
        self.lines(OK, "out/a.stl", "out/b.stl", "--output-dir", "out", program=CHECK)
        self.path("out/a.stl").unlink()
        content = bytearray(self.path("out/b.stl").read_bytes())
        content[200] ^= 1
        self.write_same_time(self.path("out/b.stl"), bytes(content))
        self.lines(OK, "c.nii", *self.mesh_batch[3:])
        rows, title = self.rows()
        self.assertEqual(title, "1 of 6 failed, 4 missing or changed")
        self.assertEqual(rows["a", "mesh"][0], "MISSING or CHANGED")
        self.assertRegex(rows["a", "mesh"][1], r"^a.stl is gone \(")
        self.assertRegex(rows["b", "mesh"][1], r"^b.stl has changed since it was written \(")
        self.assertRegex(rows["b.stl", "check"][1], r"^b.stl has changed since it was read \(")

    def test_shows_damaged_and_foreign_records(self):
        self.path("out/a.stl" + RECORD).write_text("{")
        self.path("out/b.stl" + RECORD).write_text('{"schema": "adaptiso-record/0"}')
        self.lines(OK, "c.nii", *self.mesh_batch[3:])
        rows, title = self.rows()
        self.assertEqual(title, "1 of 4 failed, 2 not finished")
        self.assertIn("damaged", rows["a.stl" + RECORD, ""][1])
        self.assertIn("another version", rows["b.stl" + RECORD, ""][1])

    def test_of_a_batch_that_was_killed(self):
        write_nifti(self.path("long.nii"), noise(96))
        process = subprocess.Popen([MESH, "c.nii", "long.nii", "a.nii", "--iso", "128",
                                    "--output-dir", "out"], cwd=self.folder,
                                   stdout=subprocess.PIPE, text=True)
        process.stdout.readline()  # of c.nii
        process.kill()
        process.communicate(timeout=60)
        self.assertIn("not finished", self.rows()[1])
        left = [json.loads(path.read_text()) for path in self.path("out").glob("long*.json")]
        self.assertEqual([(each["ended"], each["passed"], each["exitCode"]) for each in left], [(False, False, None)])
        self.lines(OK, "out/a.stl", "--output-dir", "out", program=CHECK)
        self.assertEqual(self.rows()[0]["long", "mesh"][0], "not finished")
        self.assertEqual(self.rows()[1], "1 of 7 failed, 2 not finished")

    def test_two_batches_at_once_lose_no_rows(self):
        processes = []
        for n in range(6):
            names = [f"p{n}-{k}.nii" for k in range(3)]
            for name in names:
                write_nifti(self.path(name), ball(8, 3))
            processes.append(subprocess.Popen([MESH, *names, "--iso", "100", "--output-dir", "out"],
                                              cwd=self.folder, stdout=subprocess.DEVNULL))
        for process in processes:
            self.assertEqual(process.wait(timeout=300), OK)
        rows, title = self.rows()
        self.assertEqual(title, "1 of 21 failed")

    def test_one_surface_made_by_two_batches_at_once(self):
        command = [MESH, "a.nii", "b.nii", "c.nii", "--iso", "100", "-o", "{name}.stl",
                   "--output-dir", "out"]
        processes = [subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL)
                     for _ in range(4)]
        for process in processes:
            self.assertEqual(process.wait(timeout=300), OK)
        self.assertEqual(self.reasons(*command[1:]), [False] * 3)
        self.assertEqual(self.rows()[1], "1 of 4 failed")


class LeftByAKill(RecordsTest):
    """Temporaries of a process that had no time to remove them."""

    def setUp(self):
        super().setUp()
        write_nifti(self.path("noise.nii"), noise())
        self.path("out").mkdir()

    def temporaries(self):
        return [p.name for p in self.path("out").iterdir() if p.name.startswith(".adaptiso-")]

    def are_locked(self):
        """True where there are temporaries, and their process holds the lock of each; a moment
        after it has made one it does not, and another run may remove that one."""
        def is_locked(name):
            with open(self.path(f"out/{name}"), "rb") as file:
                try:
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError:
                    return True
            return False
        names = self.temporaries()
        return bool(names) and all(map(is_locked, names))

    def start(self):
        """A run that has seconds between its first temporary file and its end; stopped there."""
        process = subprocess.Popen([MESH, "noise.nii", "--iso", "100", "--iso", "150", "--method",
                                    "mc", "-o", "out/noise-{iso}.obj"], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        while True:
            while not self.temporaries():
                self.assertIsNone(process.poll())
                time.sleep(0.001)
            process.send_signal(signal.SIGSTOP)
            os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
            if self.are_locked():  # there are none between its two surfaces
                return process
            process.send_signal(signal.SIGCONT)

    def test_go_with_the_next_run_and_not_before_their_process(self):
        process = self.start()
        self.path("out/.adaptiso-notes").write_text("a user's")
        self.mesh("a.nii", "--iso", 100, "-o", "out/a.stl")
        self.assertGreaterEqual(len(self.temporaries()), 2)
        process.kill()
        process.wait()
        self.mesh("a.nii", "--iso", 100, "-o", "out/a.stl")
        self.assertEqual(self.temporaries(), [".adaptiso-notes"])


if __name__ == "__main__":
    main()
