"""The page of adaptiso-labels in headless Chromium: the list of regions and what a click does."""

import os
import unittest
from pathlib import Path

import browser
from labelsSupport import LabelsTest, three_boxes
from support import write_nifti


class RegionsPage(LabelsTest):
    @classmethod
    def setUpClass(cls):
        cls.browser = browser.Browser()
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        super().setUp()
        write_nifti(self.path("boxes.nii"), three_boxes(origin=(-5, 3, 20)))
        self.path("boxes.tsv").write_text(
            "index\tname\tcolor\n1\tleft <one>\t#ff8000\n2\tright\t#0000ff\n7\tinner\t#00ff00\n")
        self.labels("boxes.nii", "-o", "out", "-q", "--report", "page.html")
        if "without the interactive viewer" in self.path("page.html").read_text():
            self.skipTest("built without niivue")
        self.browser.console()
        self.assertEqual(self.browser.open(self.path("page.html")), "ready", self.browser.console())

    def shown(self):
        """The regions whose boxes are ticked, and those that the viewer draws: the same."""
        ticked = [box.get_attribute("aria-label").removeprefix("Show ")
                  for box in self.browser.find(".region input") if box.is_selected()]
        drawn = self.browser.run("return adaptisoViewer.surfaces.map((s, n) => s.mesh.visible &&"
                                 " s.isShown ? n : -1).filter((n) => n >= 0)")
        self.assertEqual(len(drawn), len(ticked))
        told = self.browser.find("#region-count")[0].text
        self.assertEqual(told, f"{len(ticked)} of 3 shown")
        return ticked

    def button(self, name):
        return next(each for each in self.browser.find(".region button") if each.text == name)

    # opening a page takes seconds: one test looks at the list from all sides
    def test_the_list_of_regions(self):
        names = ["left <one> (1)", "right (2)", "inner (7)"]
        self.assertEqual([each.text for each in self.browser.find(".region button")], names)
        self.assertEqual(self.shown(), names)
        self.assertEqual(self.browser.find(".region .swatch")[0].value_of_css_property(
            "background-color"), "rgba(255, 128, 0, 1)")

        self.button("right (2)").click()
        self.assertEqual(self.shown(), ["right (2)"])
        # the box from voxel 8 to 13, 2 to 11, 2 to 9, whatever lies in it
        at = self.browser.crosshair()
        for value, low, high in zip(at, (8 - 5.5, 2 + 2.5, 2 + 19.5), (13 - 4.5, 11 + 3.5, 9 + 20.5)):
            self.assertTrue(low < value < high, at)
        self.assertEqual(self.button("right (2)").get_attribute("aria-current"), "true")

        self.browser.run("arguments[0].dispatchEvent(new MouseEvent('click', { ctrlKey: true }))",
                         self.button("inner (7)"))
        self.assertEqual(self.shown(), ["right (2)", "inner (7)"])
        self.browser.find("#show-none")[0].click()
        self.assertEqual(self.shown(), [])
        self.browser.find(".region input")[0].click()
        self.assertEqual(self.shown(), ["left <one> (1)"])
        self.browser.find("#show-all")[0].click()
        self.assertEqual(self.shown(), names)

        self.browser.find("#find")[0].send_keys("RIGHT")
        visible = [each.text for each in self.browser.find(".region button") if each.is_displayed()]
        self.assertEqual(visible, ["right (2)"])
        self.assertEqual(self.browser.console(), [])
        self.serves_everybody()

    def serves_everybody(self):
        script = os.environ.get("ADAPTISO_AXE_SCRIPT")
        if not script or not Path(script).is_file():
            print("axe-core is not there: accessibility is not tested")
            return
        for width in (1280, 390):
            self.browser.resize(width)
            self.assertEqual(self.browser.violations(Path(script).read_text()), [], width)


if __name__ == "__main__":
    browser.require()
    unittest.main(verbosity=2)
