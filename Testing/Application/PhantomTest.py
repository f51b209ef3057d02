"""Two bearing balls in a CT: their diameters and where they lie, by adaptiso-mesh."""

import array
import json
import math
import random
import subprocess

from support import BIN, ApplicationTest, Image, main, write_nifti

DIAMETER = 10       # mm
VOXEL = 0.5         # mm
CENTRES = ((-6.38, 0.13, 0.11), (6.62, 0.13, 0.11))  # mm; off the lattice of voxels
AIR, STEEL, NOISE = -1000, 3000, 20  # HU


def share(point, centre):
    """How much of the voxel round `point` lies in a ball: the mean over 5 x 5 x 5 places in it."""
    depth = DIAMETER / 2 - math.dist(point, centre)
    if abs(depth) > 0.5 * math.sqrt(3) * VOXEL:
        return float(depth > 0)
    steps = [((n + 0.5) / 5 - 0.5) * VOXEL for n in range(5)]
    x, y, z = point
    inside = sum(math.dist((x + a, y + b, z + c), centre) < DIAMETER / 2
                 for a in steps for b in steps for c in steps)
    return inside / 125


def bearing_balls():
    """int16 HU, each sample the mean over its voxel, with noise; RAS mm about the middle."""
    size = (55, 29, 29)
    noise = random.Random(2).gauss
    origin = [-VOXEL * (n - 1) / 2 for n in size]
    samples = array.array("h")
    for k in range(size[2]):
        for j in range(size[1]):
            for i in range(size[0]):
                point = [o + VOXEL * n for o, n in zip(origin, (i, j, k))]
                metal = sum(share(point, centre) for centre in CENTRES)
                samples.append(round(AIR + (STEEL - AIR) * metal + noise(0, NOISE)))
    return Image(size, "h", samples, (VOXEL,) * 3, origin)


class BearingBalls(ApplicationTest):
    def balls(self, *options):
        """Volume and middle of each piece of the surface, from left to right."""
        self.mesh("balls.nii", "--iso", (AIR + STEEL) / 2, "-o", "balls.off", *options)
        said = json.loads(subprocess.run(
            [BIN / "adaptiso-check", "balls.off", "--json", "-"], cwd=self.folder, text=True,
            capture_output=True, check=True).stdout)
        lines = [line.split() for line in self.path("balls.off").read_text().splitlines()
                 if line and not line.startswith(("OFF", "#"))]
        vertices = [tuple(map(float, line)) for line in lines[1:1 + int(lines[0][0])]]
        pieces = []
        for piece in said["surfaces"][0]["components"]:
            first = vertices[piece["firstVertex"]]
            own = [v for v in vertices if (v[0] > 0) == (first[0] > 0)]
            # the middle of what the vertices span, which does not depend on how they lie
            middle = [(min(axis) + max(axis)) / 2 for axis in zip(*own)]
            pieces.append((piece["signedVolumeMm3"], middle))
        return sorted(pieces, key=lambda piece: piece[1])

    def test_diameters_and_places(self):
        write_nifti(self.path("balls.nii"), bearing_balls())
        for options in ([], ["--method", "mc"]):
            with self.subTest(options):
                pieces = self.balls(*options)
                self.assertEqual(len(pieces), 2)
                for (volume, middle), centre in zip(pieces, CENTRES):
                    # a tenth of a voxel: what a caliper is asked of CT metrology
                    diameter = (6 * volume / math.pi) ** (1 / 3)
                    print(f"{' '.join(options) or 'adaptive'}: {diameter:.3f} mm", flush=True)
                    self.assertAlmostEqual(diameter, DIAMETER, delta=0.05)
                    # the farthest vertices: the bound of 0.075 mm, and noise of 20 in a slope of
                    # 4000 HU a voxel, each side
                    for found, known in zip(middle, centre):
                        self.assertAlmostEqual(found, known, delta=0.08)


if __name__ == "__main__":
    main()
