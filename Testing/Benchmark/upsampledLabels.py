#!/usr/bin/python3
"""upsampledLabels.py LABELS FILE X Y Z   a label map of X x Y x Z voxels from a smaller one: each voxel belongs to the
region whose membership, interpolated linearly, is the largest (needs python3-scipy and python3-nibabel)."""
import sys

import nibabel as nib
import numpy as np
from scipy.ndimage import find_objects, zoom


def upsampled(labels, size):
    """The region of largest membership, region by region, each within its box."""
    factors = np.array(size) / labels.shape
    largest = np.full(size, 0.5, np.float32)  # background keeps what is less than half a region's
    result = np.zeros(size, labels.dtype)
    for label, box in enumerate(find_objects(labels), 1):
        if box is None:
            continue
        low = np.maximum([side.start - 1 for side in box], 0)
        high = np.minimum([side.stop + 1 for side in box], labels.shape)
        begin, end = np.ceil(low * factors).astype(int), np.floor(high * factors).astype(int)
        part = labels[tuple(map(slice, low, high))] == label
        member = zoom(part.astype(np.float32), (end - begin) / part.shape, order=1, grid_mode=True, mode="nearest")
        place = tuple(map(slice, begin, end))
        wins = member > largest[place]
        largest[place][wins] = member[wins]
        result[place][wins] = label
    return result


def main():
    source, path, *size = sys.argv[1:]
    image = nib.load(source)
    labels = np.asarray(image.dataobj).squeeze()
    size = tuple(map(int, size))
    affine = image.affine @ np.diag([*np.array(labels.shape) / size, 1])
    nib.Nifti1Image(upsampled(labels, size), affine).to_filename(path)


if __name__ == "__main__":
    main()
