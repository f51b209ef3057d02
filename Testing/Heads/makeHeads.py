"""Heads as patients have them, made of Debian's ch2 (mricron-data): each with the inner skull, outer skull and skin that
a right model has. Needs nibabel, numpy, scipy."""

from pathlib import Path

import nibabel
import numpy as np
from scipy import ndimage

TEMPLATES = Path("/usr/share/mricron/templates")
CENTRE = np.array((0.0, -17.0, 10.0))  # of ch2's inner skull, RAS mm


class Head:
    """ch2 in RAS mm, and voxels' depth (mm) below its three surfaces."""

    def __init__(self, surfaces):
        self.image = nibabel.load(TEMPLATES / "ch2.nii.gz")
        self.affine = self.image.affine
        self.t1 = np.asarray(self.image.dataobj).astype(np.float32)
        self.mask = (np.asarray(nibabel.load(TEMPLATES / "ch2bet.nii.gz").dataobj) > 0).astype(np.uint8)
        self.brain = float(np.median(self.t1[self.mask > 0]))
        self.inner, self.outer, self.skin = (
            signed_depth(inside(*surface, self.t1.shape, self.affine)) for surface in surfaces)
        shape = self.t1.shape
        self.xyz = [(np.arange(shape[a], dtype=np.float32) + self.affine[a, 3]).reshape(
            [-1 if b == a else 1 for b in range(3)]) for a in range(3)]

    def ball(self, centre, radius):
        return sum((x - c) ** 2 for x, c in zip(self.xyz, centre)) < radius * radius

    def at_cortex(self, direction):
        """Where a ray from the middle leaves the inner skull."""
        u = np.array(direction, float)
        u /= np.linalg.norm(u)
        for mm in np.arange(20, 130, 0.5):
            p = CENTRE + mm * u
            if self.inner[tuple(np.round(p - self.affine[:3, 3]).astype(int))] <= 0:
                return p, u
        raise ValueError(direction)


def inside(points, triangles, shape, affine):
    """Voxels inside a closed surface (points RAS mm): parity along z of a grid of 1 mm along the axes."""
    index = (points - affine[:3, 3]) / np.diag(affine)[:3]
    crossings = np.zeros((shape[0], shape[1], shape[2] + 1), np.int16)
    index = index + np.array((1e-4 * np.sqrt(2), 1e-4 * np.sqrt(3), 0))
    for a, b, c in index[triangles]:
        det = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if det == 0:
            continue
        low = np.maximum(np.ceil(np.minimum(np.minimum(a, b), c)[:2]), 0).astype(int)
        high = np.minimum(np.floor(np.maximum(np.maximum(a, b), c)[:2]), np.array(shape[:2]) - 1).astype(int)
        if (low > high).any():
            continue
        i, j = (g.ravel() for g in np.mgrid[low[0]:high[0] + 1, low[1]:high[1] + 1])
        v = ((i - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (j - a[1])) / det
        w = ((b[0] - a[0]) * (j - a[1]) - (i - a[0]) * (b[1] - a[1])) / det
        hit = (v >= 0) & (w >= 0) & (v + w <= 1)
        k = np.ceil(a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2]))
        k = np.clip(k, 0, shape[2]).astype(int)
        np.add.at(crossings, (i[hit], j[hit], k[hit]), 1)
    return np.cumsum(crossings, axis=2)[:, :, :shape[2]] % 2 == 1


def signed_depth(mask):
    return (ndimage.distance_transform_edt(mask) - ndimage.distance_transform_edt(~mask)).astype(np.float32)


class Case:
    def __init__(self, name, about, t1, mask=None, affine=None, moved=None, usable=True, options=(), source="--t1", compared=3,
                 right=None):
        self.name, self.about, self.t1, self.mask = name, about, t1, mask
        self.affine = affine
        self.moved = moved or (lambda points: points)  # from ch2's place to this head's, RAS mm
        self.usable = usable  # the skull can be seen: a model is expected
        self.options, self.source = list(options), source
        self.compared = compared  # surfaces, from inside out
        self.right = right  # compared with ch2 modelled this way; None: as the head itself


def smooth_noise(shape, sigma, seed):
    small = np.random.default_rng(seed).standard_normal([s // 4 + 2 for s in shape]).astype(np.float32)
    field = ndimage.zoom(ndimage.gaussian_filter(small, sigma / 4), 4, order=1)[:shape[0], :shape[1], :shape[2]]
    return field / field.std()


def rician(t1, share, brain, seed=0):
    random = np.random.default_rng(seed)
    return np.hypot(t1 + share * brain * random.standard_normal(t1.shape).astype(np.float32),
                    share * brain * random.standard_normal(t1.shape).astype(np.float32))


def coil(head, along=(0, 0, 0), bowl=0):
    ramp = [np.linspace(-1, 1, n, dtype=np.float32).reshape(x.shape) for n, x in zip(head.t1.shape, head.xyz)]
    return 1 + sum(b * r for b, r in zip(along, ramp)) + bowl * (sum(r * r for r in ramp) / 1.5 - 1)


def lesion(head, direction, radius, level, rim=0.15):
    """A ball at the cortex, its middle 0.6 radii below the inner skull, filled with one tissue; a rim as of gliosis."""
    place, u = head.at_cortex(direction)
    centre = place - 0.6 * radius * u
    t1 = head.t1.copy()
    texture = 1 + 0.05 * smooth_noise(t1.shape, 4, 3)
    for r, value in ((radius + 3, 0.5 * (level + 1) + rim), (radius, level)):
        ball = head.ball(centre, r) & (head.inner > 0.5)
        t1[ball] = (value * head.brain * texture)[ball]
    mask = head.ball(centre, radius + 3) & (head.inner > 0)
    smooth = ndimage.gaussian_filter(t1, 0.7)
    near = ndimage.binary_dilation(mask, iterations=2)
    t1[near] = smooth[near]
    return t1, mask


def warped(head, scale, bend_mm, seed):
    """Another head: scaled along the axes, bent smoothly."""
    shape = head.t1.shape
    bend = [bend_mm * smooth_noise(shape, 32, seed + a) for a in range(3)]
    grid = np.meshgrid(*[x.ravel() for x in head.xyz], indexing="ij")
    source = [(CENTRE[a] + (grid[a] - CENTRE[a]) / scale[a] + bend[a] - head.affine[a, 3]) for a in range(3)]
    t1 = ndimage.map_coordinates(head.t1, source, order=1)
    mask = ndimage.map_coordinates(head.mask, source, order=0)

    def moved(points):
        result = CENTRE + (points - CENTRE) * scale
        for _ in range(20):  # the bend is small and smooth: a fixed point
            at = (result - head.affine[:3, 3]).T
            shift = np.stack([ndimage.map_coordinates(b, at, order=1, mode="nearest") for b in bend], 1)
            result = CENTRE + (points - shift - CENTRE) * scale
        return result

    return t1, mask, moved


def t2_like(head):
    """CSF brightest, grey above white matter; bone stays dark, fat bright."""
    level = head.t1 / head.brain
    inner = np.clip(1.6 - 0.8 * level, 0.5, 1.5)
    t2 = np.where(head.inner > 0, inner, np.minimum(0.75 * level, 1.1)) * head.brain
    return ndimage.gaussian_filter(t2, 0.5).astype(np.float32)


def gadolinium(head, level=1.25, muscle=False):
    """Dura, sinuses, vessels, mucosa and the scalp's vessels take up contrast; with `muscle` muscles, scalp and marrow too."""
    t1 = head.t1.copy()
    bright = 1.9 * head.brain
    dura = np.abs(head.inner - 0.5) < 1.2
    t1[dura] = np.maximum(t1[dura], level * head.brain)
    place = head.xyz[0] + 0 * head.inner
    sinus = (np.abs(place) < 5) & (np.abs(head.inner - 3) < 4) & (head.xyz[2] > 0)
    t1[sinus] = bright
    random = np.random.default_rng(5)
    vessels = np.zeros(t1.shape, bool)
    for _ in range(60):
        p = CENTRE + np.array((35, 45, 35)) * random.standard_normal(3)
        u = random.standard_normal(3)
        for _ in range(80):
            u = u / np.linalg.norm(u) + 0.25 * random.standard_normal(3)
            p = p + u / np.linalg.norm(u)
            k = tuple(np.round(p - head.affine[:3, 3]).astype(int))
            if all(0 <= a < s for a, s in zip(k, t1.shape)):
                vessels[k] = True
    vessels = ndimage.binary_dilation(vessels)
    vessels &= (head.inner > -1) | ((head.outer < -1) & (head.skin > 2))
    t1[vessels] = bright
    face = (head.skin > 5) & (head.outer < -3) & (head.xyz[2] < -25) & (head.xyz[1] > 20)
    t1[face & (smooth_noise(t1.shape, 8, 8) > 0.3)] = bright
    changed = dura | vessels | sinus
    if muscle:
        scalp = (head.outer < -1) & (head.skin > 1)
        t1[scalp] *= 1.3
        marrow = (head.inner < -2) & (head.outer > 2) & (smooth_noise(t1.shape, 4, 9) > 0.2)
        t1[marrow] = np.maximum(t1[marrow], 1.1 * head.brain)
        changed |= scalp | marrow
    t1[changed] = ndimage.gaussian_filter(t1, 0.6)[changed]
    return t1


def frame(head):
    """A stereotactic frame: ring, four posts with pins to the bone, localizer rods of bright fluid; the pins' iron darkens."""
    pad = 40
    t1 = np.pad(head.t1, ((pad, pad), (pad, pad), (0, 0)))
    origin = head.affine[:3, 3] - (pad, pad, 0)
    x, y, z = (np.arange(n, dtype=np.float32).reshape([-1 if b == a else 1 for b in range(3)]) + origin[a]
               for a, n in enumerate(t1.shape))
    for sx in (-1, 1):
        for sy in (-1, 1):
            post = (np.abs(x - sx * 85) < 4) & (np.abs(y + 17 - sy * 100) < 4) & (z < 40)
            t1[post] = 0.7 * head.brain
            # the pin, from post to skull
            for s in np.linspace(0, 1, 60):
                px, py = sx * (85 - 40 * s), -17 + sy * (100 - 38 * s)
                t1[((x - px) ** 2 + (y - py) ** 2 + (z - 30) ** 2) < 9] = 0.05 * head.brain
    for px, py in ((-112, -17), (112, -17), (-112, 40), (112, 40), (-112, -74), (112, -74), (0, 118), (50, 118), (-50, 118)):
        t1[((x - px) ** 2 + (y - py) ** 2 < 16) & (z > -60) & (z < 90)] = 2.2 * head.brain
    for side in (-1, 1):  # the slanting rods of the N
        t1[((x - side * 112) ** 2 + (y + 17 - (z - 15) * 0.75) ** 2 < 16) & (np.abs(z - 15) < 75)] = 2.2 * head.brain
    ring = (np.abs(np.maximum(np.abs(x) / 100, np.abs(y + 17) / 118) - 1) < 0.04) & (z < -58)
    t1[ring] = 0.5 * head.brain
    affine = head.affine.copy()
    affine[:3, 3] = origin
    return ndimage.gaussian_filter(t1, 0.5), np.pad(head.mask, ((pad, pad), (pad, pad), (0, 0))), affine


def defaced(head, mm):
    """The face taken out to `mm` from the inner skull, below and in front of a plane, as defacing programs do."""
    t1 = head.t1.copy()
    face = (head.xyz[1] - 0.9 * head.xyz[2] > 70) & (head.inner < -mm)
    t1[face] = 0
    return t1


def craniotomy(head, direction, radius, sunken=4):
    """A flap of bone is gone: soft tissue in its place, and the scalp sunken."""
    place, _ = head.at_cortex(direction)
    hole = head.ball(place, radius) & (head.inner < -1.5) & (head.outer > -1)
    t1 = head.t1.copy()
    t1[hole] = 0.75 * head.brain * (1 + 0.08 * smooth_noise(t1.shape, 4, 4)[hole])
    skin = head.ball(place, radius - 5) & (head.skin > 0) & (head.skin < sunken)
    t1[skin] = 0.05 * head.brain
    return ndimage.gaussian_filter(t1, 0.5)


def seven_tesla(head):
    """Strong contrast, a bright middle, dark temporal lobes and cerebellum, noise, bright arteries."""
    level = head.t1 / head.brain
    t1 = np.where(head.inner > 0, np.clip(1 + 1.8 * (level - 1), 0, 2), level)
    middle = np.exp(-sum(((x - c) / s) ** 2 for x, c, s in zip(head.xyz, CENTRE + (0, 0, 15), (85, 95, 75))))
    field = 0.55 + 0.75 * middle
    field *= 1 - 0.45 * np.exp(-((head.xyz[0] - 45) ** 2 + (head.xyz[1] + 5) ** 2 + (head.xyz[2] + 35) ** 2) / 30 ** 2)
    field *= 1 - 0.4 * np.exp(-((head.xyz[0] + 45) ** 2 + (head.xyz[1] + 5) ** 2 + (head.xyz[2] + 35) ** 2) / 30 ** 2)
    return rician(t1 * field * head.brain, 0.04, head.brain, 7)


def wide_ventricles(head, magnified):
    """Hydrocephalus: the middle of the brain magnified, its surface in place."""
    middle, radii = CENTRE + (0, 2, 8), np.array((58, 74, 50))
    offsets = [(x - c) / r for x, c, r in zip(head.xyz, middle, radii)]
    share = np.sqrt(sum(o * o for o in offsets))
    drawn = np.where(share < 1, (1 + (magnified - 1) * share ** 2) / magnified, 1)
    source = [c + r * o * drawn - head.affine[a, 3] for a, (o, c, r) in enumerate(zip(offsets, middle, radii))]
    return ndimage.map_coordinates(head.t1, source, order=1)


def cut_sides(head, mm, slice_mm):
    """Sagittal slices of `slice_mm` that end `mm` inside the skin on both sides."""
    inside_skin = np.flatnonzero((head.skin > 0).any((1, 2)))
    x = np.arange(inside_skin[0] + mm, inside_skin[-1] - mm, slice_mm)
    grid = np.meshgrid(x, *[np.arange(s) for s in head.t1.shape[1:]], indexing="ij")
    affine = head.affine @ np.diag((slice_mm, 1, 1, 1))
    affine[:3, 3] += x[0] * head.affine[:3, 0]
    return ndimage.map_coordinates(head.t1, grid, order=1), ndimage.map_coordinates(head.mask, grid, order=0), affine


def thin(head, factor):
    """Skull, scalp and face of an infant: what lies outside the inner skull comes nearer to it by a factor."""
    nearest = ndimage.distance_transform_edt(head.inner <= 0, return_distances=False, return_indices=True)
    grid = np.indices(head.t1.shape).astype(np.float32)
    t1 = ndimage.map_coordinates(head.t1, nearest + (grid - nearest) / factor, order=1, mode="nearest")

    def moved(points):
        index = points - head.affine[:3, 3]
        voxel = np.clip(np.round(index).astype(int), 0, np.array(head.t1.shape) - 1)
        inner = nearest[:, voxel[:, 0], voxel[:, 1], voxel[:, 2]].T
        is_outside = head.inner[tuple(voxel.T)] <= 0
        return np.where(is_outside[:, None], inner + (index - inner) * factor, index) + head.affine[:3, 3]

    return t1, moved


def infant(head, size, factor):
    t1, moved = thin(head, factor)
    small = scaled(head, size, t1)
    return *small[:3], lambda points: small[3](moved(points))


def scaled(head, factor, t1=None):
    """The head of an infant: all of it smaller, in voxels of 1 mm."""
    shape = head.t1.shape
    affine = head.affine.copy()
    affine[:3, 3] = CENTRE + (head.affine[:3, 3] - CENTRE) * factor
    new = [int(np.ceil(s * factor)) for s in shape]
    grid = np.meshgrid(*[np.arange(n) / factor for n in new], indexing="ij")
    sharp = ndimage.gaussian_filter(head.t1 if t1 is None else t1, 0.5)
    return (ndimage.map_coordinates(sharp, grid, order=1), ndimage.map_coordinates(head.mask, grid, order=0), affine,
            lambda points: CENTRE + (points - CENTRE) * factor)


def stripped(head, background):
    data = np.asarray(nibabel.load(TEMPLATES / "ch2bet.nii.gz").dataobj).astype(np.float32)
    outside = data == 0
    if background == "noise":
        data[outside] = np.abs(3 * np.random.default_rng(1).standard_normal(outside.sum()))
    elif background == "dura":  # as brain.mgz: a rim of dura and some eyes is left
        rim = (head.inner > -2.5) & outside
        data[rim] = head.t1[rim]
    else:
        data[outside] = background
    return data


def cases(head, packages=None):
    """Names of all cases, each with what makes it. `packages`: a folder with unpacked npm packages (niivue's and papaya's
    samples), or None."""
    def case(name, about, make, **more):
        """`make` gives the image and, where these are others than ch2's, mask, affine and moved."""
        def made():
            parts = make()
            given = dict(zip(("t1", "mask", "affine", "moved"), parts if isinstance(parts, tuple) else (parts, head.mask)))
            return Case(name, about, **given, **more)
        return name, made

    yield case("clean", "ch2 as it is", lambda: head.t1)
    for name, scale, bend, seed in (("broad", (1.07, 0.95, 1.0), 3, 20), ("long", (0.95, 1.06, 0.98), 3, 30),
                                    ("small", (0.9, 0.9, 0.9), 2, 40), ("skewed", (1, 1, 1), 5, 50)):
        def other(scale=scale, bend=bend, seed=seed):
            t1, mask, moved = warped(head, np.array(scale), bend, seed)
            return t1, mask, head.affine, moved
        yield case(f"head-{name}", f"another head: axes times {scale}, bent by {bend} mm", other)
    for name, direction, radius, level in (
            ("cavity-left-20", (-1, -0.2, 0.6), 20, 0.28), ("cavity-frontal-15", (0.4, 1, 0.3), 15, 0.28),
            ("cavity-vertex-20", (0.5, -0.3, 1), 20, 0.28), ("bright-right-20", (1, 0.1, 0.4), 20, 1.75),
            ("bright-occipital-15", (-0.4, -1, 0.1), 15, 1.75), ("bright-left-18", (-1, 0.5, 0.3), 18, 1.6)):
        yield case(f"lesion-{name}", f"{'a cavity of CSF' if level < 1 else 'a bright lesion'}, radius {radius} mm",
                   lambda d=direction, r=radius, v=level: lesion(head, d, r, v)[0])
    yield case("lesion-given", "the first cavity, with --lesion", lambda: (lesion(head, (-1, -0.2, 0.6), 20, 0.28)[0],),
               options=["--lesion", lesion(head, (-1, -0.2, 0.6), 20, 0.28)[1].astype(np.uint8)])
    yield case("craniotomy", "a flap of 70 mm is gone, the scalp sunken", lambda: craniotomy(head, (1, 0.2, 0.5), 35))
    # the face's own skin can't be right
    yield case("defaced-8", "face taken out to 8 mm from the inner skull", lambda: defaced(head, 8), compared=1)
    yield case("bias-40", "bias field of 40 % upwards, 20 % to the front", lambda: head.t1 * coil(head, (0, 0.2, 0.4)))
    for lost in (0.3, 0.5, 0.8):
        yield case(f"bias-down-{100 * lost:.0f}", f"the signal falls from top to bottom, by {100 * lost:.0f} % in all",
                   lambda b=lost: head.t1 * coil(head, (0, 0, b / (2 - b))))
    yield case("bias-bowl", "a bowl of 30 %", lambda: head.t1 * coil(head, bowl=0.3))
    yield case("noise-9", "noise of 9 %", lambda: rician(head.t1, 0.09, head.brain))
    yield case("thick-slices", "slices of 3 mm",
               lambda: (head.t1[:, :, ::3], head.mask[:, :, ::3], head.affine @ np.diag((1, 1, 3, 1))))
    for mm in (4, 10):
        yield case(f"cut-sides-{mm}", f"slices of 1.5 mm, the outer {mm} mm of both sides not in the image", lambda m=mm: cut_sides(head, m, 1.5))
    for magnified in (2, 3):
        yield case(f"ventricles-{magnified}", f"hydrocephalus: ventricles {magnified} times as wide", lambda m=magnified: wide_ventricles(head, m))
    lifted = np.eye(4)
    lifted[2, 3] = 46
    yield case("cut-above-eyes", "the image ends at z = -25 mm",
               lambda: (head.t1[:, :, 46:], head.mask[:, :, 46:], head.affine @ lifted))
    # the dura lies on the inner skull of the model with a mask
    yield case("gadolinium", "contrast in dura, sinuses, vessels, mucosa", lambda: gadolinium(head), right="mask")
    yield case("gadolinium-faint", "the same, the dura no brighter than brain", lambda: gadolinium(head, 1.05), right="mask")
    yield case("gadolinium-muscle", "the same, muscles, scalp and marrow too", lambda: gadolinium(head, 1.3, True), right="mask")
    yield case("frame", "stereotactic frame with localizers", lambda: frame(head))
    yield case("seven-tesla", "7 T-like contrast and coil", lambda: seven_tesla(head))
    yield case("infant-72", "all of 72 % size", lambda: scaled(head, 0.72))
    yield case("infant-72-told", "the same with --age", lambda: scaled(head, 0.72), options=["--age", 0.25])
    for size, years in ((0.7, 0.2), (0.8, 0.7), (0.9, 2)):
        def young(size=size):
            return infant(head, size, 0.5)
        yield case(f"infant-thin-{100 * size:.0f}", f"{100 * size:.0f} % size, skull and scalp half as thick, with --age", young,
                   options=["--age", years])
        yield case(f"infant-untold-{100 * size:.0f}", "the same without --age", young, usable=False)
    yield case("t2", "T2-like", lambda: t2_like(head))
    for background in (0, 40, 255, "noise", "dura"):
        yield case(f"stripped-{background}", "ch2bet: no skull", lambda b=background: (stripped(head, b),), usable=False)
    for name, file in (("papaya", "tests/data/sample_image.nii.gz"), ("niivue", "src/mni152.nii.gz")):
        path = packages and next(iter(sorted(packages.glob(f"**/{file}"))), None)
        if path:
            def sample(path=path):
                image = nibabel.load(path)
                return np.asarray(image.dataobj).squeeze(), None, image.affine
            yield case(f"stripped-{name}", f"{name}'s sample, skull-stripped", sample, usable=False)
    labels = np.select([head.inner > 0, head.outer > 0, head.skin > 0], [1, 2, 3]).astype(np.uint8)
    tissues = ["--tissue", "brain=1", "--tissue", "skull=2", "--tissue", "scalp=3"]
    yield case("labels", "segmentation of the right model", lambda: (labels,), source="--labels", options=tissues)
    place, _ = head.at_cortex((1, 0.2, 0.5))
    yield case("labels-craniotomy", "the same with a hole of 70 mm",
               lambda: (np.where((labels == 2) & head.ball(place, 35), 3, labels).astype(np.uint8),), source="--labels",
               options=tissues)
    hu = np.select([head.inner > 0, head.outer > 0, head.skin > 0], [35, 900, 20], -1000).astype(np.float32)
    yield case("ct", "CT of the right model", lambda: (rician(hu + 1000, 0.2, 100) - 1000,), source="--ct")
