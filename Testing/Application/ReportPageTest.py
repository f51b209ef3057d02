"""Report pages: what they hold, and what people see of them in a browser."""

import base64
import hashlib
import html.parser
import json
import math
import os
import re
import resource
import struct
import subprocess
import unittest
from pathlib import Path

from PIL import Image

import browser
from support import (BAD_INPUT, BIN, CHECK_FAILED, MESH, OK, USAGE, ApplicationTest, ball, noise,
                     write_nifti)
from headDefects import icosphere, write_off

CHECK = str(BIN / "adaptiso-check")
EXPECTED = Path(__file__).parent / "expected"
PNG = b"\x89PNG\r\n\x1a\n"


class Page(html.parser.HTMLParser):
    """The elements of a page, and the text that is seen."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.seen, self.hidden = [], [], 0
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        self.hidden += tag in ("script", "style")

    def handle_endtag(self, tag):
        self.hidden -= tag in ("script", "style")

    def handle_data(self, data):
        if not self.hidden:
            self.seen.append(data)

    def all(self, tag):
        return [attributes for name, attributes in self.elements if name == tag]

    def text(self):
        return " ".join(" ".join(self.seen).split())


def read_off(path):
    lines = Path(path).read_text().split("\n")
    numbers = [line for line in lines if line and line[0] in "-0123456789"]
    vertices, triangles = map(int, numbers[0].split()[:2])
    points = [tuple(map(float, line.split())) for line in numbers[1:1 + vertices]]
    faces = [tuple(map(int, line.split()[1:4]))
             for line in numbers[1 + vertices:1 + vertices + triangles]]
    return points, faces


class ReportTest(ApplicationTest):
    """A ball in an image of 24^3 voxels that lies off the origin, and the same with a hole."""

    def setUp(self):
        super().setUp()
        write_nifti(self.path("ball.nii"), ball(24, 8, origin=(-10, 20, 30)))
        self.mesh("ball.nii", "--iso", "100", "--method", "mc", "--quiet", "-o", "sound.off")

    def check(self, *arguments, code=OK, **options):
        done = subprocess.run([CHECK, *map(str, arguments)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300,
                              **options)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def page(self, *arguments, code=OK, **options):
        self.check(*arguments, "--report", "page.html", "--quiet", code=code, **options)
        return Page(self.path("page.html").read_text())

    def run_program(self, name, *arguments, code=OK):
        done = subprocess.run([str(BIN / name), *map(str, arguments), "--quiet", "--report",
                               "page.html", "--pictures", "pictures"], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)
        self.assertEqual(done.returncode, code, done.stderr)
        return Page(self.path("page.html").read_text())

    def write_spheres(self, *radii):
        names = []
        for radius in radii:
            names.append(f"r{radius}.off")
            write_off(self.path(names[-1]), icosphere(radius))
        return names

    def make_hole(self):
        """Takes the triangles round the rightmost vertex away. The middle of the hole, RAS mm."""
        points, faces = read_off(self.path("sound.off"))
        right = max(range(len(points)), key=lambda v: points[v][0])
        rim = [[v for v in face if v != right] for face in faces if right in face]
        write_off(self.path("open.off"),
                  (points, [face for face in faces if right not in face]))
        total = sum(math.dist(points[a], points[b]) for a, b in rim)
        return [sum(math.dist(points[a], points[b]) * (points[a][axis] + points[b][axis]) / 2
                    for a, b in rim) / total for axis in range(3)]


class Contents(ReportTest):
    def test_a_sound_surface_passes(self):
        page = self.page("sound.off", "--volume", "ball.nii", "--iso", "100")
        self.assertIn("✔ PASSED", page.text())
        self.assertIn("Isovalue 100", page.text())
        self.assertIn("24 × 24 × 24", page.text())
        self.assertNotIn("FAILED", page.text())

    def test_a_hole_fails_and_is_told(self):
        middle = self.make_hole()
        page = self.page("open.off", code=CHECK_FAILED)
        self.assertIn("✘ FAILED", page.text())
        point = "(" + ", ".join(f"{v:.1f}" for v in middle) + ")"
        self.assertRegex(page.text(), r"hole of \d+ edges, [\d.]+ mm round, in open\.off\s+"
                         + re.escape(point))
        # and in the text at the same place
        self.assertIn("around " + ", ".join(f"{v:.2f}" for v in middle), page.text())

    def test_points_of_another_frame_are_said_to_be(self):
        self.mesh("ball.nii", "--iso", "100", "--quiet", "-o", "lps.off", "--coordinates", "lps")
        self.assertIn("those of lps.off in LPS mm", self.page("lps.off").text())
        self.assertNotIn("Points in the table", self.page("sound.off").text())

    def test_pictures_have_alt_texts_and_are_in_the_page(self):
        images = self.page("sound.off", "--volume", "ball.nii").all("img")
        self.assertGreaterEqual(len(images), 5)
        for image in images:
            self.assertTrue(image["alt"])
            self.assertTrue(image["src"].startswith("data:image/png;base64,"))

    def test_nothing_is_loaded_from_elsewhere(self):
        page = self.page("sound.off")
        for tag, attributes in page.elements:
            self.assertNotIn(tag, ("link", "iframe", "object", "embed", "base"))
            for name in ("src", "href", "action", "srcset"):
                value = attributes.get(name, "#")
                self.assertTrue(value.startswith(("#", "data:")), value[:80])
        policies = [meta["content"] for meta in page.all("meta")
                    if meta.get("http-equiv") == "Content-Security-Policy"]
        self.assertEqual(len(policies), 1)
        self.assertIn("default-src 'none'", policies[0])
        self.assertIn("webrtc 'block'", policies[0])

    def test_only_the_scripts_of_the_page_may_run(self):
        self.page("sound.off")
        text = self.path("page.html").read_text()
        policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]
        allowed = re.search(r"script-src ([^;]*);", policy)[1].split()
        scripts = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
        hashes = [base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in scripts]
        self.assertEqual(allowed, [f"'sha256-{each}'" for each in hashes] or ["'none'"])
        self.assertNotRegex(text, r"<[a-z][^>]*\son[a-z]+=")  # handlers would not run

    def test_folders_are_not_told(self):
        self.path("Jane^Doe").mkdir()
        os.rename(self.path("sound.off"), self.path("Jane^Doe/sound.off"))
        os.rename(self.path("ball.nii"), self.path("Jane^Doe/ball.nii"))
        self.page("Jane^Doe/sound.off", "--volume", "Jane^Doe/ball.nii", "--iso", "100")
        self.assertNotIn("Jane", self.path("page.html").read_text())
        self.page("Jane^Doe/no.off", "Jane^Doe/sound.off", code=BAD_INPUT)
        self.assertNotIn("Jane", self.path("page.html").read_text())

    def test_a_header_that_names_the_patient_is_not_told(self):
        data = bytearray(self.path("ball.nii").read_bytes())
        data[148:156] = b"Jane Doe"  # NIfTI's descrip
        self.path("ball.nii").write_bytes(data)
        self.page("sound.off", "--volume", "ball.nii")
        self.assertNotIn("Jane", self.path("page.html").read_text())

    def test_names_are_text_whatever_they_hold(self):
        name = "<img src=x onerror=alert(1)>&'.off"
        os.rename(self.path("sound.off"), self.path(name))
        page = self.page(name)
        self.assertIn(name, page.text())
        self.assertEqual([i for i in page.all("img") if "onerror" in i], [])

    def test_unreadable_files_are_told(self):
        self.path("bad.off").write_text("OFF\n3 1 0\n")
        page = self.page("sound.off", "bad.off", code=BAD_INPUT)
        self.assertIn("✘ FAILED", page.text())
        self.assertIn("1 of 2 files could not be read", page.text())
        page = self.page("bad.off", code=BAD_INPUT)
        self.assertIn("✘ FAILED", page.text())

    def test_same_input_same_bytes_but_for_the_times(self):
        environment = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000"}
        texts = []
        for threads in (1, 2):
            self.page("sound.off", "--volume", "ball.nii", "--threads", threads, env=environment)
            text = self.path("page.html").read_text()
            self.assertIn("2023-11-14 22:13 UTC", text)
            texts.append(text)
        self.assertEqual(*texts)


class Files(ReportTest):
    def test_pictures_alone(self):
        self.check("sound.off", "--volume", "ball.nii", "--pictures", "pictures", "--quiet")
        names = sorted(p.name for p in self.path("pictures").iterdir())
        self.assertEqual(names, ["contours-axial.png", "contours-coronal.png",
                                 "contours-sagittal.png", "spots.png", "surface-1.png"])
        for name in names:
            self.assertTrue((self.path("pictures") / name).read_bytes().startswith(PNG))
        self.assertFalse(self.path("page.html").exists())

    def test_a_folder_for_pictures_may_end_with_a_slash(self):
        for _ in ("new", "there"):
            self.check("sound.off", "--pictures", "slash//", "--quiet")
            self.assertTrue((self.path("slash") / "surface-1.png").exists())

    def view(self, *arguments):
        """(pixels, their box of what is drawn) of the one view of box.off, 10 x 20 x 30 mm."""
        corners = [(x, y, z) for z in (0, 30) for y in (0, 20) for x in (0, 10)]
        sides = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
        write_off(self.path("box.off"), (corners, [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]))
        self.check("box.off", "--pictures", "pictures", "--picture-size", "300x200", "--picture-background",
                   "transparent", "--json", "box.json", "--quiet", *arguments)
        with Image.open(self.path("pictures/view-1.png")) as image:
            self.assertEqual((image.size, image.mode), ((300, 200), "RGBA"))
            return image.load(), image.getbbox()

    def test_a_view_shows_its_side_as_large_as_it_can(self):
        # 94 % of 200 pixels are 188; the other side follows from the box's
        for side, width, height in (("front", 188 / 3, 188), ("left", 188 * 2 / 3, 188), ("top", 94, 188),
                                    ("90,0", 188 * 2 / 3, 188), ("0,-90", 94, 188),
                                    ("45,0", 188 * (10 + 20) / math.sqrt(2) / 30, 188)):
            with self.subTest(side):
                _, (left, top, right, bottom) = self.view("--picture-view", side)
                self.assertAlmostEqual(right - left, width, delta=2)
                self.assertAlmostEqual(bottom - top, height, delta=2)
                self.assertAlmostEqual(left + right, 300, delta=2)
                self.assertAlmostEqual(top + bottom, 200, delta=2)

    def test_a_view_has_the_colour_and_shading_asked_for(self):
        blue, _ = self.view("--picture-color", "2050ff", "--picture-shading", "flat")
        self.assertEqual(blue[0, 0][3], 0)
        red, green, most, opacity = blue[150, 100]
        self.assertEqual(opacity, 255)
        self.assertLess(red, green)
        self.assertLess(green, most)
        self.assertEqual({blue[x, y] for x in range(125, 175) for y in range(10, 190)}, {blue[150, 100]})
        edges, _ = self.view("--picture-color", "2050ff", "--picture-shading", "edges")
        dark = [(x, y) for x in range(125, 175) for y in range(10, 190) if edges[x, y] != blue[150, 100]]
        self.assertGreater(len(dark), 40)  # the diagonal of the side
        self.assertTrue(all(edges[at][2] < most for at in dark))
        self.assertEqual(json.loads(self.path("box.json").read_text())["options"]["picture"],
                         {"viewDeg": [0, 0], "sizePixels": [300, 200], "color": "#2050ff",
                          "background": "transparent", "shading": "edges"})

    def test_wrong_views_are_refused(self):
        for option, value, rule in (("view", "up", "front, back"), ("view", "0,91", "angles"), ("view", "1,2,3", "angles"),
                                    ("size", "300", "pixels"), ("size", "0x9", "16 to 4096"),
                                    ("size", "9000x90", "16 to 4096"), ("color", "#12345", "colour"),
                                    ("color", "+12345", "colour"), ("background", "red", "transparent"),
                                    ("shading", "round", "smooth, flat or edges")):
            done = self.check("sound.off", "--pictures", "pictures", f"--picture-{option}", value, code=USAGE)
            self.assertIn(rule, done.stderr)
        done = self.check("sound.off", "--picture-view", "left", code=USAGE)
        self.assertIn("--picture-view needs --pictures", done.stderr)

    def test_broken_surfaces_get_pictures_too(self):
        self.path("broken.off").write_text(
            "OFF\n4 3 0\nnan 0 0\n1 0 0\n0 1 0\n0 0 1\n3 1 2 3\n3 0 1 2\n3 1 2 99\n")
        page = self.page("broken.off", code=CHECK_FAILED)
        self.assertIn("broken.off from six sides", page.text())

    def test_an_input_is_never_overwritten(self):
        before = self.contents()
        done = self.check("sound.off", "--report", "sound.off", code=BAD_INPUT)
        self.assertRegex(done.stderr, "sound.off")
        self.check("sound.off", "--report", "missing/page.html", code=BAD_INPUT)
        self.check("sound.off", "--pictures", "ball.nii", code=BAD_INPUT)
        self.check("sound.off", "--pictures", "missing/pictures", code=BAD_INPUT)
        self.assertEqual(self.contents(), before)

    def test_no_display_is_needed(self):
        bare = {key: value for key, value in os.environ.items()
                if key not in ("DISPLAY", "WAYLAND_DISPLAY", "HOME")}
        self.page("sound.off", env=bare)


class EveryProgram(ReportTest):
    """Each makes a page that says what it is about."""

    def pictures(self):
        return {p.name for p in self.path("pictures").iterdir()}

    def test_mesh(self):
        page = self.run_program("adaptiso-mesh", "ball.nii", "--iso", "100", "--iso", "150",
                                "--method", "mc", "-o", "{iso}.ply")
        self.assertIn("● DONE", page.text())
        self.assertIn("2 surfaces of ball.nii", page.text())
        self.assertRegex(page.text(), r"Isovalue 100\s+Isovalue 150\s+Method mc")
        self.assertIn("no triangle crosses another", page.text())
        self.assertLessEqual({"surface-1.png", "surface-2.png", "contours-axial.png"},
                             self.pictures())

    def test_mesh_knows_of_crossings_that_need_no_counting(self):
        for method, verdict in (("adaptive", "no triangle crosses another"),
                                ("mc", "crossings were not looked for")):
            page = self.run_program("adaptiso-mesh", "ball.nii", "--iso", "100", "--method", method,
                                    "--no-check-crossings", "-o", method + ".ply")
            self.assertIn(verdict, page.text())

    def test_mesh_writes_nothing_when_it_fails(self):
        before = self.contents()
        self.assert_fails(BAD_INPUT, "no voxel reaches it", "ball.nii", "--iso", "1000",
                          "--report", "page.html", "--pictures", "pictures")
        self.assertEqual(self.contents(), before)
        self.assertFalse(self.path("pictures").exists())

    def test_mesh_does_not_change_the_surface(self):
        for name, more in (("a.ply", []), ("b.ply", ["--report", "page.html"])):
            self.mesh("ball.nii", "--iso", "100", "-o", name, *more)
        self.assertEqual(self.path("a.ply").read_bytes(), self.path("b.ply").read_bytes())

    def test_compare(self):
        self.mesh("ball.nii", "--iso", "120", "--method", "mc", "-o", "smaller.off")
        page = self.run_program("adaptiso-compare", "smaller.off", "sound.off", "--volume",
                                "ball.nii", "--max-mean", "1", code=CHECK_FAILED)
        self.assertIn("✘ FAILED", page.text())
        # 20 less than at the surface, 10 a voxel: two voxels, rounded to a tenth at each end
        distance = float(re.search(r"([\d.]+) mm on the mean", page.text()).group(1))
        self.assertAlmostEqual(distance, 2, delta=0.1)
        self.assertLessEqual({"surface-1.png", "surface-2.png"}, self.pictures())
        self.assertTrue(any("colours tell the distance" in i["alt"] for i in page.all("img")))
        page = self.run_program("adaptiso-compare", "smaller.off", "sound.off")
        self.assertIn("● DONE", page.text())

    def test_bem(self):
        names = self.write_spheres(60, 66, 74)
        page = self.run_program("adaptiso-bem", "--surfaces", *names, "-o", "model")
        self.assertIn("✔ PASSED", page.text())
        for name in ("inner_skull", "outer_skull", "outer_skin", "smallest gap"):
            self.assertIn(name, page.text())
        self.assertTrue(self.path("model/inner_skull.surf").exists())
        self.assertLessEqual({"surface-3.png", "spots.png"}, self.pictures())

    def test_bem_shows_why_there_is_no_model(self):
        names = self.write_spheres(20, 22, 24)  # no head is so small
        page = self.run_program("adaptiso-bem", "--surfaces", *names, "-o", "model",
                                "--min-gap", "0.5", code=CHECK_FAILED)
        self.assertIn("✘ FAILED", page.text())
        self.assertIn("No model could be guaranteed", page.text())
        self.assertIn("✘ fails:", page.text())
        self.assertIn("surface-1.png", self.pictures())
        self.assertEqual(sorted(p.name for p in self.path("model").iterdir()),
                         ["report.json", "spots.png"])
        self.assertEqual(self.path("model/spots.png").read_bytes(),
                         self.path("pictures/spots.png").read_bytes())


class Failures(ReportTest):
    """A report that can't be written costs nothing else."""

    def limited(self, *arguments):
        # in bytes: between the surface and the page, which holds the viewer's script
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000))
        return subprocess.run([*map(str, arguments), "--json", "run.json", "--report", "page.html",
                               "--pictures", "pictures"], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300,
                              preexec_fn=limit)

    def test_the_surface_stays(self):
        self.mesh("ball.nii", "--iso", "100", "--quiet", "-o", "known.off")
        done = self.limited(MESH, "ball.nii", "--iso", "100", "--quiet", "-o", "made.off")
        self.assertEqual(done.returncode, CHECK_FAILED, done.stderr)
        self.assertRegex(done.stderr, r"made\.off is written; the report failed: \S+: can't be written")
        self.assertEqual(self.path("made.off").read_bytes(), self.path("known.off").read_bytes())
        self.assertFalse(self.path("page.html").exists())
        self.assertFalse(self.path("pictures").exists())
        self.assertIn("can't be written",
                      json.loads(self.path("run.json").read_text())["reportFailure"])

    def test_the_checks_stay(self):
        done = self.limited(CHECK, "sound.off")
        self.assertEqual(done.returncode, CHECK_FAILED, done.stderr)
        self.assertIn("the checks are done; the report failed", done.stderr)
        self.assertIn("can't be written",
                      json.loads(self.path("run.json").read_text())["reportFailure"])

    def test_deface_needs_a_report(self):
        self.check("sound.off", "--deface-report", code=USAGE)


class Memory(ReportTest):
    def peak(self, *arguments):
        """Bytes that a run of adaptiso-mesh has resident at most."""
        run = subprocess.Popen([MESH, *map(str, arguments)], cwd=self.folder)
        _, status, usage = os.wait4(run.pid, 0)
        run.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(run.returncode, OK)
        return usage.ru_maxrss * 1024

    def test_a_report_of_a_large_surface_takes_at_most_300_mb_more(self):
        write_nifti(self.path("noise.nii"), noise(64))  # more than a million triangles
        run = ("noise.nii", "--iso", "128", "--method", "mc", "--no-check-crossings", "--quiet", "-o",
               "noise.ply")
        self.assertLess(self.peak(*run, "--report", "page.html") - self.peak(*run), 300e6)


class InTheBrowser(ReportTest):
    """What a person sees, in headless Chromium."""

    @classmethod
    def setUpClass(cls):
        if InTheBrowser.browser is None:
            InTheBrowser.browser = browser.Browser()
            unittest.addModuleCleanup(InTheBrowser.browser.close)

    browser = None  # one for all tests

    def show(self, *arguments, code=OK):
        self.browser.requests(), self.browser.console()  # those of the test before
        self.page(*arguments, code=code)
        if "without the interactive viewer" in self.path("page.html").read_text():
            self.skipTest("built without niivue")
        self.assertEqual(self.browser.open(self.path("page.html")), "ready",
                         self.browser.console())

    def outline_pixels(self):
        return self.browser.run("""
            const layer = document.getElementById("outlines");
            const { data } = layer.getContext("2d").getImageData(0, 0, layer.width, layer.height);
            let shown = 0;
            for (let n = 3; n < data.length; n += 4) shown += data[n] > 0;
            return shown;""")

    def cut(self, axis):
        """Points of the outline of the first surface in a slice through the crosshair, flat."""
        return self.browser.run("return adaptisoViewer.cutOf(adaptisoViewer.surfaces[0], arguments[0],"
                                " adaptisoViewer.slicePlane(arguments[0]))", axis)

    def assert_near(self, point, other, delta):
        for a, b in zip(point, other):
            self.assertAlmostEqual(a, b, delta=delta)


class Pages(InTheBrowser):
    def test_a_surface_without_an_image(self):
        self.show("sound.off")
        self.assertEqual(self.browser.console(), [])
        self.assertGreater(self.outline_pixels(), 100)

    def test_outlines_follow_the_slices_of_an_oblique_image(self):
        content = bytearray(self.path("ball.nii").read_bytes())
        turn, origin = math.radians(20), (-10, 20, 30)
        rows = ((1, 0, 0), (0, math.cos(turn), -math.sin(turn)), (0, math.sin(turn), math.cos(turn)))
        for row, start, at in zip(rows, origin, (280, 296, 312)):
            struct.pack_into("<4f", content, at, *row, start)
        self.path("oblique.nii").write_bytes(content)
        self.mesh("oblique.nii", "--iso", "100", "--method", "mc", "--quiet", "-o", "oblique.off")
        self.show("oblique.off", "--volume", "oblique.nii")

        def index(point, axis):
            return sum(rows[k][axis] * (point[k] - origin[k]) for k in range(3))
        middle = [origin[k] + 11.5 * sum(rows[k]) for k in range(3)]
        self.browser.run("adaptisoViewer.moveTo(arguments[0])", middle)
        for axis in range(3):
            points = self.cut(axis)
            self.assertGreater(len(points), 100)
            for n in range(0, len(points), 3):
                # niivue's matrices are floats; voxels are 1 mm
                self.assertAlmostEqual(index(points[n:n + 3], axis), 11.5, delta=0.02)
                self.assertAlmostEqual(math.dist(points[n:n + 3], middle), 8, delta=0.15)

    def test_serves_everybody_at_every_width(self):
        if not os.environ.get("ADAPTISO_AXE_SCRIPT"):
            self.skipTest("needs axe-core, which CMake fetches")
        axe = Path(os.environ["ADAPTISO_AXE_SCRIPT"]).read_text()
        self.addCleanup(self.browser.resize, 1280, 1700)
        widths = [360, 768, 1440]
        for name in self.make_every_page():
            self.browser.resize(widths[0])  # all but the first page: it is that already
            self.browser.open(self.path(name))
            for width in widths:
                with self.subTest((name, width)):
                    self.browser.resize(width)
                    self.assertEqual(self.browser.violations(axe), [])
                    # nothing but tables and pictures is wider than the screen, and those scroll
                    self.assertLessEqual(
                        self.browser.run("return document.documentElement.scrollWidth"), width)
                    if width == 360:  # rows are cards, which do not scroll
                        self.assertEqual(self.browser.run("""
                            return [...document.querySelectorAll(".scroll")].filter((part) =>
                                part.querySelector("table") && part.scrollWidth > part.clientWidth).length;"""), 0)
                        self.assertEqual(self.browser.run("""
                            return [...document.querySelectorAll("td:not(.outcome)")].filter((cell) =>
                                getComputedStyle(cell, "::before").content !== JSON.stringify(cell.dataset.label)).length;"""), 0)
            with self.subTest((name, "dark")), self.browser.dark():
                self.assertEqual(self.browser.violations(axe), [])
            widths.reverse()  # each change of the width is drawn anew, by the processor

    def make_every_page(self):
        """One of each program, of a failure too, and a batch's summary."""
        self.make_hole()
        self.mesh("ball.nii", "--iso", "120", "--method", "mc", "-o", "smaller.off")
        made = []
        for program, *arguments, code in (
                ("adaptiso-mesh", "ball.nii", "--iso", 100, "--iso", 150, "-o", "{iso}.ply", OK),
                ("adaptiso-check", "open.off", "--volume", "ball.nii", CHECK_FAILED),
                ("adaptiso-compare", "smaller.off", "sound.off", "--volume", "ball.nii",
                 "--max-mean", 1, CHECK_FAILED),
                ("adaptiso-bem", "--surfaces", *self.write_spheres(60, 66, 74), "-o", "model", OK)):
            self.run_program(program, *arguments, code=code)
            made.append(program + ".html")
            self.path("page.html").rename(self.path(made[-1]))
        names = [f"ball{n}.nii" for n in range(6)]  # as many as charts need
        for name in names:
            self.path(name).write_bytes(self.path("ball.nii").read_bytes())
        self.run_mesh(*names, "absent.nii", "--iso", 100, "--output-dir", "batch")
        return [*made, "batch/summary.html"]


class PageOfAHole(InTheBrowser):
    """Opened once: it is seen, and then clicked on."""

    def test_looks_as_it_did_and_a_click_on_a_place_moves_the_crosshair_there(self):
        middle = self.make_hole()
        self.show("open.off", "--volume", "ball.nii", code=CHECK_FAILED)
        with self.subTest("looks"):
            self.assert_looks_as_it_did(self.browser.screenshot(".screen"))
        with self.subTest("click"):
            self.assert_click_moves_the_crosshair(middle)

    def assert_click_moves_the_crosshair(self, middle):
        self.browser.run("adaptisoViewer.moveTo([0, 30, 40])")
        # a crosshair is kept in parts of the image as floats
        self.assert_near(self.browser.crosshair(), [0, 30, 40], 1e-3)
        button = next(b for b in self.browser.find("button[data-spot]") if "hole" in b.text)
        button.click()
        self.assert_near(self.browser.crosshair(), middle, 0.01)  # the page has it in floats
        self.assertEqual(button.get_attribute("aria-current"), "true")
        told = self.browser.find("#position")[0].text
        self.assertEqual(told, ", ".join(f"{v:.1f}" for v in self.browser.crosshair()) + " mm")

    def assert_looks_as_it_did(self, png):
        """Loosely: fonts and drivers differ. ADAPTISO_KEEP_SCREENSHOT=1 makes a new one."""
        expected = EXPECTED / "report-viewer.png"
        if os.environ.get("ADAPTISO_KEEP_SCREENSHOT"):
            expected.write_bytes(png)
        grey, known = (browser.grey(p, 48, 48) for p in (png, expected.read_bytes()))
        differences = sorted(abs(a - b) for a, b in zip(grey, known))
        # of 255; a view that is missing or turned changes a tenth of the parts by 100 and more
        self.assertLess(sum(differences) / len(differences), 4)
        self.assertLess(differences[int(0.98 * len(differences))], 60)


class PageOfASoundSurface(InTheBrowser):
    """Opened once, for drawing takes the processor seconds: a test puts back what it changes."""

    opened = None  # the page's address

    def setUp(self):
        super().setUp()
        if self.opened is None:
            self.show("sound.off", "--volume", "ball.nii")
            cls = type(self)
            cls.opened = self.path("page.html").as_uri()
            cls.console, cls.requests = self.browser.console(), self.browser.requests()

    def test_loads_without_errors_and_asks_for_nothing(self):
        self.assertEqual(self.console, [])
        self.assertEqual(self.requests, [self.opened])

    def test_a_script_that_is_put_in_does_not_run(self):
        self.assertIsNone(self.browser.run("""
            const script = document.createElement("script");
            script.textContent = "window.wasRun = true";
            document.body.append(script);
            document.body.insertAdjacentHTML("beforeend", "<img src='data:,' onerror='window.wasRun = true'>");
            return window.wasRun ?? null;"""))
        self.browser.console()

    def test_the_canvas_is_not_blank(self):
        grey = browser.grey(self.browser.screenshot(".screen"), 40, 40)
        bright = sum(g > 60 for g in grey)
        self.assertGreater(bright, 200)   # an eighth: the ball fills a part of each of four views
        self.assertLess(bright, 1400)     # black around it

    def test_keys_move_the_crosshair(self):
        start = self.browser.crosshair()
        self.browser.find("#gl")[0].send_keys("\ue014\ue013\ue00e")  # right, up, page up
        self.assert_near(self.browser.crosshair(), [v + 1 for v in start], 1e-3)

    def test_outlines_lie_where_the_surface_is_cut(self):
        self.browser.run("adaptisoViewer.moveTo([1.5, 31.5, 41.5])")  # the middle of the ball
        for axis in range(3):
            points = self.cut(axis)
            self.assertGreater(len(points), 100)
            for n in range(0, len(points), 3):
                # samples are rounded to a tenth of a voxel
                self.assertAlmostEqual(math.dist(points[n:n + 3], (1.5, 31.5, 41.5)), 8, delta=0.15)

    def test_a_hidden_surface_has_no_outline(self):
        self.assertGreater(self.outline_pixels(), 100)
        shown = self.browser.find("#surfaces input[type=checkbox]")[0]
        self.addCleanup(shown.click)
        shown.click()
        self.assertEqual(self.outline_pixels(), 0)

    def test_cutting_away_changes_the_picture(self):
        self.browser.run("adaptisoViewer.moveTo([1.5, 31.5, 41.5]);"
                         "adaptisoViewer.nv.setRenderAzimuthElevation(0, 90)")
        before = self.browser.screenshot(".screen")
        self.addCleanup(self.cut_away, "")
        self.cut_away("2+")
        after = self.browser.screenshot(".screen")
        before, after = (browser.grey(png, 40, 40) for png in (before, after))
        changed = [n for n, (a, b) in enumerate(zip(before, after)) if abs(a - b) > 15]
        # from above the inside shows, in the fourth of the views alone
        self.assertGreater(len(changed), 20)
        for n in changed:
            self.assertGreaterEqual(n // 40, 19)
            self.assertGreaterEqual(n % 40, 19)

    def cut_away(self, half):
        self.browser.run("const cut = document.getElementById('cut'); cut.value = arguments[0];"
                         "cut.dispatchEvent(new Event('change'))", half)


if __name__ == "__main__":
    browser.require()
    unittest.main(verbosity=2)
