"""The documentation's site, from disk as people open it: search finds what they look for.

Needs the target `documentation` with a site, and Chromium; exits 77 (skipped) without them."""

import os
import re
import sys
import time
import unittest
from pathlib import Path

SITE = Path(os.environ["ADAPTISO_BUILD"]) / "Documentation" / "html"

QUESTIONS = {  # what is typed: the page that answers
    "BEM MNE": "Tutorial.html",
    "gantry tilt": "TutorialPrint.html",
    "accurate": "Validation.html",
    "numpy": "Python.html",
    "cannot": "Limitations.html",
    "paraview": "TutorialAtlas.html",
    "extractSurface": "cpp/Extraction.html",
    "check_nested": "python.html",
    "npx": "npm/README.html",
}


class Search(unittest.TestCase):
    def test_finds_pages_from_disk(self):
        from browser import Browser
        browser = Browser(webgl=False)
        self.addCleanup(browser.close)
        for words, page in QUESTIONS.items():
            with self.subTest(words):
                browser.driver.get((SITE / "search.html").as_uri() + "?q=" + words.replace(" ", "+"))
                end = time.monotonic() + 30
                found = []
                while time.monotonic() < end and not any(page in link for link in found):
                    found = [link.get_attribute("href") for link in
                             browser.driver.find_elements("css selector", "ul.search li a")]
                    time.sleep(0.2)
                self.assertTrue(any(page in link for link in found), found)

    def test_styles_take_what_the_site_holds(self):
        for style in SITE.glob("_static/**/*.css"):
            for target in re.findall(r"""@import\s*(?:url\()?["']?([^"')]+)""", style.read_text(encoding="utf-8")):
                self.assertTrue((style.parent / target).resolve().is_relative_to(SITE.resolve()), target)
                self.assertTrue((style.parent / target).exists(), target)

    def test_start_page_answers_the_five_questions(self):
        text = (SITE / "index.html").read_text(encoding="utf-8")
        for page in ("Tutorial", "TutorialPrint", "Validation", "Python", "Limitations"):
            self.assertIn(f'href="Documentation/{page}.html"', text)


if __name__ == "__main__":
    import browser
    browser.require()
    if not (SITE / "search.html").exists():
        print("skipped: needs the packages of Documentation/site/packages.txt")
        sys.exit(77)
    unittest.main(verbosity=2)
