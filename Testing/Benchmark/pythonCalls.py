#!/usr/bin/env python3
"""What the Python package costs beside C++: the overhead of a call, four threads on four volumes, and
the peak memory of a call. For people; run it on a machine that does nothing else. Other work does not
change what threads wait for, processor time, and memory.

    PYTHONPATH=build/release/python Testing/Benchmark/pythonCalls.py [overhead|memory|threads ...]
"""

import concurrent.futures
import re
import statistics
import subprocess
import sys
import threading
import time

import adaptiso
import numpy as np


def seconds(work, repeats):
    """Median, and the least, of wall-clock seconds."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return statistics.median(times), min(times)


def ball(n, center):
    index = np.indices((n, n, n), dtype=np.float32, sparse=True)
    return np.asfortranarray(-np.sqrt(sum((x - center) ** 2 for x in index)))


def in_python(volume, level, method, repeats):
    """Processor seconds of a call in its own thread, and of these outside of C++: medians. They are what
    a call needs on a machine that does other things meanwhile too."""
    made = adaptiso._adaptiso.make_surface
    inside = []

    def timed(*arguments, **options):
        start = time.thread_time()
        mesh = made(*arguments, **options)
        inside.append(time.thread_time() - start)
        return mesh

    totals = []
    adaptiso._adaptiso.make_surface = timed
    try:
        for _ in range(repeats):
            start = time.thread_time()
            adaptiso.surface(volume, level, method=method, threads=1)
            totals.append(time.thread_time() - start)
    finally:
        adaptiso._adaptiso.make_surface = made
    outside = [total - own for total, own in zip(totals, inside)]
    return statistics.median(totals), statistics.median(outside)


def call_overhead():
    """A call on 16^3 less what C++ takes of it."""
    volume = ball(16, 7.5)
    for method in ("mc", "adaptive"):
        wall, least = seconds(lambda: adaptiso.surface(volume, -5, method=method, threads=1), 300)
        total, outside = in_python(volume, -5, method, 300)
        print(f"call on 16^3, {method}: {1e3 * wall:.3f} ms (least {1e3 * least:.3f}); of the "
              f"processor {1e3 * total:.3f} ms, of that outside of C++ {1e3 * outside:.3f}")


def thread_times():
    """Seconds by the clock, of the processor, and of waiting for a processor, of this thread so far."""
    with open(f"/proc/self/task/{threading.get_native_id()}/schedstat") as stream:
        worked, waited, _ = map(int, stream.read().split())
    return np.array([time.perf_counter(), worked / 1e9, waited / 1e9])


def four_threads():
    """Also by what does not change with other work: the time that a thread neither works nor waits for a
    processor it waits for a lock, the interpreter's or one of ours."""
    volumes = [ball(96, 47 + n) for n in range(4)]
    spent = []

    def make(volume):
        before = thread_times()
        adaptiso.surface(volume, -35, threads=1)
        spent.append(thread_times() - before)

    def by_threads():
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            list(pool.map(make, volumes))

    one, _ = seconds(lambda: [make(volume) for volume in volumes], 5)
    alone = np.sum(spent, axis=0)
    spent.clear()
    four, _ = seconds(by_threads, 5)
    together = np.sum(spent, axis=0)
    total, outside = in_python(volumes[0], -35, "adaptive", 5)
    print(f"four volumes of 96^3: one after the other {one:.2f} s, four threads {four:.2f} s: "
          f"{one / four:.2f} x")
    print(f"  of the processor {alone[1] / 5:.2f} s alone, {together[1] / 5:.2f} s side by side")
    for name, (clock, worked, waited) in (("alone", alone), ("side by side", together)):
        print(f"  {name}: of the threads' time {worked / clock:.1%} at work, {waited / clock:.1%} waiting "
              f"for a processor, {1 - (worked + waited) / clock:.2%} for locks")
    print(f"  {outside / total:.2%} of a call in Python, so at most "
          f"{1 / (outside / total + (1 - outside / total) / 2):.2f} x on two cores")


PEAK = r"""
import re, sys, adaptiso, numpy as np
def peak():
    return int(re.search(r"VmHWM:\s+(\d+) kB", open("/proc/self/status").read())[1]) * 1024
order, method, side, dtype = sys.argv[1:]
side = int(side)
index = np.indices((side,) * 3, dtype=np.float32, sparse=True)
# the distance in voxels, up to 220 of them
volume = np.empty((side,) * 3, dtype, order=order)
for k in range(side):
    volume[:, :, k] = 220 - np.sqrt(sum((x[:, :, min(k, x.shape[2] - 1)] - (side - 1) / 2) ** 2 for x in index)) * 220 / side
adaptiso.surface(np.asfortranarray(volume[:8, :8, :8]), volume[4, 4, 4], threads=1)
open("/proc/self/clear_refs", "w").write("5")
before = peak()
mesh = adaptiso.surface(volume, 220 - 220 * 60 / 256 + 0.2, method=method, threads=1)
print(peak() - before, mesh._data.bytes, volume.nbytes)
"""


def peak_memory():
    """Of spheres of a quarter of the volume's width, each in a process of its own."""
    for side, dtype, order, method in (
            (256, "f4", "F", "mc"), (256, "f4", "C", "mc"), (256, "f4", "F", "boxes"),
            (256, "f4", "F", "adaptive"), (256, "f4", "C", "adaptive"), (352, "f4", "F", "adaptive"), (512, "f4", "F", "mc"),
            (512, "f4", "F", "adaptive"), (640, "f4", "F", "adaptive"), (512, "u1", "F", "mc"),
            (512, "u1", "F", "adaptive")):
        done = subprocess.run([sys.executable, "-c", PEAK, order, method, str(side), dtype], text=True,
                              check=True, capture_output=True)
        taken, mesh, volume = (int(number) / 1e6 for number in done.stdout.split())
        print(f"peak of a call on {side}^3 {dtype} ({volume:.0f} MB), {order} order, {method}: "
              f"{taken:.1f} MB above the volume, for a mesh of {mesh:.1f} MB "
              f"((volume + call) / (volume + mesh) = {(volume + taken) / (volume + mesh):.3f})",
              flush=True)


if __name__ == "__main__":
    parts = {"overhead": call_overhead, "memory": peak_memory, "threads": four_threads}
    for name in sys.argv[1:] or parts:
        parts[name]()
