"""Calls by the million: hypothesis makes up pools of arguments, and calls take what they find in them.
How many calls there are is ADAPTISO_CALLS (8,000); their number and rate are printed. Each gives a
result or an adaptiso.Error, never another exception and never a crash. More than 100,000 are made in
processes of 100,000, so that a crash names the seed that makes it again (ADAPTISO_SEED). Exit code 77:
hypothesis is not there."""

import collections
import faulthandler
import os
import random
import re
import secrets
import subprocess
import sys
import time
import unittest

import ArgumentsTest as made_up  # exits with 77 where hypothesis is not there
import adaptiso
import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

CALLS = int(os.environ.get("ADAPTISO_CALLS", "8000"))
#: of one example: drawing arguments takes longer than most calls
BATCH = 1000
#: of one process
PART = 100_000
#: none: the same calls each time
SEED = os.environ.get("ADAPTISO_SEED")

calls, results = collections.Counter(), collections.Counter()


def pool(strategy, size):
    return st.lists(strategy, min_size=size, max_size=size)


def usual(*values):
    """Mostly what is usual, so that calls get beyond the checks of arguments."""
    return st.one_of(*map(st.just, values), made_up.anything)


def few_threads(value):
    return not (isinstance(value, (int, np.integer)) and 3 < value)


def noise(number):
    """A volume that has surfaces at most levels, of any type, with ties in one of two."""
    rng = np.random.default_rng(number)
    values = rng.normal(scale=3, size=rng.integers(2, rng.choice([4, 4, 5, 8]), 3))
    dtype = rng.choice(["f4", "f8", "i1", "u2", "i4", "u8", "f4", "f8", ">f4", "f2", "?"])
    return np.array(np.abs(values) if dtype[0] in "u?" else values, dtype, order=rng.choice(["C", "F"]))


def ball(number):
    """(vertices, faces) of a closed surface, one of three broken somewhere."""
    rng = np.random.default_rng(number)
    mesh = adaptiso.surface(rng.normal(size=rng.choice([4, 4, 5], 3)), 0.3, method="mc", threads=1)
    vertices, faces = mesh.vertices * rng.choice([1.0, 20.0]), mesh.faces.copy()
    if number % 3 == 0:
        faces[rng.integers(len(faces))] = rng.integers(-1, len(vertices) + 1, 3)
    return vertices, faces


SEEDS = st.integers(0, 2**32)
POOLS = st.fixed_dictionaries({
    "image": pool(st.one_of(SEEDS.map(noise), SEEDS.map(noise), made_up.images), 6),
    "view": pool(made_up.views, 4), "level": pool(made_up.levels, 6),
    "affine": pool(st.one_of(st.none(), made_up.affines), 4),
    "table": pool(made_up.tables, 6), "ball": pool(SEEDS.map(ball), 2)})
OPTIONS = st.fixed_dictionaries({
    "max_error": pool(st.one_of(st.floats(0.01, 3), made_up.anything), 4),
    "triangles": pool(st.one_of(st.integers(0, 500), made_up.anything), 4),
    "reduction": pool(st.one_of(st.floats(0, 1), made_up.anything), 4),
    "min_angle": pool(st.one_of(st.floats(0, 40), made_up.anything), 4),
    "method": pool(usual("adaptive", "boxes", "dmc", "asc", "mc"), 6),
    "border": pool(usual("closed", "open"), 4),
    "largest": pool(usual(True, False), 4),
    "min_volume": pool(st.one_of(st.floats(0, 20), made_up.anything), 4),
    "fill_cavities": pool(usual(True, False), 4),
    "threads": pool(usual(1, 1, 1, 0, 2, 3).filter(few_threads), 4)})


def attempt(name, call, *arguments, **named):
    """What a call gives, or None where the arguments are refused with one line."""
    calls[name] += 1
    try:
        result = call(*arguments, **named)
        results[name] += 1
        return result
    except adaptiso.Error as error:
        assert "\n" not in str(error) and len(str(error)) > 3, str(error)
    except Exception as error:
        raise AssertionError(f"{name}: {arguments!r} {named!r}: {error!r}") from error
    return None


def level_of(image, pools, pick):
    """Mostly one of the image's samples."""
    if isinstance(image, np.ndarray) and image.size and image.dtype.kind in "iuf" and pick(range(4)):
        return float(image.flat[pick(range(image.size))])
    return pick(pools["level"])


def surface(pools, options, pick):
    image = pick(pools["image"])
    if isinstance(image, np.ndarray) and image.ndim > 0:
        image = pick(pools["view"])(image)
    named = {pick(list(options)): None for _ in range(pick((0, 1, 1, 2, 3)))}
    named = {name: pick(options[name]) for name in named}
    if pick((True, False)):
        named["affine"] = pick(pools["affine"])
    if pick(range(8)):
        named.setdefault("threads", 1)  # others wait for each other longer than they work
    mesh = attempt("surface", adaptiso.surface, image, level_of(image, pools, pick), **named)
    if mesh is not None:
        assert len(mesh.faces) > 0 and mesh.faces.max() < len(mesh.vertices)
        assert np.isfinite(mesh.vertices).all()
        if pick(range(8)) == 0:
            attempt("check", adaptiso.check, mesh, threads=1)


def index(pools, options, pick):
    image = pick(pools["image"])
    made = attempt("Index", adaptiso.Index, image, border=pick(options["border"]),
                   threads=pick(options["threads"]))
    if made is not None:
        for _ in range(3):
            attempt("Index.surface", made.surface, level_of(image, pools, pick),
                    method=pick(options["method"]), largest=pick(options["largest"]),
                    threads=pick(options["threads"]))


def mesh(pools, options, pick):
    vertices, faces = pick([(pick(pools["table"]), pick(pools["table"])), *pools["ball"]])
    made = attempt("Mesh", adaptiso.Mesh, vertices, faces, pick([None, pick(pools["table"])]))
    if made is not None:
        repr(made), made.is_closed, made.area, made.volume
        attempt("compare", adaptiso.compare, made, made, samples=10, threads=1)
        attempt("simplify", adaptiso.simplify, made, max_error=pick([None, 0.5, 0, -1.0, "a"]),
                triangles=pick([None, 20, 0, -3, 1e30]), reduction=pick([None, 0.5, 2]),
                keep_borders=pick([False, True, None]), threads=1)
    found = attempt("check", adaptiso.check, (vertices, faces), threads=1)
    if found is not None:
        repr(found), found.failed, found.findings


def marching_cubes(pools, options, pick):
    image = pick(pools["image"])
    attempt("marching_cubes", adaptiso.marching_cubes, image,
            pick([None, level_of(image, pools, pick)]), step_size=pick((1, 1, 2, 3, pick(pools["level"]))),
            spacing=pick([(1.0, 2.0, 0.5), pick(options["max_error"])]),
            mask=pick([None, pick(pools["image"])]))


def labels(pools, options, pick):
    image = pick(pools["image"])
    if isinstance(image, np.ndarray) and image.dtype.kind == "f" and pick((True, True, False)):
        with np.errstate(all="ignore"):
            image = np.round(image)
    named = {name: pick(options[name]) for name in ("max_error", "triangles", "reduction")
             if pick(range(4)) == 0}
    if pick(range(4)) == 0:
        named["affine"] = pick(pools["affine"])
    if pick(range(8)) == 0:
        named["labels"] = pick(([1], [2, 1], pick(options["triangles"]), pick(pools["level"])))
    walls = attempt("labels", adaptiso.labels, image, threads=1, **named)
    if walls is not None:
        repr(walls), walls.regions, walls.error_bound
        label = pick(list(walls.regions) + [pick(options["triangles"])])
        mesh = attempt("region", walls.region, label)
        assert mesh is None or mesh.volume > 0


def bem(pools, options, pick):
    """Mostly refused: what is made up is no head."""
    if not hasattr(adaptiso, "bem"):
        return
    kind = pick(("t1", "labels", "ct", "surfaces", "probabilities"))
    value = pick(pools["image"])
    if kind == "surfaces":
        value = [pick(pools["ball"]), (pick(pools["table"]), pick(pools["table"])),
                 pick(pools["ball"])]
    elif kind == "probabilities":
        value = [value] * pick((1, 3, 5))
    named = {kind: value, "affine": pick(pools["affine"])}
    if kind == "labels":
        named["tissues"] = pick(({"brain": [1], "skull": [2], "scalp": [3]}, "aseg",
                                 pick(options["method"])))
    if pick((True, False)):
        named[pick(("vertices", "min_gap", "layers", "aseg", "pial", "electrodes", "montage", "landmarks", "csf", "conductivity", "voxel", "edge_length", "meg"))] = (
            pick(options["max_error"]))
    attempt("bem", adaptiso.bem, **named)


ATTEMPTS = 10 * [surface] + 2 * [index] + 4 * [mesh] + 3 * [marching_cubes] + [labels, bem]


def in_parts():
    """Calls by processes of PART each; their sum is told after each. \return the exit code"""
    first = int(SEED) if SEED else secrets.randbelow(10**6)
    began, made = time.monotonic(), 0
    for number in range(-(-CALLS // PART)):
        part = min(PART, CALLS - number * PART)
        done = subprocess.run([sys.executable, "-B", __file__], text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, env={**os.environ, "ADAPTISO_SEED": str(first + number),
                                                             "ADAPTISO_CALLS": str(part)})
        if done.returncode != 0:
            print(f"{done.stdout}\nexit code {done.returncode} after {made:,} calls; made again by "
                  f"ADAPTISO_SEED={first + number} ADAPTISO_CALLS={part}", flush=True)
            return 1
        told = re.search(r"([\d,]+) calls, .* a second: .*", done.stdout)
        made += int(told[1].replace(",", ""))
        print(f"{made:,} calls, {time.monotonic() - began:.0f} s, seed {first + number}: {told[0]}", flush=True)
    return 0


class Calls(unittest.TestCase):
    def test_give_a_result_or_an_error(self):
        faulthandler.enable()
        began = time.monotonic()

        @settings(max_examples=max(1, CALLS // BATCH), deadline=None, database=None,
                  derandomize=SEED is None, phases=[Phase.generate],
                  suppress_health_check=list(HealthCheck))
        @given(POOLS, OPTIONS, SEEDS)
        def batch(pools, options, number):
            pick = random.Random(number).choice
            end = sum(calls.values()) + BATCH
            while sum(calls.values()) < end:
                pick(ATTEMPTS)(pools, options, pick)

        (batch if SEED is None else seed(int(SEED))(batch))()
        seconds = time.monotonic() - began
        total = sum(calls.values())
        print(f"{total:,} calls, {total / seconds:,.0f} a second:",
              ", ".join(f"{name} {results[name]:,} of {calls[name]:,}" for name in calls))
        self.assertGreaterEqual(total, 0.9 * CALLS)


if __name__ == "__main__":
    if CALLS > PART:
        sys.exit(in_parts())
    unittest.main(verbosity=2)
