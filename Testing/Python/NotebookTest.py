"""Meshes in notebooks: the viewer runs in its frame, a picture is there where frames or scripts are off,
nothing is loaded from anywhere. Exit code 77: no Chromium to try it in."""

import base64
import os
import re
import sys
import time
import unittest
from pathlib import Path

sys.path.append(str(Path(os.environ["ADAPTISO_SOURCE"]) / "Testing" / "Application"))

import adaptiso
import browser
import numpy as np
from support import InFolder, ball


def noise(n=50):
    """A surface of more triangles than a notebook is shown."""
    return adaptiso.surface(np.random.default_rng(1).normal(size=(n, n, n)), 0.5, method="mc")


class Html(unittest.TestCase):
    def test_is_small_and_says_what_it_shows(self):
        small = adaptiso.surface(ball(), -8)
        html = small._repr_html_()
        self.assertLess(len(html), 1.8e6)
        self.assertIn(f"{len(small.faces)} triangles", html)
        self.assertNotIn("coarser", html)
        large = noise()
        self.assertGreater(len(large.faces), 100000)
        html = large._repr_html_()
        self.assertLess(len(html), 4e6)
        self.assertIn("The viewer shows the surfaces coarser than they are", html)

    def test_loads_nothing(self):
        html = adaptiso.surface(ball(), -8)._repr_html_()
        self.assertEqual(re.findall(r"""(?:src|href)=["'](?!data:)""", html), [])
        self.assertIn('sandbox="allow-scripts"', html)  # the frame reaches nothing of the notebook
        self.assertIn("default-src &#39;none&#39;", html)
        self.assertNotRegex(html, "script-src[^;]*unsafe-inline")

    def test_of_nothing_is_a_line(self):
        self.assertEqual(adaptiso.Mesh([], [])._repr_html_(),
                         "<p>adaptiso.Mesh of 0 triangles, 0 vertices, RAS mm</p>")

    def test_picture_is_a_png(self):
        html = adaptiso.surface(ball(), -8)._repr_html_()
        [png] = re.findall(r'src="data:image/png;base64,([^"]*)"', html)
        self.assertTrue(base64.b64decode(png).startswith(b"\x89PNG"))


class InChromium(InFolder):
    def opened(self, html, webgl=True):
        page = self.folder / "notebook.html"
        page.write_text("<!DOCTYPE html><html lang=en><head><meta charset=utf-8><title>t</title></head>"
                        f"<body>{html}</body></html>")
        window = browser.Browser(webgl=webgl)
        self.addCleanup(window.close)
        window.driver.get(page.as_uri())
        return window

    def test_the_viewer_runs_in_its_frame(self):
        window = self.opened(adaptiso.surface(ball(), -8)._repr_html_())
        driver = window.driver
        driver.switch_to.frame(0)
        end = time.monotonic() + 120
        while not window.run("return document.body.dataset.viewer || null"):
            self.assertLess(time.monotonic(), end, "the viewer is neither ready nor missing")
            time.sleep(0.2)
        self.assertEqual(window.run("return document.body.dataset.viewer"), "ready",
                         window.run("return document.getElementById('viewer-missing').textContent"))
        self.assertEqual(window.run("return adaptisoViewer.surfaces.length"), 1)
        faces = window.run("return adaptisoViewer.surfaces[0].mesh.tris.length / 3")
        self.assertEqual(faces, len(adaptiso.surface(ball(), -8).faces))
        # nothing of what it shows is out of its frame's sight
        self.assertLessEqual(window.run("return document.documentElement.scrollWidth"),
                             window.run("return window.innerWidth"))

    def test_a_notice_of_no_viewer_lies_beside_the_picture(self):
        window = self.opened(adaptiso.surface(ball(), -8)._repr_html_(), webgl=False)
        picture = window.run("const b = document.images[0].getBoundingClientRect(); return b.bottom")
        top = window.run("return document.querySelector('iframe').getBoundingClientRect().top")
        window.driver.switch_to.frame(0)
        end = time.monotonic() + 60
        while window.run("return document.body.dataset.viewer || null") != "missing":
            self.assertLess(time.monotonic(), end, "the viewer is not missing")
            time.sleep(0.2)
        notice = "document.getElementById('viewer-missing')"
        self.assertGreaterEqual(top + window.run(f"return {notice}.getBoundingClientRect().top"), picture)
        self.assertNotIn("below", window.run(f"return {notice}.textContent"))

    def test_a_picture_is_seen_where_the_frame_is_taken_out(self):
        html = adaptiso.surface(ball(), -8)._repr_html_()
        html = re.sub(r"<iframe.*?</iframe>", "", html, flags=re.DOTALL)  # as notebooks do
        window = self.opened(html)
        width, height = window.run("const i = document.images[0]; return [i.naturalWidth, i.width]")
        self.assertGreater(width, 600)
        self.assertGreater(height, 300)


if __name__ == "__main__":
    browser.require()
    unittest.main(verbosity=2)
