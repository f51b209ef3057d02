"""Many inputs: a run for each, told in a line; lists and BIDS datasets; going on after an end."""

import csv
import html.parser
import json
import os
import signal
import subprocess
import time
from pathlib import Path
from urllib.parse import unquote

from support import (BAD_INPUT, BIN, CHECK_FAILED, MESH, OK, USAGE, ApplicationTest, ball, main,
                     noise, write_nifti)

CHECK = str(BIN / "adaptiso-check")


class Page(html.parser.HTMLParser):
    """Links and table cells of a page; unclosed elements are an error."""

    def __init__(self, text):
        super().__init__()
        self.links, self.cells, self.open = [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.links += [values[key] for key in ("href", "src") if key in values and values[key][0] != "#"]
        if tag not in ("meta", "img", "br", "input"):
            self.open.append(tag)
        if tag in ("td", "th"):
            self.cells.append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag

    def handle_data(self, data):
        if "td" in self.open or "th" in self.open:
            self.cells[-1] += data


class BatchTest(ApplicationTest):
    def setUp(self):
        super().setUp()
        for name, radius in (("a", 6), ("b", 8), ("c", 9)):
            write_nifti(self.path(f"{name}.nii"), ball(24, radius))
        self.path("bad.nii").write_text("no image")

    def batch(self, code, *arguments, program=MESH, **options):
        done = subprocess.run([program, *map(str, arguments)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300, **options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def lines(self, code, *arguments, **options):
        done = self.batch(code, *arguments, "--json", "-", **options)
        return [json.loads(line) for line in done.stdout.splitlines()]


class ManyInputs(BatchTest):
    def test_are_told_in_their_order_and_past_a_bad_one(self):
        done = self.batch(CHECK_FAILED, "c.nii", "bad.nii", "a.nii", "b.nii", "--iso", 100, "--jobs", 3)
        told = [line.split(",")[0] for line in done.stdout.splitlines()]
        self.assertEqual(told[0], "done    c.nii: c-iso100.vtp")
        self.assertRegex(told[1], r"^FAILED  bad.nii: .*no NIfTI header")
        self.assertEqual(told[2:5], ["done    a.nii: a-iso100.vtp", "done    b.nii: b-iso100.vtp",
                                     "4 inputs"])
        self.assertRegex(told[5], r"^  1 failed: truncated: N bytes .*: bad.nii$")
        self.assertEqual(told[6:], ["Next: mend what failed"])
        self.assertEqual(done.stderr, "")

    def test_are_the_same_as_single_runs_to_the_byte(self):
        self.path("one").mkdir()
        for name in "abc":
            self.mesh(f"{name}.nii", "--iso", 100, "--largest", "-o", f"one/{name}.ply")
        self.batch(OK, "a.nii", "b.nii", "c.nii", "--iso", 100, "--largest", "-o", "{name}.ply",
                   "--output-dir", "many", "--jobs", 2)
        for name in "abc":
            self.assertEqual(self.path(f"many/{name}.ply").read_bytes(),
                             self.path(f"one/{name}.ply").read_bytes())

    def test_json_is_a_line_for_each_with_its_report(self):
        lines = self.lines(CHECK_FAILED, "a.nii", "bad.nii", "--iso", 80, "--iso", 100)
        self.assertEqual([line["name"] for line in lines], ["a", "bad"])
        self.assertEqual([line["exitCode"] for line in lines], [OK, BAD_INPUT])
        self.assertEqual(lines[0]["outputs"], ["a-iso80.vtp", "a-iso100.vtp"])
        self.assertEqual(lines[0]["report"]["schema"], "adaptiso-mesh/1")
        self.assertIn("no NIfTI header", lines[1]["error"]["text"])
        self.assertIsNone(lines[1]["report"])

    def test_json_to_a_file_beside_text(self):
        done = self.batch(OK, "a.nii", "b.nii", "--iso", 100, "--json", "lines.json")
        self.assertIn("2 inputs, 0 failed", done.stdout)
        self.assertRegex(self.batch(CHECK_FAILED, ".", "--iso", 100, "--output-dir", "of here").stdout,
                         r"FAILED  \.?[^:]*: no DICOM file found in this folder: it holds \d+ NIfTI files; .*\*\.nii")
        done = self.batch(OK, "a.nii", "b.nii", "--iso", 100, "--output-dir", "out")
        self.assertTrue(done.stdout.endswith("2 inputs, 0 failed\nWrote out/summary.html; next: open "
                                             "out/summary.html in a browser\n"), done.stdout)
        text = self.path("lines.json").read_text().splitlines()
        self.assertEqual([json.loads(line)["passed"] for line in text], [True, True])

    def test_a_table_has_a_line_for_each_surface(self):
        self.path("a.nii").rename(self.path("=a, b.nii"))
        done = self.batch(CHECK_FAILED, "=a, b.nii", "bad.nii", "--iso", 80, "--iso", 100, "--csv", "t.csv")
        with open(self.path("t.csv"), newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([(row["input"], row["state"], row["output"], row["isovalue"]) for row in rows],
                         [("'=a, b.nii", "done", "'=a, b-iso80.vtp", "80.0"),
                          ("'=a, b.nii", "done", "'=a, b-iso100.vtp", "100.0"), ("bad.nii", "failed", "", "")])
        self.assertGreater(float(rows[0]["volumeMm3"]), float(rows[1]["volumeMm3"]))
        self.assertIn("2 inputs, 1 failed\n  1 failed: truncated: ", done.stdout)
        self.assertRegex(rows[2]["result"], "^truncated: .* bytes")

    def test_quiet_tells_what_failed_on_stderr(self):
        done = self.batch(CHECK_FAILED, "a.nii", "bad.nii", "--iso", 100, "--quiet")
        self.assertEqual(done.stdout, "")
        self.assertRegex(done.stderr, r"^adaptiso-mesh: failed: bad.nii: [^\n]*\n$")

    def test_names_no_folder_in_json(self):
        self.path("doe^john").mkdir()
        self.path("doe^john/bad.nii").write_text("no image")
        done = self.batch(CHECK_FAILED, "doe^john/bad.nii", "a.nii", "--iso", 100, "--json", "-",
                          "--summary", "page.html")
        self.assertNotIn("doe", done.stdout + self.path("page.html").read_text())

    def test_one_input_with_a_name_in_its_output(self):
        self.batch(OK, "a.nii", "--iso", 100, "-o", "{name}.stl")
        self.assertTrue(self.path("a.stl").exists())

    def test_a_folder_that_is_not_there_is_told_once(self):
        for more, folder in (((), "sub"), (("--output-dir", "many"), "many/sub")):
            self.assert_fails(BAD_INPUT, f"sub/{{name}}.ply: there is no folder {folder}",
                              "a.nii", "b.nii", "--iso", 100, "-o", "sub/{name}.ply", *more)

    def test_inputs_of_one_name_are_refused(self):
        self.path("x").mkdir()
        write_nifti(self.path("x/a.nii"), ball(8, 3))
        self.assert_fails(BAD_INPUT, "x/a.nii and a.nii: both are named 'a'", "a.nii", "x/a.nii",
                          "--iso", 100)

    def test_an_input_whose_name_stands_for_names_is_refused(self):
        """Its run was once taken for many inputs again, whose run was taken for many inputs again."""
        self.path("a.nii").rename(self.path("{name}.nii"))
        self.assert_fails(BAD_INPUT, "{name}.nii: the name has {name} in it", "{name}.nii", "b.nii", "--iso", 100)
        self.path("list").write_text("b.nii\tx{name}\n")
        self.assert_fails(BAD_INPUT, "b.nii: the name has {name} in it", "--list", "list", "--iso", 100, "-o", "{name}.stl")

    def test_wrong_usage(self):
        for pattern, arguments in (
                ("--output x.stl: needs {name}", ("a.nii", "b.nii", "-o", "x.stl")),
                ("--bids: there is no such option", ("a.nii", "--bids", ".")),
                ("--jobs", ("a.nii", "--jobs", "0"))):
            with self.subTest(pattern):
                self.assert_fails(USAGE, pattern, *arguments, "--iso", 100)


class Lists(BatchTest):
    def test_give_names_and_leave_out_comments(self):
        self.path("list").write_text("# scans\n\na.nii\nb.nii\tsecond\r\n")
        self.batch(OK, "--list", "list", "--iso", 100, "-o", "{name}.stl", "--output-dir", "out")
        self.assertTrue(self.path("out/a.stl").exists())
        self.assertTrue(self.path("out/second.stl").exists())
        self.batch(OK, "--list", "list", "--iso", 100, "-o", "out/")
        self.assertTrue(self.path("out/second-iso100.vtp").exists())

    def test_of_any_program_are_read(self):
        for number, text in enumerate((b"\xef\xbb\xbfa.nii\r\nb.nii\r\n", b"a.nii\rb.nii",
                                       b"a.nii  \n   \nb.nii\t\n", b"\xef\xbb\xbf# scans\na.nii\nb.nii")):
            with self.subTest(text):
                self.path("list").write_bytes(text)
                self.batch(OK, "--list", "list", "--iso", 100, "-o", "{name}.stl", "--output-dir",
                           f"out{number}")
                self.assertTrue(self.path(f"out{number}/a.stl").exists())
                self.assertTrue(self.path(f"out{number}/b.stl").exists())
        self.path("list").write_bytes("a.nii\n".encode("utf-16"))
        self.assert_fails(BAD_INPUT, "--list list: is text in UTF-16; save it as UTF-8", "--list",
                          "list", "--iso", 100)

    def test_from_stdin(self):
        lines = self.lines(OK, "--list", "-", "--iso", 100, input="a.nii\nb.nii\n")
        self.assertEqual([line["name"] for line in lines], ["a", "b"])

    def test_faults(self):
        self.path("empty").write_text("# nothing\n")
        self.path("long").write_text("a.nii\tb\tc\n")
        self.path("out").write_text("a.nii\t../b\n")
        for name, pattern in (("empty", "names no input"), ("long", "more than two parts"),
                              ("out", "is no name"), ("missing", "can't be read")):
            with self.subTest(name):
                self.assert_fails(BAD_INPUT, pattern, "--list", name, "--iso", 100)


class GoingOn(BatchTest):
    ARGUMENTS = ("a.nii", "b.nii", "--iso", 100, "-o", "{name}.stl", "--output-dir", "out",
                 "--skip-existing")

    def again(self, *more):
        """Which inputs an earlier run had finished."""
        return [line["earlierRun"] for line in self.lines(OK, *self.ARGUMENTS, *more)]

    def setUp(self):
        super().setUp()
        self.assertEqual(self.again(), [False, False])

    def test_leaves_finished_inputs_alone(self):
        before = self.path("out/a.stl").stat().st_mtime_ns
        lines = self.lines(OK, *self.ARGUMENTS)
        self.assertEqual([line["earlierRun"] for line in lines], [True, True])
        self.assertEqual(lines[0]["report"]["surfaces"][0]["output"]["file"], "a.stl")
        self.assertEqual(self.path("out/a.stl").stat().st_mtime_ns, before)

    def test_goes_by_the_record_and_not_by_files(self):
        self.path("out/a.stl.adaptiso-mesh.json").unlink()
        self.path("out/a.stl").write_text("half a fi")
        self.assertEqual(self.again(), [False, True])
        self.assertGreater(self.path("out/a.stl").stat().st_size, 100)

    def test_takes_no_record_for_a_missing_surface_or_a_damaged_record(self):
        self.path("out/a.stl").unlink()
        record = self.path("out/b.stl.adaptiso-mesh.json")
        record.write_text(record.read_text()[:-20])
        self.assertEqual(self.again(), [False, False])

    def test_changed_options_or_inputs_are_run_again(self):
        self.assertEqual(self.again("--method", "mc"), [False, False])
        write_nifti(self.path("b.nii"), ball(24, 10))
        self.assertEqual(self.again("--method", "mc"), [True, False])

    def test_threads_and_jobs_are_no_change(self):
        self.assertEqual(self.again("--threads", 1, "--jobs", 2), [True, True])

    def test_a_failure_is_tried_again(self):
        self.lines(CHECK_FAILED, *self.ARGUMENTS, "bad.nii")
        write_nifti(self.path("bad.nii"), ball(24, 7))
        self.assertEqual(self.again("bad.nii"), [True, True, False])


class Ends(BatchTest):
    """Runs that end before their time."""

    def setUp(self):
        super().setUp()
        write_nifti(self.path("long.nii"), noise(96))  # minutes of triangles, if it were let

    def start(self, *inputs):
        return subprocess.Popen([MESH, *inputs, "--iso", "128", "--output-dir", "out", "--csv", "t.csv",
                                 "--json", "lines.json"], cwd=self.folder, text=True, start_new_session=True, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE)

    def child_of(self, process):
        """The run of long.nii, when it has begun."""
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        for _ in range(3000):
            for child in children.read_text().split():
                try:
                    # until it is a program of its own it has the batch's command line
                    if Path(f"/proc/{child}/cmdline").read_bytes().endswith(b"--\0long.nii\0"):
                        return int(child)
                except FileNotFoundError:
                    pass
            time.sleep(0.01)
        self.fail("the run did not begin")

    def temporaries(self):
        return [path for path in self.folder.rglob("*") if path.name.startswith(".adaptiso-")]

    def wait_for_end(self, child):
        for _ in range(3000):
            if not Path(f"/proc/{child}/cmdline").exists() or \
                    not Path(f"/proc/{child}/cmdline").read_bytes():
                return
            time.sleep(0.01)
        self.fail("the run went on without its batch")

    def test_a_crash_takes_nothing_down(self):
        process = self.start("a.nii", "long.nii", "b.nii")
        os.kill(self.child_of(process), signal.SIGKILL)
        out, _ = process.communicate(timeout=300)
        self.assertEqual(process.returncode, CHECK_FAILED)
        told = out.splitlines()
        self.assertRegex(told[1], "^FAILED  long.nii: ended by a signal: Killed")
        self.assertTrue(told[2].startswith("done    b.nii"))
        self.assertEqual(self.temporaries(), [])

    def test_a_caller_that_ignores_the_ends_of_children(self):
        self.batch(OK, "a.nii", "b.nii", "--iso", 100,
                   preexec_fn=lambda: signal.signal(signal.SIGCHLD, signal.SIG_IGN))

    def test_an_interrupted_batch_ends_its_runs_and_goes_on_later(self):
        for ending in (signal.SIGTERM, signal.SIGINT, signal.SIGKILL):
            with self.subTest(ending):
                process = self.start("a.nii", "long.nii", "b.nii")
                child = self.child_of(process)
                if ending == signal.SIGINT:
                    os.killpg(process.pid, ending)  # as a terminal does
                else:
                    process.send_signal(ending)
                _, errors = process.communicate(timeout=300)
                self.assertEqual(process.returncode, -ending)
                self.wait_for_end(child)
                self.assertEqual(self.temporaries(), [])
                self.assertFalse(self.path("out/long-iso128.vtp").exists())
                self.assertFalse(self.path("out/b-iso128.vtp").exists())
                if ending != signal.SIGKILL:
                    with open(self.path("t.csv"), newline="") as file:
                        self.assertEqual([(row["run"], row["exitCode"]) for row in csv.DictReader(file)],
                                         [("a", "0")])
                    self.assertEqual([json.loads(line)["name"] for line in
                                      self.path("lines.json").read_text().splitlines()], ["a"])
                    self.assertRegex(errors, r"^adaptiso-mesh: interrupted after 1 of 3 inputs; [^\n]*"
                                                     r"--skip-existing[^\n]*\n$")
        write_nifti(self.path("long.nii"), ball(24, 8))
        lines = self.lines(OK, "a.nii", "long.nii", "b.nii", "--iso", 128, "--output-dir", "out",
                           "--skip-existing")
        self.assertEqual([line["earlierRun"] for line in lines], [True, False, False])


class Checks(BatchTest):
    def setUp(self):
        super().setUp()
        for name in "abc":
            self.mesh(f"{name}.nii", "--iso", 100, "--method", "mc", "-o", f"{name}.stl")
        self.mesh("b.nii", "--iso", 100, "--border", "open", "-o", "b.ply")
        whole = self.path("a.stl").read_bytes()
        count = (len(whole) - 84) // 50
        self.path("open.stl").write_bytes(whole[:80] + (count - 1).to_bytes(4, "little") + whole[84:-50])

    def test_files_without_an_option_of_the_batch_are_told_in_full(self):
        done = self.batch(CHECK_FAILED, "a.stl", "open.stl", program=CHECK)
        self.assertEqual(done.stdout.count("=> passed as print"), 1)
        self.assertEqual(done.stdout.count("=> FAILED as print"), 1)

    def test_a_line_for_each(self):
        done = self.batch(CHECK_FAILED, "a.stl", "open.stl", "missing.stl", "--jobs", 2, program=CHECK)
        told = done.stdout.splitlines()
        self.assertRegex(told[0], "^done    a.stl: all that is required holds")
        self.assertRegex(told[1], "^FAILED  open.stl: closed")
        self.assertRegex(told[2], "^FAILED  missing.stl: ")
        self.assertEqual([p for p in self.names() if p.endswith("json")], [])

    def test_a_failed_check_is_finished(self):
        arguments = ("a.stl", "open.stl", "--output-dir", "out", "--skip-existing")
        self.lines(CHECK_FAILED, *arguments, program=CHECK)
        lines = self.lines(CHECK_FAILED, *arguments, program=CHECK)
        self.assertEqual([(line["earlierRun"], line["passed"]) for line in lines],
                         [(True, True), (True, False)])

    def test_heads_of_a_list(self):
        for head, order in (("good", "abc"), ("swapped", "cb")):
            self.path(head).mkdir()
            for name in order:
                self.path(f"{head}/{name}.stl").write_bytes(self.path(f"{name}.stl").read_bytes())
        self.path("heads").write_text("good/a.stl\tgood/b.stl\tgood/c.stl\nswapped/c.stl\tswapped/b.stl\n")
        lines = self.lines(CHECK_FAILED, "--nested", "--profile", "print", "--list", "heads",
                           program=CHECK)
        self.assertEqual([(line["name"], line["passed"], len(line["files"])) for line in lines],
                         [("good", True, 3), ("swapped", False, 2)])

    def test_skipping_needs_a_place_for_records(self):
        done = self.batch(USAGE, "a.stl", "--skip-existing", program=CHECK)
        self.assertIn("--output-dir", done.stderr)


class Summary(BatchTest):
    def test_links_what_is_there(self):
        write_nifti(self.path("x <i>&y%.nii"), ball(24, 8))
        self.batch(CHECK_FAILED, "a.nii", "x <i>&y%.nii", "bad.nii", "--iso", 100, "--summary", "page.html",
                   "--output-dir", "out")
        page = Page(self.path("page.html").read_text())
        self.assertEqual(page.open, [])
        self.assertEqual(len(page.links), 2)
        for link in page.links:
            self.assertTrue(self.path(unquote(link)).exists(), link)
        self.assertIn("x <i>&y%", page.cells)
        self.assertEqual(sum("FAILED" in cell for cell in page.cells), 1)


if __name__ == "__main__":
    main()
