"""Report pages on paper: printed to PDF by Chromium, no picture is cut by the edge of a sheet, and
captions and headings stay with what they are of. Pages without WebGL, and those of batches."""

import base64
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import browser
from support import BIN
from headDefects import icosphere, write_off

POPPLER = ("pdfimages", "pdftotext")  # of Debian's poppler-utils


def output(*command):
    return subprocess.run(list(map(str, command)), check=True, text=True, timeout=60,
                          stdout=subprocess.PIPE).stdout


class Sheets:
    """A printed page. Chromium draws a picture that does not fit on every sheet that it reaches:
    one object of the PDF, named on each of these."""

    def __init__(self, pdf):
        rows = [line.split() for line in output("pdfimages", "-list", pdf).splitlines()[2:]]
        self.pictures = {}  # number of the object: sheets, in the order of the page
        for row in rows:
            if row[2] == "image":  # not a mask
                self.pictures.setdefault(int(row[10]), []).append(int(row[0]))
        text = output("pdftotext", "-layout", pdf, "-")
        self.lines = [[" ".join(line.split()) for line in sheet.splitlines() if line.strip()]
                      for sheet in text.split("\f")]

    def cut(self):
        return [sheets for sheets in self.pictures.values() if len(set(sheets)) > 1]

    def parted(self, captions):
        """Captions that are not on the sheet where their picture ends."""
        return [caption for caption, sheets in zip(captions, self.pictures.values())
                if not any(caption in line for line in self.lines[sheets[-1] - 1])]

    def left_behind(self, headings, captions):
        """Headings that end a sheet; some captions say the same."""
        return [lines[-1] for lines in self.lines
                if lines and lines[-1] in headings and lines[-1] not in captions]


class Printed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.browser = browser.Browser(webgl=False)  # the viewer is not printed
        surfaces = []
        for radius in (80, 86, 92):
            surfaces.append(f"r{radius}.off")
            write_off(cls.folder / surfaces[-1], icosphere(radius, 2))
        cls.write("bem.html", "adaptiso-bem", "--dry-run", "--surfaces", *surfaces)
        cls.write("check.html", "adaptiso-check", "--nested", *surfaces)
        for n, radius in enumerate((60, 80.1, 80.2, 80.3, 80.4, 80.5)):
            write_off(cls.folder / f"s{n}.off", icosphere(radius, 1))
        (cls.folder / "s6.off").write_text("OFF\n3 1 0\n")
        subprocess.run([str(BIN / "adaptiso-check"), *(f"s{n}.off" for n in range(7)), "--quiet",
                        "--output-dir", "batch"], cwd=cls.folder, timeout=300, stderr=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        cls.temporary.cleanup()

    @classmethod
    def write(cls, page, program, *arguments):
        subprocess.run([str(BIN / program), *arguments, "--quiet", "--no-warnings", "--report",
                        page], cwd=cls.folder, check=True, timeout=300)

    def printed(self, page, rule="", instead=""):
        """The sheets, captions and headings of a page, or of one with another rule in its style
        sheet."""
        text = (self.folder / page).read_text()
        if rule:
            self.assertEqual(text.count(rule), 1, "the rule is not there")
            text = text.replace(rule, instead)
        path = self.folder / "printed.html"
        path.write_text(text)
        self.browser.driver.get(path.as_uri())
        pdf = self.browser.driver.execute_cdp_cmd(
            "Page.printToPDF", {"preferCSSPageSize": True, "printBackground": True})["data"]
        (self.folder / "page.pdf").write_bytes(base64.b64decode(pdf))
        texts = [" ".join(text.split()) for text in self.browser.run(
            "return [...document.querySelectorAll('figcaption')].map((e) => e.textContent)")]
        headings = [" ".join(text.split()) for text in self.browser.run(
            "return [...document.querySelectorAll('h2, h3')].map((e) => e.textContent)")]
        return Sheets(self.folder / "page.pdf"), texts, headings

    def assert_whole(self, page):
        sheets, captions, headings = self.printed(page)
        # places, three directions of slices, three surfaces
        self.assertEqual(len(captions), 7)
        self.assertEqual(len(sheets.pictures), len(captions))
        self.assertEqual(sheets.cut(), [])
        self.assertEqual(sheets.parted(captions), [])
        self.assertIn("Pictures", headings)
        self.assertEqual(sheets.left_behind(headings, captions), [])

    def test_a_picture_stands_in_the_viewers_place(self):
        self.assertEqual(self.browser.open(self.folder / "check.html"), "missing")
        self.assertEqual(self.browser.run("return document.querySelector('.stage').offsetHeight"), 0)
        self.assertEqual(self.browser.find("button[data-spot]"), [])  # they would move nothing
        after = self.browser.find("#viewer + figure img")[0]
        self.assertIn("r80.off", after.get_attribute("alt"))

    def names(self):
        return self.browser.run("""return [...document.querySelectorAll("#runs tbody tr:not([hidden]) th")]
            .map((cell) => cell.textContent.slice(0, 2)).join(" ")""")

    def test_the_runs_of_a_batch_are_sorted_and_filtered(self):
        self.browser.open(self.folder / "batch/summary.html")
        self.assertEqual(self.names(), "s6 s0 s1 s2 s3 s4 s5")  # what failed is first
        def head(n):
            return self.browser.find(f"#runs thead th:nth-child({n}) button")[0]
        column = next(n for n in range(1, 9) if head(n).text.startswith("Volume"))
        for order in ("s0 s1 s2 s3 s4 s5 s6", "s5 s4 s3 s2 s1 s0 s6"):  # without a volume: last
            head(column).click()
            self.assertEqual(self.names(), order)
        self.browser.find("#find")[0].send_keys("S3")
        self.assertEqual((self.names(), self.browser.find("#run-count")[0].text), ("s3", "1 of 7"))
        self.browser.find("#find")[0].clear()
        self.browser.run("""const state = document.getElementById("state"); state.value = "0";
            state.dispatchEvent(new Event("change")); document.getElementById("find").value = "";
            state.dispatchEvent(new Event("change"));""")
        self.assertEqual(self.names(), "s6")

    def test_a_page_of_a_batch_fits_desks_and_phones(self):
        self.browser.open(self.folder / "batch/summary.html")
        self.addCleanup(self.browser.resize, 1280, 1700)
        for width in (390, 1300):
            self.browser.resize(width)
            self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
        self.assertEqual(len(self.browser.find(".charts figure:first-child svg .apart")), 1)  # seconds vary
        self.assertIn("s0.off", self.browser.find(".charts figcaption a")[0].text)

    def test_a_page_of_adaptiso_bem(self):
        self.assert_whole("bem.html")

    def test_a_page_of_adaptiso_check(self):
        self.assert_whole("check.html")

    def test_a_picture_that_does_not_fit_would_be_seen(self):
        sheets, _, _ = self.printed("check.html", "max-height: 240mm; ")
        self.assertEqual(len(sheets.cut()), 1, "the tall picture of the places")

    def test_a_picture_without_its_caption_would_be_seen(self):
        # as high as a sheet (A4 without its margins has 269 mm): no room for the caption
        sheets, captions, _ = self.printed(
            "check.html", "max-height: 240mm; max-width: 100%; width: auto; height: auto;",
            "height: 268mm; width: 100%;")
        self.assertEqual(sheets.cut(), [])
        self.assertNotEqual(sheets.parted(captions), [])

    def test_a_heading_alone_would_be_seen(self):
        # every heading is pushed to the end of a sheet
        sheets, captions, headings = self.printed(
            "check.html", "h2, h3 { break-after: avoid; }", "h2, h3 { break-after: page; }")
        self.assertNotEqual(sheets.left_behind(headings, captions), [])


if __name__ == "__main__":
    browser.require()
    if not all(map(shutil.which, POPPLER)):
        print("skipped: needs poppler-utils")
        sys.exit(browser.SKIPPED)
    unittest.main(verbosity=2)
