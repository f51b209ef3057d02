"""Draws the figures of Algorithm.md, as SVG files beside it.

    algorithmFigures.py           writes them
    algorithmFigures.py --check   exits with 1 and a line for each that is not as it would be written

The surface is drawn as the line in which a plane cuts it. Lines are made as the program makes surfaces:
crossings of lattice edges by interpolation, then as few of them as keep all others within a distance.
Python's standard library only.
"""

import math
import sys
from pathlib import Path

FULL, SIMPLE, WALL, GRID, BAD, GOOD = "#1f4e79", "#c55a11", "#222222", "#d5d5d5", "#c00000", "#548235"
FONT = 'font-family="DejaVu Sans, Helvetica, sans-serif"'


class Picture:
    """SVG elements, in pixels, y downward."""

    def __init__(self, width, height, title):
        self.width, self.height = width, height
        self.parts = [f"<title>{title}</title>",
                      f'<rect width="{width}" height="{height}" fill="white"/>']

    @staticmethod
    def _points(points):
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)

    def line(self, points, colour, width=1.5, dash=None, closed=False, fill="none", opacity=1):
        extra = f' stroke-dasharray="{dash}"' if dash else ""
        extra += f' opacity="{opacity}"' if opacity != 1 else ""
        self.parts.append(f'<{"polygon" if closed else "polyline"} points="{self._points(points)}" fill="{fill}" '
                          f'stroke="{colour}" stroke-width="{width}" stroke-linejoin="round" '
                          f'stroke-linecap="round"{extra}/>')

    def area(self, points, colour, opacity=1.0):
        self.parts.append(f'<polygon points="{self._points(points)}" fill="{colour}" opacity="{opacity}"/>')

    def dot(self, point, colour, radius=3.0, fill=None):
        self.parts.append(f'<circle cx="{point[0]:.1f}" cy="{point[1]:.1f}" r="{radius}" fill="{fill or colour}" '
                          f'stroke="{colour}" stroke-width="1.2"/>')

    def arrow(self, start, end, colour, width=1.5):
        self.line([start, end], colour, width)
        angle = math.atan2(end[1] - start[1], end[0] - start[0])
        tips = [(end[0] - 7 * math.cos(angle + s), end[1] - 7 * math.sin(angle + s)) for s in (-0.4, 0.4)]
        self.area([end, *tips], colour)

    def text(self, x, y, words, size=13, colour="#222222", anchor="middle", weight="normal"):
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" {FONT} font-size="{size}" fill="{colour}" '
                          f'text-anchor="{anchor}" font-weight="{weight}">{words}</text>')

    def svg(self):
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" height="{self.height}" '
                f'viewBox="0 0 {self.width} {self.height}">')
        return "\n".join([head, *self.parts, "</svg>", ""])


def depth(x, y):
    """Inside above 0: a blob with a bay, in cells."""
    angle = math.atan2(y - 8.2, x - 8.1)
    radius = 5.4 + 0.9 * math.sin(3 * angle + 0.4) + 0.35 * math.sin(7 * angle)
    return radius - math.hypot(x - 8.1, y - 8.2)


def crossings(cells):
    """The full-resolution line: crossings of the lattice's edges, in order around the blob."""
    found = []
    for i in range(cells + 1):
        for j in range(cells + 1):
            for di, dj in ((1, 0), (0, 1)):
                a, b = depth(i, j), depth(i + di, j + dj)
                if (a >= 0) != (b >= 0):
                    part = a / (a - b)
                    found.append((i + part * di, j + part * dj))
    return sorted(found, key=lambda p: math.atan2(p[1] - 8.2, p[0] - 8.1))


def distance(p, a, b):
    """From a point to a segment."""
    ex, ey = b[0] - a[0], b[1] - a[1]
    part = ((p[0] - a[0]) * ex + (p[1] - a[1]) * ey) / (ex * ex + ey * ey)
    part = min(1, max(0, part))
    return math.hypot(p[0] - a[0] - part * ex, p[1] - a[1] - part * ey)


def simplified(line, allowed, stays):
    """Few of a closed line's points, those that must stay among them, and all within a distance."""
    first = next(i for i, p in enumerate(line) if stays(p))
    line = line[first:] + line[:first + 1]
    kept, at = [line[0]], 0
    while at < len(line) - 1:
        end = at + 1
        while end < len(line) - 1 and not stays(line[end]) and all(
                distance(p, line[at], line[end + 1]) <= allowed for p in line[at + 1:end + 1]):
            end += 1
        kept.append(line[end])
        at = end
    return kept[:-1]


def on_wall(p, side, shift=0):
    return any(abs((c - shift) / side - round((c - shift) / side)) < 1e-6 for c in p)


def lattice(picture, place, cells, side=None, shift=0, colour=WALL):
    for i in range(cells + 1):
        picture.line([place((i, 0)), place((i, cells))], GRID, 0.7)
        picture.line([place((0, i)), place((cells, i))], GRID, 0.7)
    at = shift
    while side and at <= cells:
        if at >= 0:
            picture.line([place((at, 0)), place((at, cells))], colour, 2)
            picture.line([place((0, at)), place((cells, at))], colour, 2)
        at += side


def bricks():
    """Two panels: the full line in four bricks, and what is left after each was simplified alone."""
    cells, side, scale = 16, 8, 19
    picture = Picture(700, 395, "Bricks: the full-resolution surface, and each brick simplified alone")
    line = crossings(cells)
    for left, words in ((20, "full resolution, brick by brick"), (376, "each brick simplified alone")):
        def place(p, left=left):
            return left + scale * p[0], 20 + scale * (cells - p[1])
        lattice(picture, place, cells, side)
        shown = line if left == 20 else simplified(line, 0.2, lambda p: on_wall(p, side))
        picture.line([place(p) for p in shown], FULL if left == 20 else SIMPLE, 2, closed=True)
        for p in shown:
            isFixed = on_wall(p, side)
            picture.dot(place(p), BAD if isFixed else FULL if left == 20 else SIMPLE, 3.6 if isFixed else 2.4)
        picture.text(left + scale * cells / 2, 346, words)
    picture.dot((150, 372), BAD, 3.6)
    picture.text(160, 376, "vertex on a wall: stays in this round, so that the bricks still fit together",
                 12, anchor="start")
    return picture


def ring(centre, radii, turn=0.0):
    n = len(radii)
    return [(centre[0] + r * math.cos(turn + 2 * math.pi * i / n),
             centre[1] + 0.8 * r * math.sin(turn + 2 * math.pi * i / n)) for i, r in enumerate(radii)]


def collapse():
    """A star before and after an edge collapse, with the samples that are handed over."""
    picture = Picture(700, 320, "An edge collapse: the star of the edge before and after")
    samples = [(-52, -50), (-70, 22), (-15, -72), (-12, 64), (58, -50), (66, 30), (-30, -12), (30, -14), (2, 30)]
    for middle, isAfter in (((175, 140), False), ((525, 140), True)):
        around = ring(middle, [130, 118, 128, 122, 135, 116, 130, 120], 0.2)
        a, b = (middle[0] - 42, middle[1] + 4), (middle[0] + 44, middle[1] - 6)
        new = (middle[0] + 3, middle[1] - 2)
        if not isAfter:
            for corner in (around[2], around[6]):
                picture.area([a, b, corner], BAD, 0.16)
        picture.line(around, FULL, 1.8, closed=True)
        for i, corner in enumerate(around):
            for end in ([new] if isAfter else [a] if i in (3, 4, 5) else [b] if i in (0, 1, 7) else [a, b]):
                picture.line([end, corner], FULL, 1.4)
        if isAfter:
            picture.dot(new, SIMPLE, 5)
        else:
            picture.line([a, b], BAD, 3.2)
            picture.dot(a, FULL, 4)
            picture.dot(b, FULL, 4)
        for x, y in samples:
            picture.dot((middle[0] + x, middle[1] + y), GOOD, 2.2)
        picture.text(middle[0], 278, "after: one vertex, where the quadric is least" if isAfter
                     else "before: the edge, and the two triangles that go")
    picture.arrow((325, 140), (372, 140), WALL, 2)
    picture.dot((190, 303), GOOD, 2.6)
    picture.text(200, 307, "sample of the full-resolution surface, handed to its near triangle", 12, anchor="start")
    return picture


def bound():
    """The bound seen from both sides, and why one side is not enough."""
    picture = Picture(700, 330, "The bound holds from each surface to the other")
    d = 20

    def full(x):  # a narrow bump
        return 92 - 10 * math.sin(x / 50) - 74 * math.exp(-((x - 215) / 13) ** 2)
    line = [(x, full(x)) for x in range(10, 311, 3)]
    flat = [(10.0, full(10)), (90.0, full(90)), (165.0, full(150) + 2), (255.0, full(270)), (310.0, full(310))]
    for left, near, far, isFirst in ((15, line, flat, True), (360, flat, line, False)):
        def move(points, left=left):
            return [(left + x, 60 + y) for x, y in points]
        picture.line(move(near), FULL if isFirst else SIMPLE, 2 * d, opacity=0.15)
        picture.line(move(line), FULL, 2)
        picture.line(move(flat), SIMPLE, 2)
        for p in move(flat):
            picture.dot(p, SIMPLE, 3)
        if isFirst:
            picture.text(left + 160, 250, "within d of the full surface:")
            picture.text(left + 160, 268, "holds for every point of the simplified one")
        else:
            top = move([(215, full(215))])[0]
            picture.arrow((top[0], top[1] + 66), (top[0], top[1] + 5), BAD, 2)
            picture.text(left + 160, 250, "within d of the simplified surface:")
            picture.text(left + 160, 268, "the bump leaves the band, and is mended", colour=BAD)
    picture.line([(150, 303), (178, 303)], FULL, 2)
    picture.text(186, 307, "full resolution", 12, anchor="start")
    picture.line([(330, 303), (358, 303)], SIMPLE, 2)
    picture.text(366, 307, "simplified", 12, anchor="start")
    picture.area([(480, 296), (508, 296), (508, 310), (480, 310)], WALL, 0.15)
    picture.text(516, 307, "all points within d", 12, anchor="start")
    return picture


def mending():
    """A place beyond the bound: in a triangle, beside an edge, beside a vertex."""
    picture = Picture(700, 405, "Mending a place beyond the bound: split a triangle, split an edge, move a vertex")
    for column, words in enumerate(("within a triangle: split it in three", "beside an edge: split both triangles",
                                    "beside a vertex: move it")):
        for row, isAfter in enumerate((False, True)):
            x, y = 125 + 225 * column, 95 + 180 * row
            corners = [(x - 85, y + 55), (x + 80, y + 62), (x - 5, y - 72)]
            below = (x + 12, y + 62)
            if column == 0:
                place, shapes = (x - 4, y + 12), [corners]
                parts = [[corners[i], corners[(i + 1) % 3], place] for i in range(3)]
            elif column == 1:
                left, right, top, low = (x - 85, y), (x + 85, y + 6), (x - 8, y - 72), (x + 6, y + 70)
                place, shapes = (x + 4, y), [[left, right, top], [left, right, low]]
                parts = [[left, place, top], [place, right, top], [left, place, low], [place, right, low]]
            else:
                around, centre = ring((x, y - 2), [85, 76, 84, 78, 82, 74], 0.3), (x - 10, y + 6)
                place = (x + 10, y - 12)
                shapes = [[centre, around[i], around[(i + 1) % 6]] for i in range(6)]
                parts = [[place, around[i], around[(i + 1) % 6]] for i in range(6)]
            for shape in (parts if isAfter else shapes):
                picture.line(shape, FULL, 1.6, closed=True, fill="#eef3f8")
            if isAfter:
                picture.dot(place, SIMPLE, 4.5)
            else:
                picture.dot(place, BAD, 4.5, fill="white")
        picture.text(125 + 225 * column, 372, words, 12)
    picture.dot((150, 392), BAD, 4, fill="white")
    picture.text(160, 396, "place beyond the bound", 12, anchor="start")
    picture.dot((360, 392), SIMPLE, 4)
    picture.text(370, 396, "vertex on the full-resolution surface", 12, anchor="start")
    return picture


def rounds():
    """Three cuts: what straddles one lies within the next."""
    cells, scale = 16, 12.8
    picture = Picture(700, 300, "Rounds: cubes shifted by half a side, then twice as large")
    line = crossings(cells)
    for left, side, shift, allowed, words in ((15, 8, 0, 0.1, "bricks"), (247, 8, 4, 0.2, "shifted by half a side"),
                                              (479, 16, -6, 0.45, "later: twice as large")):
        def place(p, left=left):
            return left + scale * p[0], 15 + scale * (cells - p[1])
        lattice(picture, place, cells, side, shift)

        def cube(p, side=side, shift=shift):
            return tuple(math.floor((c - shift) / side) for c in p)
        stays = {p for i, p in enumerate(line)
                 if on_wall(p, side, shift) or not cube(line[i - 1]) == cube(p) == cube(line[(i + 1) % len(line)])}
        if shift == 0:  # bricks are meshed up to their walls: nothing straddles
            stays = {p for p in line if on_wall(p, side)}
        line = simplified(line, allowed, stays.__contains__)
        for i, p in enumerate(line):
            q = line[(i + 1) % len(line)]
            straddles = shift != 0 and cube(p) != cube(q)
            picture.line([place(p), place(q)], BAD if straddles else SIMPLE, 3 if straddles else 2)
            isFixed = shift == 0 and p in stays
            picture.dot(place(p), BAD if isFixed else SIMPLE, 3.4 if isFixed else 2.2)
        picture.text(left + scale * cells / 2, 242, words)
    picture.line([(130, 272), (158, 272)], BAD, 3)
    picture.dot((144, 272), BAD, 3.4)
    picture.text(168, 276, "straddles two cubes, or lies on a brick's wall: stays as it is in this round", 12,
                 anchor="start")
    return picture


FIGURES = {"adaptiveBricks": bricks, "adaptiveCollapse": collapse, "adaptiveBound": bound,
           "adaptiveMending": mending, "adaptiveRounds": rounds}


def main():
    folder = Path(__file__).resolve().parent
    stale = []
    for name, draw in FIGURES.items():
        path, svg = folder / f"{name}.svg", draw().svg()
        if sys.argv[1:] != ["--check"]:
            path.write_text(svg, encoding="utf-8")
        elif not path.exists() or path.read_text(encoding="utf-8") != svg:
            stale.append(f"{path}: is not what algorithmFigures.py draws; run it")
    print("\n".join(stale), end="\n" if stale else "")
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main())
