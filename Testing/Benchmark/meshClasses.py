#!/usr/bin/env python3
"""Processor time of adaptiso-check, -compare and -simplify against the size of meshes of many kinds.

    meshClasses.py BIN [--sizes 10000 100000] [--only fan pile] [--seconds 120]

Prints a table in Markdown: a row for each class and size. Times are user plus system seconds of one
run; a run that takes longer than --seconds is ended and shown as "> 120". Needs NumPy.
"""
import argparse
import os
import resource
import subprocess
import sys
import tempfile

import numpy as np

GENERATOR = np.random.default_rng(1)
TAU = 2 * np.pi


def circle(n, z=0.0, radius=50.0, turn=0.0):
    angle = np.linspace(0, TAU, n, endpoint=False) + turn
    return np.c_[radius * np.cos(angle), radius * np.sin(angle), np.full(n, z)]


def joined(parts):
    """Meshes in one."""
    points, triangles, offset = [], [], 0
    for p, t in parts:
        points.append(p)
        triangles.append(t + offset)
        offset += len(p)
    return np.vstack(points), np.vstack(triangles)


def repeated(points, triangles, transforms):
    """A mesh at several places: transforms is [n, 2, 3] of scales and shifts."""
    n = len(transforms)
    p = transforms[:, None, 0] * points + transforms[:, None, 1]
    t = np.arange(n)[:, None, None] * len(points) + triangles
    return p.reshape(-1, 3), t.reshape(-1, 3)


def sphere(n, radius=50.0, centre=(0, 0, 0)):
    """By latitude and longitude, two poles of high valence."""
    m = max(4, int(np.sqrt(n / 4)))
    k = 2 * m
    latitude = np.linspace(0, np.pi, m + 1)[1:-1]
    rings = np.vstack([radius * np.c_[np.sin(a) * np.cos(np.linspace(0, TAU, k, endpoint=False)),
                                      np.sin(a) * np.sin(np.linspace(0, TAU, k, endpoint=False)),
                                      np.full(k, np.cos(a))] for a in latitude])
    points = np.vstack([rings, [[0, 0, radius], [0, 0, -radius]]]) + np.asarray(centre)
    row, column = np.meshgrid(np.arange(len(latitude) - 1), np.arange(k), indexing='ij')
    a, b = (row * k + column).ravel(), (row * k + (column + 1) % k).ravel()
    c = np.arange(k)
    north, south = len(rings), len(rings) + 1
    last = (len(latitude) - 1) * k
    return points, np.vstack([np.c_[a, a + k, b], np.c_[b, a + k, b + k],
                              np.c_[np.full(k, north), c, (c + 1) % k],
                              np.c_[np.full(k, south), last + (c + 1) % k, last + c]])


def bipyramid(n):
    """Two vertices of n / 2 triangles each."""
    m = n // 2
    i = np.arange(m)
    j = (i + 1) % m
    points = np.vstack([[[0, 0, 50], [0, 0, -50]], circle(m)])
    return points, np.vstack([np.c_[0 * i, 2 + i, 2 + j], np.c_[0 * i + 1, 2 + j, 2 + i]])


def shuffled(n):
    """The bipyramid, its triangles and points in any order."""
    points, triangles = bipyramid(n)
    order = GENERATOR.permutation(len(points))
    place = np.argsort(order)
    return points[order], place[triangles][GENERATOR.permutation(len(triangles))]


def star(n):
    """A bipyramid over a star, the other axis askew: its rim goes in and out."""
    points, triangles = bipyramid(n)
    points[2::2] *= 0.3
    return points @ rotation(), triangles


def rotation():
    q, _ = np.linalg.qr(np.array([[1, 2, 3], [2, -1, 0.5], [0.3, 1, -2.]]))
    return q


def apexes(n):
    """Two bipyramids, apex to apex."""
    p, t = bipyramid(n // 2)
    return joined([(p + [0, 0, 51], t), (p - [0, 0, 51], t)])


def needles(n):
    """A tube of needles, askew, closed by fans."""
    m = n // 4
    i = np.arange(m)
    j = (i + 1) % m
    p = np.vstack([circle(m, -50), circle(m, 50, turn=0.7), [[0, 0, -50], [0, 0, 50]]])
    t = np.vstack([np.c_[i, j, m + i], np.c_[j, m + j, m + i], np.c_[0 * i + 2 * m, j, i],
                   np.c_[0 * i + 2 * m + 1, m + i, m + j]])
    return p @ rotation(), t


def comb(n):
    """Closed teeth, long and thin, side by side and askew."""
    m = n // 4
    q = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 100.]]) * [50 / m, 1, 1]
    f = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    shift = np.stack([np.ones((m, 3)), np.c_[np.arange(m) * 100 / m, np.zeros((m, 2))]], 1)
    p, t = repeated(q, f, shift)
    return p @ rotation(), t


def shells(n):
    """Octahedra within each other."""
    m = n // 8
    q = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1.]])
    f = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5],
                  [0, 3, 5]])
    scale = np.linspace(10, 100, m)[:, None, None] * [[1, 1, 1.]]
    return repeated(q, f, np.concatenate([scale, np.zeros((m, 1, 3))], 1))


def plates(n):
    """Flat boxes stacked."""
    m = n // 12
    q = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    q = q * [50, 50, 30 / m]
    f = np.array([[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3],
                  [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]])
    shift = np.stack([np.ones((m, 3)), np.c_[np.zeros((m, 2)), np.arange(m) * 100 / m]], 1)
    return repeated(q, f, shift)


def pieces(n):
    """Small tetrahedra in a grid."""
    m = n // 4
    k = int(np.ceil(m ** (1 / 3)))
    grid = np.stack(np.meshgrid(*[np.arange(k)] * 3), -1).reshape(-1, 3)[:m] * 2.
    q = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.]])
    f = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    return repeated(q, f, np.stack([np.ones((m, 3)), grid], 1))


def outlier(n):
    """A sphere in any order, and a tetrahedron far away."""
    points, triangles = sphere(n - 4)
    triangles = triangles[GENERATOR.permutation(len(triangles))]
    q = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.]]) + 1e6
    return joined([(points, triangles), (q, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))])


def edge(n):
    """All triangles share an edge."""
    i = np.arange(n)
    return np.vstack([[[0, 0, 0], [0, 0, 50]], circle(n, 25)]), np.c_[0 * i, 0 * i + 1, 2 + i]


def crossing(n):
    """All triangles cross at the centre."""
    p = GENERATOR.normal(size=(n, 3, 3))
    p *= 50 / np.linalg.norm(p, axis=2, keepdims=True)
    p[:, 2] = -(p[:, 0] + p[:, 1]) + GENERATOR.normal(size=(n, 3)) * .01
    return p.reshape(-1, 3), np.arange(3 * n).reshape(-1, 3)


def pile(n):
    """Triangles that overlap in one plane."""
    p = np.tile(np.array([[0, 0, 0], [50, 0, 0], [0, 50, 0.]]), (n, 1, 1))
    p[:, :, :2] += GENERATOR.random((n, 1, 2))
    return p.reshape(-1, 3), np.arange(3 * n).reshape(-1, 3)


def copies(n):
    """One triangle many times, with points of its own."""
    p = np.tile(np.array([[0, 0, 0], [50, 0, 0], [0, 50, 0.]]), (n, 1))
    return p, np.arange(3 * n).reshape(-1, 3)


def same(n):
    """One triangle many times, and a tetrahedron."""
    p = np.array([[0, 0, 0], [50, 0, 0], [0, 50, 0], [0, 0, 50.]])
    t = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    return p, np.vstack([t, np.tile(t[:1], (n - 4, 1))])


def flat(n):
    """A sphere, and triangles without area along one line."""
    points, triangles = sphere(n // 2)
    line = np.c_[GENERATOR.random((n // 2 * 3, 1)) * [[80, 80, 80]]] + 60
    return joined([(points, triangles), (line, np.arange(len(line)).reshape(-1, 3))])


CLASSES = {f.__name__: f for f in (sphere, bipyramid, shuffled, star, apexes, needles, comb, shells,
                                   plates, pieces, outlier, edge, crossing, pile, copies, same,
                                   flat)}


def second(name, points, triangles):
    """The surface to compare with: of a sphere a point at its centre, else the surface moved."""
    if name == 'sphere':
        return 1e-6 * points, triangles
    return points + [0.01, 0.02, 0.03], triangles


def write(path, points, triangles):
    header = ('ply\nformat binary_little_endian 1.0\ncomment SPACE=RAS\nelement vertex %d\n'
              'property double x\nproperty double y\nproperty double z\nelement face %d\n'
              'property list uchar int vertex_indices\nend_header\n' % (len(points), len(triangles)))
    faces = np.empty(len(triangles), dtype=[('n', 'u1'), ('v', '<i4', 3)])
    faces['n'], faces['v'] = 3, triangles
    with open(path, 'wb') as out:
        out.write(header.encode() + np.asarray(points, '<f8').tobytes() + faces.tobytes())


def seconds(command, most):
    """Processor time, exit code and memory of a run; a time of None beyond `most` seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU,
                                                                     (most, most + 1)))
    output = process.communicate()[0].decode(errors='replace')
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return (None if process.returncode < 0 else used), process.returncode, output


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('bin')
    parser.add_argument('--sizes', type=int, nargs='+', default=[10000, 100000])
    parser.add_argument('--only', nargs='+', choices=CLASSES, default=list(CLASSES))
    parser.add_argument('--programs', nargs='+', default=['check', 'nested', 'compare', 'simplify'])
    parser.add_argument('--seconds', type=int, default=120)
    parser.add_argument('--verbose', action='store_true')
    options = parser.parse_args()
    print('| class | triangles | ' + ' | '.join(options.programs) + ' |')
    print('|---|--:|' + '--:|' * len(options.programs), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        one, two, out = (os.path.join(folder, n) for n in ('one.ply', 'two.ply', 'out.ply'))
        commands = {'check': ['adaptiso-check', one],
                    'nested': ['adaptiso-check', '--nested', two, one],
                    'compare': ['adaptiso-compare', one, two],
                    'simplify': ['adaptiso-simplify', one, '--max-error', '0.5', '-o', out]}
        for name in options.only:
            for size in options.sizes:
                points, triangles = CLASSES[name](size)
                write(one, points, triangles)
                write(two, *second(name, points, triangles))
                cells = []
                for program in options.programs:
                    command = commands[program]
                    used, code, output = seconds(
                        [os.path.join(options.bin, command[0])] + command[1:], options.seconds)
                    cells.append('> %d' % options.seconds if used is None else '%.2f' % used)
                    if options.verbose:
                        print(name, size, program, used, code, output, file=sys.stderr)
                print('| %s | %d | %s |' % (name, len(triangles), ' | '.join(cells)), flush=True)


if __name__ == '__main__':
    main()
