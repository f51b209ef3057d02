"""Scans that no constant of the adaptive method was chosen by: parts of Debian's scans, as they are, rotated,
with thick slices, smoothed, with noise. Packages mricron-data and python3-nibabel; scipy."""
import pathlib

import nibabel
import numpy as np
from scipy import ndimage

TEMPLATES = pathlib.Path("/usr/share/mricron/templates")
NIBABEL = pathlib.Path(nibabel.__file__).parent / "tests" / "data"


def template(name):
    return np.asarray(nibabel.load(TEMPLATES / f"{name}.nii.gz").dataobj, dtype=np.float32)


def turned(samples, degrees=((20, (0, 1)), (15, (1, 2)))):
    for angle, axes in degrees:
        samples = ndimage.rotate(samples, angle, axes=axes, order=1, reshape=False)
    return samples


def noisy(samples, sigma):
    """Rician, as magnitude images have it."""
    random = np.random.default_rng(1)
    real, imaginary = (random.normal(0, sigma, samples.shape) for _ in range(2))
    return np.hypot(samples + real, imaginary).astype(np.float32)


def slope(samples):
    smooth = ndimage.gaussian_filter(samples, 1)
    return np.sqrt(sum(d * d for d in np.gradient(smooth)))


def scans():
    """Yields name, samples, affine, isovalue, which no sample has."""
    unit, inia = np.eye(4), np.diag([0.5, 0.5, 0.5, 1])
    ch2, better, bet, monkey = (template(n) for n in ("ch2", "ch2better", "ch2bet",
                                                      "inia19-t1-brain"))
    yield "face", ch2[:, 110:, :100], unit, 60.5
    yield "scalp", ch2[20:140, :100, 60:], unit, 40.5
    yield "fine", better[100:260, 120:300, 120:260], np.diag([0.5, 0.5, 0.5, 1]), 100.5
    yield "sulci", better[180:330, 200:360, 150:300], np.diag([0.5, 0.5, 0.5, 1]), 80.5
    yield "monkey", monkey, inia, 100.5
    yield "monkeyDeep", monkey[40:160, 60:200, 20:120], inia, 80.5
    yield "thick", bet[:, :, ::3], np.diag([1, 1, 3, 1]), 90.5
    yield "thickRows", ndimage.uniform_filter1d(ch2, 2, axis=1)[:, ::2], np.diag([1, 2, 1, 1]), 80.25
    yield "turned", turned(bet), unit, 90.5
    yield "smooth", ndimage.gaussian_filter(bet, 1.5), unit, 70.5
    yield "noisy", noisy(bet[20:160, 30:190, 20:150], 4), unit, 90.5
    yield "edges", slope(bet[20:160, 30:190, 20:150]), unit, 12.5
    example = nibabel.load(NIBABEL / "example4d.nii.gz")
    yield "oblique", np.asarray(example.dataobj[..., 0], dtype=np.float32), example.affine, 300.5


def write(folder):
    """Returns a list of (name, file, isovalue)."""
    made = []
    for name, samples, affine, isovalue in scans():
        path = folder / f"{name}.nii"
        nibabel.Nifti1Image(np.ascontiguousarray(samples, dtype=np.float32), affine).to_filename(path)
        made.append((name, path, isovalue))
    return made
