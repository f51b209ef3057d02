"""Check adaptiso's claims about one scan by NumPy and SciPy alone; none of adaptiso's code is used.

    adaptiso-mesh brain.nii.gz --iso 100 --method mc -o mc.ply
    adaptiso-mesh brain.nii.gz --iso 100 -o adaptive.ply      (prints the bound: 0.15 mm)
    python3 verify.py brain.nii.gz 100 mc.ply adaptive.ply 0.15

1. mc.ply is a marching cubes surface of the image: a vertex on every edge of the voxel lattice whose ends lie on
   both sides of the isovalue, where linear interpolation meets it (at least 0.001 of the edge from its ends; half
   an edge beyond the image's border); other vertices only inside cells that may hold several surfaces, to join
   their parts; every triangle within one cell; closed.
2. No point of one surface is farther than the bound from the other. A part of a triangle is within d of another
   triangle if its corners are: distance from a convex set is a convex function. Parts that are not shown to be
   near are halved along each edge until they are.
3. adaptive.ply is closed and oriented, and no two triangles of it meet but in the vertices and edges that they
   share. Signs of determinants come from floating point where its error bound decides, else from fractions.

Exit code: 0 all is shown, 1 not. Needs nibabel, NumPy and SciPy.
"""
import sys
from fractions import Fraction
from pathlib import Path

import nibabel
import numpy as np
from scipy.spatial import cKDTree

LEAST_FRACTION = 0.001  # of a lattice edge, from its ends to a vertex
POSITION = 1e-6         # voxels: what rounding may move a vertex by
CHUNK = 400_000


def require(holds, claim):
    if not holds:
        sys.exit(f"NOT shown: {claim}")


def read_ply(path):
    """Points (n, 3) in RAS mm and triangles (m, 3) of a binary little-endian PLY file."""
    types = {"double": "<f8", "float": "<f4", "int": "<i4", "uchar": "u1"}
    header, body = Path(path).read_bytes().split(b"end_header\n", 1)
    lines = [line.split() for line in header.decode().splitlines()]
    counts = {words[1]: int(words[2]) for words in lines if words[0] == "element"}
    fields = [(words[2], types[words[1]]) for words in lines if words[0] == "property" and words[1] != "list"]
    vertices = np.frombuffer(body, np.dtype(fields), counts["vertex"])
    faces = np.frombuffer(body, np.dtype([("n", "u1"), ("v", "<i4", 3)]), counts["face"], vertices.nbytes)
    require((faces["n"] == 3).all() and vertices.nbytes + faces.nbytes == len(body), f"{path} holds triangles alone")
    triangles = faces["v"].astype(np.int64)
    require(((triangles >= 0) & (triangles < len(vertices))).all(), f"{path}: triangles name vertices that exist")
    return np.stack([vertices[axis] for axis in "xyz"], 1), triangles


def require_closed(triangles, points, name):
    """Every edge belongs to two triangles that go along it in opposite directions, every vertex to one fan."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    require((edges[:, 0] != edges[:, 1]).all(), f"{name}: no triangle names a vertex twice")
    codes = edges[:, 0] * len(points) + edges[:, 1]
    order = np.argsort(codes)
    require((np.diff(codes[order]) > 0).all(), f"{name}: no edge is run through twice in one direction (oriented)")
    reverse = edges[:, 1] * len(points) + edges[:, 0]
    twin = order[np.searchsorted(codes[order], reverse).clip(max=len(codes) - 1)]
    require((edges[twin] == edges[:, ::-1]).all(), f"{name}: every edge has two sides (closed)")
    # half-edge h of corner v: the next one around v begins at the twin of the one before h in its triangle
    fan = np.arange(len(edges))
    following = twin[(fan + 2 * len(triangles)) % len(edges)]
    for _ in range(64):  # the smallest half-edge of each fan, by doubling of steps
        smaller = np.minimum(fan, fan[following])
        following, fan = following[following], smaller
    require(len(np.unique(fan)) == len(np.unique(edges[:, 0])) == len(points),
            f"{name}: every vertex is used, by one fan of triangles (manifold)")


def show_marching_cubes(image, isovalue, points, triangles):
    """Claim 1."""
    samples = np.pad(np.asarray(image.dataobj, dtype=float).reshape(image.shape[:3]), 1, constant_values=-np.inf)
    places = nibabel.affines.apply_affine(np.linalg.inv(image.affine), points) + 1  # in the padded image
    whole = np.abs(places - np.rint(places)) < POSITION
    on_edge = whole.sum(1) == 2
    require((on_edge | ~whole.any(1)).all(), "mc: every vertex lies on one lattice edge, or inside a cell")
    cells = np.where(whole, np.rint(places), np.floor(places)).astype(np.int64)
    require((cells >= 0).all() and (cells + ~whole < samples.shape).all(), "mc: every vertex lies within the image")
    low, high = cells - whole, cells  # the cells around a vertex, by their first corners
    require((low[triangles].max(1) <= high[triangles].min(1)).all(), "mc: every triangle lies within one cell")
    inside = samples >= isovalue
    around = sum(inside[tuple((cells[~on_edge] + corner).T)].astype(int) for corner in np.ndindex(2, 2, 2))
    require(((around >= 2) & (around <= 6)).all(), "mc: vertices inside cells are of ambiguous ones")
    axis, first = np.argmin(whole[on_edge], 1), cells[on_edge]
    last = first + np.eye(3, dtype=np.int64)[axis]
    a, b = samples[tuple(first.T)], samples[tuple(last.T)]
    require(((a >= isovalue) != (b >= isovalue)).all(), "mc: the isovalue lies between the ends of each vertex's edge")
    with np.errstate(invalid="ignore"):
        t = np.where(np.isneginf(a) | np.isneginf(b), 0.5, (isovalue - a) / (b - a))
    t = t.clip(LEAST_FRACTION, 1 - LEAST_FRACTION)
    off = np.abs(np.take_along_axis(places[on_edge] - first, axis[:, None], 1)[:, 0] - t)
    require(off.max() < POSITION, "mc: vertices lie where linear interpolation meets the isovalue")
    crossed = sum(np.count_nonzero(np.diff(inside, axis=n)) for n in range(3))
    edges = np.ravel_multi_index(tuple(first.T), samples.shape) * 3 + axis
    require(len(np.unique(edges)) == len(edges) == crossed, "mc: every crossed lattice edge has one vertex")
    require_closed(triangles, points, "mc")


def samples_of(corners, spacing):
    """Points of triangles, and whose: no point of a triangle is farther than 2/3 `spacing` from one of its own."""
    longest = np.linalg.norm(corners - np.roll(corners, 1, 1), axis=2).max(1)
    parts = np.ceil(longest / spacing).astype(int).clip(1)
    places, owners = [], []
    for n in np.unique(parts):  # the centres of n * n parts, whose edges are no longer than `spacing`
        ij = np.argwhere(np.ones((n, n)))
        steps = np.concatenate([ij[ij.sum(1) < n] + 1 / 3, ij[ij.sum(1) < n - 1] + 2 / 3]) / n
        weights = np.column_stack([1 - steps.sum(1), steps])
        which = np.flatnonzero(parts == n)
        places.append(np.einsum("kc,tcx->tkx", weights, corners[which]).reshape(-1, 3))
        owners.append(np.repeat(which, len(weights)))
    return np.concatenate(places), np.concatenate(owners)


def distance(p, corners):
    """Distances (n,) of points (n, 3) from triangles (n, 3, 3), or more by rounding at most."""
    a, b, c = (corners[:, n] for n in range(3))
    best = np.full(len(p), np.inf)
    for q, r in ((a, b), (b, c), (c, a)):
        edge = r - q
        length = np.einsum("nx,nx->n", edge, edge)
        t = np.einsum("nx,nx->n", p - q, edge) / np.where(length > 0, length, 1)
        best = np.minimum(best, np.linalg.norm(p - q - t.clip(0, 1)[:, None] * edge, axis=1))
    normal = np.cross(b - a, c - a)
    size = np.maximum(*(np.einsum("nx,nx->n", x - a, x - a) for x in (b, c)))
    over = (square := np.einsum("nx,nx->n", normal, normal)) > 1e-12 * size**2  # the normal of a needle is not exact
    for q, r in ((a, b), (b, c), (c, a)):  # above the triangle: on the inner side of its three edges
        over &= np.einsum("nx,nx->n", np.cross(normal, r - q), p - q) >= 0
    height = np.abs(np.einsum("nx,nx->n", p - a, normal)) / np.sqrt(np.where(square > 0, square, 1))
    return np.where(over, np.minimum(best, height), best)


def show_near(points, triangles, other_points, other_triangles, bound, name):
    """Claim 2, one way: no point of the first surface is farther than `bound` from the second."""
    other, parts = other_points[other_triangles], points[triangles]
    places, owners = samples_of(other, np.median(np.linalg.norm(other[:, 0] - other[:, 1], axis=1)))
    tree = cKDTree(places)
    for halving in range(30):
        left = []
        for at in range(0, len(parts), CHUNK // 8):
            part = parts[at:at + CHUNK // 8]
            near = owners[tree.query(part.mean(1), min((4, 8, 8, 8)[halving] if halving < 4 else 64, len(places)))[1]]
            best = np.full(len(part), np.inf)
            for n in range(near.shape[1]):
                target = other[near[:, n]]
                best = np.minimum(best, np.max([distance(part[:, c], target) for c in range(3)], 0))
            left.append(part[best > bound - 1e-9])
        parts = np.concatenate(left)
        if len(parts) == 0:
            return
        a, b, c = (parts[:, n] for n in range(3))
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        parts = np.concatenate([np.stack(four, 1) for four in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
        place = parts[0].mean(0).round(2)
        require(len(parts) < 16 * (len(triangles) + len(other)), f"{name} of the other: not near {place} mm RAS")
    sys.exit(f"NOT shown: {name} of the other: not near {place} mm RAS")


def signs(a, b, c, d):
    """Signs of det(b - a, c - a, d - a), exact."""
    u, v, w = (np.ascontiguousarray((x - a).T) for x in (b, c, d))
    det, size = 0.0, 0.0
    for n in range(3):
        one, other = v[n - 2] * w[n - 1], v[n - 1] * w[n - 2]
        det, size = det + u[n] * (one - other), size + np.abs(u[n]) * (np.abs(one) + np.abs(other))
    result = np.sign(det).astype(int)
    for n in np.flatnonzero(np.abs(det) <= 1e-14 * size):  # Shewchuk's bound of the error is 7.8e-16
        p, *others = ([Fraction(float(x)) for x in row[n]] for row in (a, b, c, d))
        (e, f, g), (h, i, j), (k, l, m) = ([x - y for x, y in zip(row, p)] for row in others)
        exact = e * (i * m - j * l) - f * (h * m - j * k) + g * (h * l - i * k)
        result[n] = (exact > 0) - (exact < 0)
    return result


def planar_signs(axis, a, b, c):
    """Signs of the areas of triangles (n, 3) seen along coordinate `axis` (n,), exact."""
    a, b, c = (np.take_along_axis(p, (axis[:, None] + [1, 2, 0]) % 3, 1) * [1, 1, 0] for p in (a, b, c))
    return signs(a, b, c, a + [0, 0, 1])


def meets(p, q, corners):
    """Whether segments (n, 3) have a point in common with triangles (n, 3, 3)."""
    sides = [(corners[:, n], corners[:, (n + 1) % 3]) for n in range(3)]
    above, below = (signs(*(corners[:, n] for n in range(3)), x) for x in (p, q))
    turns = np.array([signs(p, q, r, s) for r, s in sides])
    result = (above * below <= 0) & ~((turns.max(0) > 0) & (turns.min(0) < 0))
    flat = np.flatnonzero((above == 0) & (below == 0))  # in the plane: a line along a side, or the segment, parts them
    if len(flat) > 0:
        p, q, corners = p[flat], q[flat], corners[flat]
        axis = np.abs(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])).argmax(1)
        a, b, c = (corners[:, n] for n in range(3))
        around = planar_signs(axis, a, b, c)
        outside = [np.maximum(*(around * planar_signs(axis, r, s, x) for x in (p, q))) < 0
                   for r, s in ((a, b), (b, c), (c, a))]
        along = np.array([planar_signs(axis, p, q, x) for x in (a, b, c)])
        result[flat] = ~(np.any(outside, 0) | (along.min(0) > 0) | (along.max(0) < 0))
    return result


def show_no_crossing(points, triangles):
    """Claim 3, but for what require_closed() shows."""
    corners = points[triangles]
    axis = np.abs(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])).argmax(1)
    require((planar_signs(axis, *(corners[:, n] for n in range(3))) != 0).all(), "adaptive: every triangle has an area")
    spacing = np.median(np.linalg.norm(corners - np.roll(corners, 1, 1), axis=2))
    places, owners = samples_of(corners, spacing)
    pairs = owners[cKDTree(places).query_pairs(4 / 3 * spacing * (1 + 1e-9), output_type="ndarray")]
    pairs = np.unique(np.sort(pairs[pairs[:, 0] != pairs[:, 1]], 1), axis=0)
    pairs = pairs[(corners.min(1)[pairs] <= corners.max(1)[pairs[:, ::-1]]).all((1, 2))]  # boxes that meet
    for at in range(0, len(pairs), CHUNK):
        a, b = pairs[at:at + CHUNK].T
        for _ in range(2):  # apart: the corners of one, but shared ones, lie on one side of the other's plane
            shared = (triangles[a][:, :, None] == triangles[b][:, None, :]).any(2)
            side = np.zeros((len(a), 3), int)
            pair, corner = np.nonzero(~shared)
            side[pair, corner] = signs(*corners[b[pair]].transpose(1, 0, 2), corners[a[pair], corner])
            apart = ((side > 0) | shared).all(1) | ((side < 0) | shared).all(1)
            a, b = b[~apart], a[~apart]
        same = triangles[a][:, :, None] == triangles[b][:, None, :]
        count = same.sum((1, 2))
        crossing = count == 3
        for first, second, shared in ((a, b, same.any(2)), (b, a, same.any(1))):
            for m in range(3):  # sides of the first: all where nothing is shared, the free one where a vertex is
                tried = np.flatnonzero((count < 2) & ~shared[:, m] & ~shared[:, (m + 1) % 3])
                ends = corners[first[tried]]
                crossing[tried] |= meets(ends[:, m], ends[:, (m + 1) % 3], corners[second[tried]])
        hinge = np.flatnonzero(count == 2)  # in one plane: folded where both lie on one side of the edge
        other, shared = corners[b[hinge]], same.any(1)[hinge]
        ends, along = other[shared].reshape(-1, 2, 3), axis[b[hinge]]
        free = corners[a[hinge]][~same.any(2)[hinge]], other[~shared]
        crossing[hinge] |= np.prod([planar_signs(along, ends[:, 0], ends[:, 1], x) for x in free], 0) > 0
        require(not crossing.any(), f"adaptive: no two triangles cross; {crossing.sum()} pairs do")


def main(image, isovalue, mc, adaptive, bound):
    image, isovalue, bound = nibabel.load(image), float(isovalue), float(bound)
    (mc_points, mc_triangles), (points, triangles) = read_ply(mc), read_ply(adaptive)
    show_marching_cubes(image, isovalue, mc_points, mc_triangles)
    print(f"{mc}: marching cubes of the image at {isovalue:g}, {len(mc_triangles):,} triangles", flush=True)
    require_closed(triangles, points, "adaptive")
    show_no_crossing(points, triangles)
    print(f"{adaptive}: closed, oriented, manifold, no two of {len(triangles):,} triangles cross", flush=True)
    show_near(points, triangles, mc_points, mc_triangles, bound, "adaptive: every point lies within the bound")
    show_near(mc_points, mc_triangles, points, triangles, bound, "mc: every point lies within the bound")
    print(f"each lies within {bound:g} mm of the other")


if __name__ == "__main__":
    main(*sys.argv[1:])
