#!/usr/bin/python3
"""trunkCt.py FILE [TIMES]   a trunk as CT shows it, noise kept: 256 x 256 x 350 voxels of 1.5 x 1.5 x 1.5 mm, int16 HU. Lungs, fat,
muscle and bones whose spongy inside lies about 300 HU. TIMES 2, 4 or 8: as many tiles, mirrored in turn along z, y and x, so
that surfaces go on across their walls. The same numbers give the same image."""
import sys

import nibabel as nib
import numpy as np
from scipy.ndimage import gaussian_filter

SIZE = np.array([256, 256, 350])
NOISE_HU = 120
SPONGE_HU = 130


def blurredNoise(rng, sigma):
    """Gaussian noise of variance 1 with that blur, in voxels."""
    noise = gaussian_filter(rng.standard_normal(SIZE, dtype=np.float32), sigma, mode="wrap")
    return noise / noise.std()


def trunk(rng):
    x, y, z = np.ogrid[-1 : 1 : 256j, -1 : 1 : 256j, 0 : 1 : 350j]
    hu = np.full(SIZE, -1000, np.float32)
    wide = 0.88 + 0.06 * np.cos(9 * z)

    def paint(isThere, value):
        hu[isThere] = np.broadcast_to(value, hu.shape)[isThere]

    paint((x / wide) ** 2 + (y / 0.7) ** 2 < 1, -100)  # fat
    paint((x / (wide - 0.06)) ** 2 + (y / 0.62) ** 2 < 1, 50)
    for side in (-1, 1):
        paint(((x - side * 0.42) / 0.33) ** 2 + (y / 0.45) ** 2 + ((z - 0.72) / 0.25) ** 2 < 1, -850)
    sponge = 320 + SPONGE_HU * blurredNoise(rng, 1.2)
    r = np.hypot(x, y - 0.42)
    column = (r < 0.155 + 0.012 * np.cos(2 * np.pi * 17 * z)) & (np.abs((17 * z) % 1 - 0.5) < 0.44)
    paint(column, sponge)
    paint(column & (r > 0.135), 700)
    ring = np.abs(np.hypot(x / (wide - 0.1), y / 0.56) - 1)
    ribs = (ring < 0.05) & (np.abs((14 * z + 1.5 * np.abs(y)) % 1 - 0.5) < 0.2) & (z > 0.4)
    paint(ribs, sponge)
    paint(ribs & (ring > 0.03), 750)
    for side in (-1, 1):  # hips
        bowl = np.sqrt(((x - side * 0.4) / 0.36) ** 2 + ((y - 0.05) / 0.4) ** 2 + ((z - 0.1) / 0.16) ** 2)
        paint((bowl < 1) & (bowl > 0.72), sponge)
        paint((bowl < 1) & (bowl > 0.95), 800)
    return gaussian_filter(hu, 0.6)


def main():
    path, times = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1
    rng = np.random.default_rng(1)
    image = trunk(rng)
    image += NOISE_HU * blurredNoise(rng, 0.5)
    tile = np.clip(np.rint(image), -1024, 3071).astype(np.int16)
    for axis in (2, 1, 0):
        if times > 1:
            tile = np.concatenate((tile, np.flip(tile, axis)), axis)
            times //= 2
    nib.save(nib.Nifti1Image(np.asfortranarray(tile), np.diag([1.5, 1.5, 1.5, 1])), path)


if __name__ == "__main__":
    main()
