"""A head model of three spheres, and the defects planted in it that a checker must find.

A mesh is a pair of lists: points (mm) and triangles, counter-clockwise seen from outside. A model is
three meshes, the innermost first. Python's standard library only."""

import math

RADII = (80, 86, 92)
NAN = float("nan")


def normalized(p):
    length = math.sqrt(sum(x * x for x in p))
    return tuple(x / length for x in p)


def scaled(p, by):
    return tuple(by * x for x in p)


def cube(low, high):
    """Closed, outward, between two corners."""
    points = [tuple((high if n >> axis & 1 else low)[axis] for axis in range(3)) for n in range(8)]
    return points, [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4),
                    (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]


def icosphere(radius, subdivisions=3, centre=(0, 0, 0)):
    """20 * 4^subdivisions triangles; 642 vertices by default."""
    g = (1 + math.sqrt(5)) / 2
    points = [normalized(p) for p in (
        (-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
        (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1))]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
                 (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
                 (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(subdivisions):
        middles = {}

        def middle(a, b):
            key = min(a, b), max(a, b)
            if key not in middles:
                middles[key] = len(points)
                points.append(normalized([x + y for x, y in zip(points[a], points[b])]))
            return middles[key]

        finer = []
        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = finer
    return [tuple(radius * x + c for x, c in zip(p, centre)) for p in points], triangles


def good():
    return [icosphere(radius) for radius in RADII]


def moved(mesh, vertex, to):
    points, triangles = mesh
    return points[:vertex] + [tuple(to)] + points[vertex + 1:], triangles


def pushed(mesh, vertex, radius):
    """The vertex moved along its radius."""
    return moved(mesh, vertex, scaled(normalized(mesh[0][vertex]), radius))


def resized(mesh, by):
    points, triangles = mesh
    return [scaled(p, by) for p in points], triangles


def flipped(mesh):
    points, triangles = mesh
    return points, [(a, c, b) for a, b, c in triangles]


def dented(mesh, radius):
    """The first triangle with its middle pushed in to `radius`: a narrow pit of three triangles."""
    points, ((a, b, c), *others) = mesh
    middle = normalized([sum(points[v][axis] for v in (a, b, c)) for axis in range(3)])
    pit = len(points)
    return (points + [scaled(middle, radius)],
            [(a, b, pit), (b, c, pit), (c, a, pit), *others])


def soup(mesh):
    points, triangles = mesh
    corners = [points[v] for t in triangles for v in t]
    return corners, [(n, n + 1, n + 2) for n in range(0, len(corners), 3)]


def direction(mesh, triangle):
    points, triangles = mesh
    return normalized([sum(points[v][axis] for v in triangles[triangle]) for axis in range(3)])


def cosine(a, b):
    return sum(x * y for x, y in zip(a, b))


def with_handle(mesh):
    """A tunnel through the inside between two triangles some 60 degrees apart: genus 1."""
    points, triangles = mesh
    first, start = triangles[0], direction(mesh, 0)
    other = min(range(len(triangles)),
                key=lambda n: abs(cosine(start, direction(mesh, n)) - 0.5))
    d, e, f = triangles[other]

    def length(turned):
        return sum(math.dist(points[u], points[v]) for u, v in zip(first, turned))

    ends = min(((d, f, e), (f, e, d), (e, d, f)), key=length)  # the other way round
    wall = []
    for n in range(3):
        a, b = first[n], first[(n + 1) % 3]
        p, q = ends[n], ends[(n + 1) % 3]
        wall += [(a, b, q), (a, q, p)]
    return points, [t for n, t in enumerate(triangles) if n not in (0, other)] + wall


def with_collapsed_vertex(mesh):
    """A vertex moved onto a neighbour: the two triangles at their edge have no area."""
    points, triangles = mesh
    a, b, _ = triangles[0]
    return moved(mesh, a, points[b])


def with_second_component(mesh):
    points, triangles = mesh
    small, more = icosphere(3, 1, (30, 0, 0))
    count = len(points)
    return points + small, triangles + [tuple(v + count for v in t) for t in more]


def with_spike(mesh):
    """A vertex pulled out through the far side, 120 degrees away, past the centre."""
    points, triangles = mesh
    start = normalized(points[0])
    far = min(range(len(triangles)), key=lambda n: abs(cosine(start, direction(mesh, n)) + 0.5))
    return moved(mesh, 0, scaled(direction(mesh, far), 82))


def change_inner(change):
    def apply(model):
        return [change(model[0]), *model[1:]]
    return apply


def change_all(change):
    return lambda model: [change(mesh) for mesh in model]


def add_vertex(mesh):
    return mesh[0] + [(10, 0, 0)], mesh[1]


def add_repeated_index(mesh):
    a, b, _ = mesh[1][0]
    return mesh[0], mesh[1] + [(a, a, b)]


# Name of the defect -> what makes it of a good model.
DEFECTS = {
    "an inner vertex pokes out": change_inner(lambda m: pushed(m, 0, 88)),
    "a narrow dent of the outer surface goes through an inner face":
        lambda model: [model[0], dented(model[1], 78), model[2]],
    "a hole": change_inner(lambda m: (m[0], m[1][1:])),
    "all triangles are flipped": change_all(flipped),
    "one triangle is flipped":
        change_inner(lambda m: (m[0], [(m[1][0][0], m[1][0][2], m[1][0][1])] + m[1][1:])),
    "inner and outer are swapped": lambda model: model[::-1],
    "all in metres": change_all(lambda m: resized(m, 0.001)),
    "the inner surface in metres": change_inner(lambda m: resized(m, 0.001)),
    "all in micrometres": change_all(lambda m: resized(m, 1000)),
    "an isolated vertex": change_inner(add_vertex),
    "a triangle soup": change_inner(soup),
    "a gap of 0.05 mm": change_inner(lambda m: pushed(m, 0, 85.95)),
    "a triangle names a vertex twice": change_inner(add_repeated_index),
    "two triangles without area, of a collapsed vertex": change_inner(with_collapsed_vertex),
    "a handle": change_inner(with_handle),
    "a spike crosses its own surface": change_inner(with_spike),
    "a second closed component": change_inner(with_second_component),
    "the inner surface is 300 mm away":
        change_inner(lambda m: ([(x + 300, y, z) for x, y, z in m[0]], m[1])),
    "a coordinate is NaN": change_inner(lambda m: moved(m, 5, (NAN, 0, 0))),
}


def write_off(path, mesh, frame="RAS mm"):
    """`frame`: as adaptiso's files say it; None: the file does not say."""
    points, triangles = mesh
    marker = f"# CoordinateFrame: {frame}\n" if frame else ""
    with open(path, "w", encoding="ascii") as file:
        file.write(f"OFF\n{marker}{len(points)} {len(triangles)} 0\n")
        file.writelines("%.17g %.17g %.17g\n" % tuple(p) for p in points)
        file.writelines("3 %d %d %d\n" % tuple(t) for t in triangles)
