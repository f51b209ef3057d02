"""adaptiso-check --self-test: what it measures, and that it can fail."""

import json
import os
import resource
import subprocess

from support import BIN, ApplicationTest, ball, main, write_nifti

CHECK = str(BIN / "adaptiso-check")


class SelfTest(ApplicationTest):
    def run_check(self, *arguments, **environment):
        return subprocess.run([CHECK, *arguments], cwd=self.folder, text=True, capture_output=True,
                              env={**os.environ, "TMPDIR": str(self.folder), **environment},
                              timeout=120)

    def test_measures_and_passes(self):
        done = self.run_check("--self-test", "--json", "report.json", "--report", "page.html")
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        self.assertEqual(self.names(), ["page.html", "report.json"])  # no temporary is left
        report = json.loads(self.path("report.json").read_text())
        self.assertTrue(report["passed"])
        rows = {(row["phantom"], row["quantity"]): row for row in report["measurements"]}

        # 4/3 pi 20^3 mm3, and a volume that is measured, not the expected one repeated
        ball = rows["ball of 40 mm, mc", "volume"]
        self.assertAlmostEqual(ball["expected"], 33510.32, places=2)
        self.assertNotEqual(ball["measured"], ball["expected"])
        self.assertEqual(rows["torus of 40 and 16 mm, adaptive", "genus"]["measured"], 1)
        diameters = [row["measured"] for row in report["measurements"]
                     if row["phantom"].startswith("two bearing balls")
                     and row["quantity"].startswith("diameter")]
        self.assertEqual(len(diameters), 4)
        for diameter in diameters:
            self.assertAlmostEqual(diameter, 10, delta=0.05)
        for row in report["measurements"]:
            self.assertLessEqual(abs(row["measured"] - row["expected"]), row["tolerance"])
        defects = [row for row in report["measurements"] if row["phantom"].startswith("defect")]
        self.assertEqual(len(defects), 19)

        # the same to people: every measurement has its line, and there is a line to sign
        for row in report["measurements"]:
            self.assertIn(row["quantity"], done.stdout)
            self.assertIn(row["phantom"], done.stdout)
        self.assertRegex(done.stdout, r"(?m)^=> passed: All \d+ answers are right\.$")
        self.assertRegex(done.stdout, r"Name _+ +Date _+ +Signature _+\nWrote page.html, report.json; next: open page.html in a browser\n$")
        self.assertIn(report["machine"]["processor"], done.stdout)
        page = self.path("page.html").read_text()
        for text in ("Self-test of adaptiso", "Signature", "two bearing balls in CT, mc"):
            self.assertIn(text, page)

    def test_is_quick(self):
        """Processor time, which other programs on the machine do not add to."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.assertEqual(self.run_check("--self-test", "--quiet").returncode, 0)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.assertLess(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, 20)

    def test_has_a_check_of_every_kind_to_find(self):
        """Every check that a surface can fail is one that a planted defect has to trip."""
        done = self.run_check("--self-test", "--json", "-")
        planted = {row["phantom"] for row in json.loads(done.stdout)["measurements"]
                   if row["phantom"].startswith("defect")}
        self.mesh_of_a_ball()
        asked = json.loads(self.run_check("ball.stl", "--json", "-").stdout)
        names = {check["name"] for check in asked["surfaces"][0]["checks"]}
        # MNE's solid angle is told by the same surfaces as "closed"; the isosurface needs an image
        self.assertGreaterEqual(len(planted), len(names - {"solidAngle", "onIsosurface"}))

    def mesh_of_a_ball(self):
        write_nifti(self.path("ball.nii"), ball(24, 9))
        self.mesh("ball.nii", "--iso", "100", "-o", "ball.stl")

    def test_takes_nothing_else(self):
        for extra in (["ball.stl"], ["--nested"], ["--profile", "bem"], ["--list", "x"]):
            done = self.run_check("--self-test", *extra)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertRegex(done.stderr, r"^adaptiso-check: --self-test: not together with ")

    def test_needs_a_place_to_write(self):
        done = self.run_check("--self-test", TMPDIR=str(self.path("missing")))
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_fails_where_files_are_not_written_whole(self):
        """A limit on the size of files (4 kB) stands for a full disk: images can't be written."""
        script = f"ulimit -f 4; exec {CHECK} --self-test --quiet"
        done = subprocess.run(["bash", "-c", script], cwd=self.folder, text=True,
                              capture_output=True, timeout=120,
                              env={**os.environ, "TMPDIR": str(self.folder)})
        self.assertEqual((done.returncode, done.stdout), (1, ""), done.stderr)
        self.assertRegex(done.stderr, r"(?m)^adaptiso-check: self-test failed: ball of 40 mm, mc: ")
        self.assertEqual(self.names(), [])


if __name__ == "__main__":
    main()
