"""Makes the pictures of README.md and Gallery.md: the commands of the page draw those of single surfaces, this script the others.

    draw.py BIN             runs the commands with the programs in BIN and writes the pictures anew
    draw.py BIN --check     compares instead: exits with 1 and a line for each picture that differs

A picture's ground is transparent, so that it stands on a light and on a dark page. Needs NumPy and PIL
(Debian: python3-numpy, python3-pil, fonts-dejavu-core), the scans of mricron-data, and no display.
"""

import argparse
import base64
import os
import re
import subprocess
import tempfile
import zlib
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

HERE = Path(__file__).resolve().parent
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans{}.ttf"
SAMPLES = 3  # drawn this many times as large, then averaged
GREY = (125, 133, 144, 255)  # text: readable on white and on black
BONE, SKIN, BLUE = (226, 205, 190), (222, 178, 150), (112, 152, 205)
LEFT = (-75, 18)  # degrees: around the z axis, above the ground
TOLERANCE = 2.0  # mean difference of a byte: fonts and PIL's rounding differ between releases, shapes do not
TILE = 32  # pixels; a changed digit is ten times that in its tile


def read_vtp(path):
    """{name: array} of a VTK XML file of adaptiso: blocks of zlib, in base64."""
    head, _, body = path.read_bytes().partition(b'<AppendedData encoding="base64">')
    body = body[body.index(b"_") + 1:]
    kinds = {"Float64": "<f8", "UInt8": "u1", "Int64": "<i8", "Float32": "<f4", "Int32": "<i4"}
    arrays = {}
    for kind, name, offset in re.findall(r'<DataArray type="(\w+)" Name="(\w+)".*? offset="(\d+)"', head.decode()):
        at = int(offset)
        blocks = np.frombuffer(base64.b64decode(body[at:at + 12])[:8], "<u8")[0]
        length = 4 * -(-8 * (3 + int(blocks)) // 3)
        sizes = np.frombuffer(base64.b64decode(body[at:at + length]), "<u8")[3:]
        packed = base64.b64decode(body[at + length:at + length + 4 * -(-int(sizes.sum()) // 3)])
        ends = np.cumsum(sizes).astype(int)
        arrays[name] = np.frombuffer(b"".join(zlib.decompress(packed[end - int(size):end])
                                              for end, size in zip(ends, sizes)), kinds[kind])
    return arrays


def read_surface(path):
    """(points, normals or None, triangles), RAS mm, of a .vtp or a FreeSurfer surface."""
    if path.suffix == ".surf":
        body = path.read_bytes().split(b"\n", 2)[2]
        points, triangles = np.frombuffer(body, ">i4", 2)
        return (np.frombuffer(body, ">f4", 3 * points, 8).reshape(-1, 3).astype(float), None,
                np.frombuffer(body, ">i4", 3 * triangles, 8 + 12 * points).reshape(-1, 3))
    arrays = read_vtp(path)
    return (*(arrays[name].reshape(-1, 3).astype(float) for name in ("Points", "Normals")),
            arrays["connectivity"].reshape(-1, 3))


class Scene:
    """Triangles, of one or several surfaces, to draw at once."""

    def __init__(self, view, layered=False):
        """\\param view     degrees: around the z axis, above the ground
        \\param layered  draw each surface over those added before it"""
        around, above = np.radians(view)
        toViewer = np.array([np.cos(above) * np.sin(around), -np.cos(above) * np.cos(around), np.sin(above)])
        right = np.cross((0, 0, 1), toViewer)
        right /= np.linalg.norm(right)
        self.axes = np.stack([right, -np.cross(toViewer, right), toViewer], 1)  # screen x, screen y down, to the viewer
        self.layered, self.corners, self.colours = layered, [], []

    def add(self, path, colour, keep=None):
        """\\param keep  of corners (n, 3, 3) in RAS mm: which triangles to draw (default: all)"""
        points, normals, triangles = read_surface(path)
        corners = points[triangles]
        flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        facing = normals[triangles].mean(1) if normals is not None else flat
        facing /= np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-12)
        base = np.broadcast_to(colour, (len(triangles), 3))
        shown = np.ones(len(triangles), bool) if keep is None else keep(corners)
        if keep is None:
            shown &= flat @ self.axes[:, 2] > 0
        light = facing @ self.axes
        light[light[:, 2] < 0] *= -1  # the inner side of a surface that is cut open
        bright = 0.38 + 0.55 * np.clip(light @ np.array([-0.35, -0.5, 0.79]), 0, 1) + 0.09 * light[:, 2]
        shine = 16 * np.clip(light @ np.array([-0.2, -0.3, 0.93]), 0, 1)[:, None] ** 24
        self.corners.append((corners @ self.axes)[shown])
        self.colours.append(np.clip(base * bright[:, None] + shine, 0, 255)[shown].astype(np.uint8))
        return self

    def extent(self):
        points = np.concatenate(self.corners).reshape(-1, 3)[:, :2]
        return points.min(0), points.max(0)

    def draw(self, size, low, high, edges=None):
        """An RGBA picture of `size` pixels of what lies between two corners in mm on the screen."""
        corners, colours = np.concatenate(self.corners), np.concatenate(self.colours)
        scale = SAMPLES * min(size[0] / (high[0] - low[0]), size[1] / (high[1] - low[1]))
        shift = np.array(size) * SAMPLES / 2 - scale * (np.array(low) + high) / 2
        flat = corners[:, :, :2] * scale + shift
        seen = ((flat.max(1) >= 0) & (flat.min(1) <= np.array(size) * SAMPLES)).all(1)
        layer = np.repeat(np.arange(len(self.corners)), [len(part) for part in self.corners]) \
            if self.layered else np.zeros(len(corners))
        order = np.lexsort((corners[seen][:, :, 2].mean(1), layer[seen]))
        image = Image.new("RGBA", (size[0] * SAMPLES, size[1] * SAMPLES))
        pen = ImageDraw.Draw(image)
        for triangle, colour in zip(flat[seen][order].reshape(-1, 6).tolist(), colours[seen][order].tolist()):
            pen.polygon(triangle, fill=(*colour, 255), outline=None if edges else (*colour, 255))
            if edges:
                pen.line([*triangle, *triangle[:2]], fill=edges, width=2)
        return image.resize(size, Image.LANCZOS)


def whole(scene):
    low, high = scene.extent()
    margin = 0.02 * (high - low)
    return scene.draw((840, 720), low - margin, high + margin)


def text(image, at, words, size, bold=False, fill=GREY):
    font = ImageFont.truetype(FONT.format("-Bold" if bold else ""), size)
    ImageDraw.Draw(image).text(at, words, font=font, fill=fill)


def first_screen(folder):
    """README.md: the brain, and one spot of it at full resolution and within two bounds."""
    meshes = [("full resolution", "", folder / "brain-full.vtp", (214, 214, 214)),
              ("adaptive", "within 0.15 mm (proved)", folder / "brain.vtp", BONE),
              ("adaptive", "within 0.5 mm (proved)", folder / "brain-half.vtp", BONE)]
    image = Image.new("RGBA", (1200, 384))
    brain = Scene(LEFT).add(meshes[1][2], BONE)
    low, high = brain.extent()
    image.alpha_composite(brain.draw((420, 360), low - 1, high + 1), (0, 8))
    scale = min(420 / (high[0] - low[0] + 2), 360 / (high[1] - low[1] + 2))
    middle, half = (low + high) / 2 + np.array([-12, -22]), 11
    at = np.array([210, 188]) + scale * (middle - (low + high) / 2)
    pen = ImageDraw.Draw(image)
    pen.rectangle([*(at - half * scale), *(at + half * scale)], outline=(200, 60, 40, 255), width=3)
    for index, (name, bound, path, colour) in enumerate(meshes):
        left = 436 + 256 * index
        spot = Scene(LEFT).add(path, colour).draw((250, 250), middle - half, middle + half, (40, 50, 70, 255))
        image.alpha_composite(spot, (left, 12))
        pen.rectangle([left, 12, left + 249, 261], outline=(200, 60, 40, 255), width=2)
        text(image, (left, 270), f"{len(read_surface(path)[2]):,}", 26, bold=True)
        text(image, (left, 304), "triangles, " + name, 16)
        text(image, (left, 328), bound or "marching cubes, every voxel", 16)
    return image


def cut(corners):
    return corners[:, :, 0].mean(1) < 0


def head_model(folder):
    scene = Scene((75, 18), layered=True)
    for name, colour in (("outer_skin", SKIN), ("outer_skull", (235, 230, 215)), ("inner_skull", BLUE)):
        scene.add(folder / f"model/{name}.surf", colour, cut)
    return scene


SEEN = ("brain", "brain-full", "brain-half", "brain-light", "boxes", "white-matter", "head", "distance", "labels")
DRAWN = {"first-screen": first_screen, "model": lambda folder: whole(head_model(folder)),
         **{name: lambda folder, name=name: Image.open(folder / name / "view-1.png") for name in SEEN}}


def commands(page):
    return "".join(re.findall(r"(?ms)^```sh\n(.*?)^```$", page.read_text(encoding="utf-8")))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin", type=Path)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    faults = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        subprocess.run(["bash", "-euc", commands(HERE.parent / "Gallery.md")], cwd=folder, check=True,
                       env={**os.environ, "PATH": f"{given.bin.resolve()}:/usr/bin:/bin"}, stdout=subprocess.DEVNULL)
        for name, draw in DRAWN.items():
            path = HERE / f"{name}.png"
            colours = 32 if name in ("boxes", "brain-half") else 128  # lines everywhere: the file would be large
            image = draw(folder).quantize(colours, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
            if not given.check:
                image.save(path, optimize=True)
                continue
            there, made = (np.asarray(each.convert("RGBA"), float) for each in (Image.open(path), image))
            if there.shape != made.shape:
                faults.append(f"{path.name}: has another size")
                continue
            off = np.abs(there - made).mean(2)
            tiles = [off[y:y + TILE, x:x + TILE].mean() for y in range(0, off.shape[0], TILE)
                     for x in range(0, off.shape[1], TILE)]
            if not (off.mean() <= TOLERANCE and max(tiles) <= 10 * TOLERANCE):
                faults.append(f"{path.name}: differs by {off.mean():.1f} of 255 in the mean, {max(tiles):.1f} in a tile")
    print("\n".join(faults) or f"{len(DRAWN)} pictures are as they are drawn" if given.check else "drawn")
    return 1 if faults else 0


if __name__ == "__main__":
    raise SystemExit(main())
