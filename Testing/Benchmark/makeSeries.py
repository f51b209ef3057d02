#!/usr/bin/python3
"""makeSeries.py FOLDER [SLICES [SIDE]]: writes a CT-like DICOM series, for compareReading.

SLICES (300) files of SIDE x SIDE (512) int16 voxels, explicit little endian, 0.7 x 0.7 x 1 mm: a ball of
soft tissue in air with scanner noise, from a fixed seed.
"""

import array
import os
import random
import struct
import sys


def element(group, number, kind, value):
    if len(value) % 2:
        value += b"\0" if kind == b"UI" else b" "
    if kind == b"OW":
        return struct.pack("<HH2sHI", group, number, kind, 0, len(value)) + value
    return struct.pack("<HH2sH", group, number, kind, len(value)) + value


def slice_file(k, side, pixels):
    ct = b"1.2.840.10008.5.1.4.1.1.2"
    instance = b"1.2.826.0.1.3680043.2.1125.%d" % (k + 1)
    meta = (element(2, 2, b"UI", ct) + element(2, 3, b"UI", instance) +
            element(2, 0x10, b"UI", b"1.2.840.10008.1.2.1"))
    return (b"\0" * 128 + b"DICM" + element(2, 0, b"UL", struct.pack("<I", len(meta))) + meta +
            element(8, 0x16, b"UI", ct) + element(8, 0x18, b"UI", instance) +
            element(8, 0x60, b"CS", b"CT") +
            element(0x20, 0xD, b"UI", b"1.2.826.0.1.3680043.2.1125.1.1") +
            element(0x20, 0xE, b"UI", b"1.2.826.0.1.3680043.2.1125.1.2") +
            element(0x20, 0x13, b"IS", b"%d" % (k + 1)) +
            element(0x20, 0x32, b"DS", b"-180\\-180\\%d" % k) +
            element(0x20, 0x37, b"DS", b"1\\0\\0\\0\\1\\0") +
            element(0x28, 2, b"US", struct.pack("<H", 1)) +
            element(0x28, 4, b"CS", b"MONOCHROME2") +
            element(0x28, 0x10, b"US", struct.pack("<H", side)) +
            element(0x28, 0x11, b"US", struct.pack("<H", side)) +
            element(0x28, 0x30, b"DS", b"0.7\\0.7") +
            element(0x28, 0x100, b"US", struct.pack("<H", 16)) +
            element(0x28, 0x101, b"US", struct.pack("<H", 16)) +
            element(0x28, 0x102, b"US", struct.pack("<H", 15)) +
            element(0x28, 0x103, b"US", struct.pack("<H", 1)) +
            element(0x28, 0x1052, b"DS", b"0") + element(0x28, 0x1053, b"DS", b"1") +
            element(0x7FE0, 0x10, b"OW", pixels))


def main():
    folder = sys.argv[1]
    slices = int(sys.argv[2]) if len(sys.argv) > 2 else 300
    side = int(sys.argv[3]) if len(sys.argv) > 3 else 512
    os.makedirs(folder, exist_ok=True)
    dice = random.Random(1)
    noise = array.array("h", (dice.randrange(-20, 20) for _ in range(2 * side)))
    middle, radius = (side - 1) / 2, 0.4 * side
    for k in range(slices):
        height = (k - (slices - 1) / 2) * side / slices
        pixels = array.array("h")
        for j in range(side):
            rest = radius ** 2 - height ** 2 - (j - middle) ** 2
            half = int(rest ** 0.5) if rest > 0 else 0
            at = dice.randrange(side)
            row = array.array("h", (value - 1000 for value in noise[at:at + side]))
            begin, end = side // 2 - half, side // 2 + half
            row[begin:end] = array.array("h", (value + 40 for value in noise[at:at + 2 * half]))
            pixels.extend(row)
        with open(os.path.join(folder, f"{k:04}.dcm"), "wb") as file:
            file.write(slice_file(k, side, pixels.tobytes()))


if __name__ == "__main__":
    main()
