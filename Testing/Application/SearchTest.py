"""How the blocks that a surface touches are found never changes the mesh."""

import math
import os
from pathlib import Path

from support import ApplicationTest, ball, main, noise, onion, write_nifti

SEARCHES = ("kdtree", "octree", "linear")
# the thesis's volumes, where they are at hand
TEMPLATES = Path("/usr/share/mricron/templates")
DATA = Path(os.environ.get("ADAPTISO_DATA", "/work/shared/data"))


class Search(ApplicationTest):
    def test_mesh_is_the_same_to_the_byte(self):
        write_nifti(self.path("noise.nii"), noise(20))
        write_nifti(self.path("onion.nii"), onion())
        for name, isovalue in (("noise", 200), ("onion", 0)):
            for options in ([], ["--border", "open", "--method", "mc"], ["--block-size", "8"]):
                meshes = set()
                for search in SEARCHES:
                    self.mesh(f"{name}.nii", "--iso", isovalue, "--search", search, "-o", "a.ply",
                              *options)
                    meshes.add(self.path("a.ply").read_bytes())
                self.assertEqual(len(meshes), 1, (name, options))

    def test_report_says_which_and_what_it_cost(self):
        write_nifti(self.path("ball.nii"), ball())  # 24 voxels: 7^3 blocks of 4 with the border
        blocks = 7 ** 3
        memory = {"kdtree": blocks * 12, "octree": (blocks + 4 ** 3 + 2 ** 3 + 1) * 4,
                  "linear": blocks * 4}  # of int16
        for search in SEARCHES:
            with self.subTest(search):
                report = self.report("ball.nii", "--iso", "100", "--search", search)
                self.assertEqual(report["options"]["search"], search)
                self.assertEqual(report["index"]["search"], search)
                self.assertEqual(report["index"]["memoryBytes"], memory[search])
                counts = report["surfaces"][0]["blocks"]
                self.assertEqual(counts["total"], blocks)
                self.assertGreaterEqual(counts["nodesVisited"], counts["active"])
                if search == "linear":
                    self.assertEqual(counts["nodesVisited"], blocks)
        self.assertEqual(self.report("ball.nii", "--iso", "100")["index"]["search"], "kdtree")

    def test_kd_tree_visits_little_beside_the_answer_on_scans(self):
        for file in (DATA / "engine.nii.gz", DATA / "teapot.nii.gz", TEMPLATES / "ch2bet.nii.gz"):
            if not file.exists():
                self.skipTest(f"{file} is not at hand")
        # of the other two, isovalues that few blocks reach
        for file, values in ((DATA / "engine.nii.gz", (20, 50, 100, 150, 200, 250)),
                             (DATA / "teapot.nii.gz", (240,)),
                             (TEMPLATES / "ch2bet.nii.gz", (125,))):
            isovalues = [argument for v in values for argument in ("--iso", v)]
            for size in (2, 4, 8, 16):
                report = self.report(file, *isovalues, "--method", "boxes",
                                     "--no-check-crossings", "--block-size", size, "-o",
                                     "{iso}.ply")
                for surface in report["surfaces"]:
                    counts = surface["blocks"]
                    self.assertLessEqual(counts["nodesVisited"],
                                         1.2 * counts["active"] + math.sqrt(counts["total"]),
                                         (file.name, size, surface["isovalue"]))


if __name__ == "__main__":
    main()
