"""What calls cost: memory, references; and that they survive fork()."""

import gc
import multiprocessing
import os
import subprocess
import sys
import threading
import unittest

import adaptiso
import numpy as np
from support import ball


def in_child(script):
    """Runs a script in a fresh interpreter. \\return its stdout"""
    done = subprocess.run([sys.executable, "-c", script], text=True, capture_output=True)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stdout


PEAK = """
import re
def peak():
    return int(re.search(r"VmHWM:\\s+(\\d+) kB", open("/proc/self/status").read())[1]) * 1024
def reset():
    open("/proc/self/clear_refs", "w").write("5")
"""


#: AddressSanitizer keeps what is freed, and rims of what is not
has_own_memory = unittest.skipIf("libasan" in os.environ.get("LD_PRELOAD", ""), "AddressSanitizer")


class Memory(unittest.TestCase):
    @has_own_memory
    def test_samples_are_copied_neither_in_nor_out(self):
        """By marching cubes of a sphere, in C order as in Fortran order."""
        for order, radius in (("F", 50), ("C", 50), ("F", 40)):
            taken, mesh, volume = map(int, in_child(PEAK + f"""
import adaptiso, numpy as np
index = np.indices((200, 200, 200), dtype=np.float32, sparse=True)
volume = np.array(-sum((x - 99.5) ** 2 for x in index), np.float32, order="{order}")
adaptiso.surface(np.asfortranarray(volume[:8, :8, :8]), volume[4, 4, 4], threads=1)
reset()
before = peak()
mesh = adaptiso.surface(volume, -({radius} ** 2.0), method="mc", threads=1)
print(peak() - before, mesh._data.bytes, volume.nbytes)
""").split())
            # the mesh (42 bytes a triangle) and its check (16), and some hundred kB
            self.assertLess(taken, 1.45 * mesh + 0.015 * volume, order)
            if radius == 40:
                self.assertLess(volume + taken, 1.05 * (volume + mesh), order)


    @has_own_memory
    def test_the_default_method_holds_the_full_surface_and_no_index(self):
        taken, mesh, volume = map(int, in_child(PEAK + """
import adaptiso, numpy as np
index = np.indices((320, 320, 320), dtype=np.float32, sparse=True)
volume = np.array(-sum((x - 159.5) ** 2 for x in index), np.float32, order="F")
adaptiso.surface(np.asfortranarray(volume[:8, :8, :8]), volume[4, 4, 4], threads=1)
reset()
before = peak()
mesh = adaptiso.surface(volume, -(60 ** 2.0), threads=1)
print(peak() - before, mesh._data.bytes, volume.nbytes)
""").split())
        # 11.9 MB measured, whatever the volume's size: samples and, until the proof, 24 bytes for each
        # triangle of the full surface. A kd-tree of the volume would be 10 MB more.
        self.assertLess(taken, 13.5e6)
        self.assertLess(volume + taken, 1.1 * (volume + mesh))


class References(unittest.TestCase):
    @has_own_memory
    def test_ten_thousand_calls_leave_nothing_behind(self):
        out = in_child("""
import adaptiso, gc, numpy as np, sys
volume = np.zeros((4, 4, 4), np.float32)
volume[1:3, 1:3, 1:3] = 1
points, faces = np.eye(3) * 9, np.array([[0, 1, 2]])
def resident():
    return int(open("/proc/self/statm").read().split()[1]) * 4096
def once():
    mesh = adaptiso.surface(volume, 0.5, method="mc", threads=1,
                            progress=lambda stage, done: None)
    mesh.vertices, mesh.faces, mesh.normals, mesh.error_bound, mesh.affine if 0 else None
    adaptiso.Mesh(points, faces)
    try:
        adaptiso.surface(volume, 5, threads=1)
    except adaptiso.Error:
        pass
for n in range(500):
    once()
gc.collect()
before = resident(), sys.getrefcount(volume), sys.getrefcount(None), len(gc.get_objects())
for n in range(10000):
    once()
gc.collect()
after = resident(), sys.getrefcount(volume), sys.getrefcount(None), len(gc.get_objects())
print(*(b - a for a, b in zip(before, after)))
""")
        grown, references, nones, objects = map(int, out.split())
        # 10,000 leaked meshes of 24 points and 44 triangles alone would be 16 MB
        self.assertLess(grown, 3e6)
        self.assertEqual(references, 0)
        self.assertLess(abs(nones), 500)  # the interpreter's own; a leak a call is 10,000
        self.assertLess(objects, 50)

    def test_reports_and_errors_of_progress_are_freed(self):
        class Value:
            pass

        value = Value()

        def stop(stage, done):
            raise RuntimeError(value)

        count = sys.getrefcount(value)
        for _ in range(100):
            with self.assertRaises(RuntimeError):
                adaptiso.surface(ball(), -8, progress=stop)
        gc.collect()
        self.assertLessEqual(sys.getrefcount(value), count)


class Ends(unittest.TestCase):
    """Of an interpreter whose threads are in calls."""

    def test_daemons_end_without_a_word(self):
        """Python waits for no daemon; one that asks for its lock then is unwound, which aborts in C++."""
        for work in ("adaptiso.surface(noise, 0.0)", "adaptiso.check(mesh)",
                     "[adaptiso.surface(noise[:6, :6, :6], 0.0, threads=1) for n in range(10**6)]",
                     "adaptiso.surface(noise, 0.0, method='boxes', progress=lambda stage, done: sum(range(999)))"):
            self.assertEqual(in_child(f"""
import adaptiso, numpy as np, sys, threading, time
sys.stderr = sys.stdout
noise = np.asfortranarray(np.random.default_rng(1).normal(size=(80, 80, 80)))
mesh = adaptiso.surface(noise[:50, :50, :50], 0.0, method="mc")
for n in range(2):
    threading.Thread(target=lambda: {work}, daemon=True).start()
time.sleep(0.2)
"""), "")

    def test_the_last_thread_makes_calls_to_the_end(self):
        self.assertEqual(in_child("""
import atexit, numpy as np
volume = np.zeros((8, 8, 8)); volume[2:5, 2:5, 2:5] = 1
atexit.register(lambda: print(len(adaptiso.surface(volume, 0.5, method="mc").faces) > 0))
import adaptiso
class Last:
    def __del__(self, surface=adaptiso.surface, volume=volume):
        print(len(surface(volume, 0.5).faces) > 0)
last = Last()
"""), "True\nTrue\n")

    @has_own_memory
    def test_a_lack_of_memory_is_told_in_words(self):
        self.assertEqual(in_child("""
import adaptiso, numpy as np, resource
noise = np.random.default_rng(1).random((160, 160, 160))
used = int(open("/proc/self/statm").read().split()[0]) * 4096
resource.setrlimit(resource.RLIMIT_AS, (used + 60_000_000,) * 2)
try:
    adaptiso.surface(noise, 0.5, method="mc", threads=2)
except MemoryError as error:
    print(error, noise.flags.writeable)
"""), "adaptiso: there is not enough memory True\n")


class Forks(unittest.TestCase):
    """After a parent that has used threads."""

    def child(self, work):
        """Runs `work` in a forked child. \\return its exit code"""
        pid = os.fork()
        if pid == 0:
            code = 1
            try:
                code = 0 if work() else 2
            finally:
                os._exit(code)
        return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])

    def test_a_child_and_its_parent_both_go_on(self):
        volume = ball((40, 40, 40))
        truth = adaptiso.surface(volume, -15)
        for _ in range(3):
            self.assertEqual(self.child(lambda: adaptiso.surface(volume, -15) == truth), 0)
            self.assertEqual(adaptiso.surface(volume, -15), truth)

    def test_a_child_of_a_fork_during_a_call_goes_on(self):
        noise = np.asfortranarray(np.random.default_rng(1).normal(size=(60, 60, 60)))
        volume = ball((40, 40, 40))
        truth = adaptiso.surface(volume, -15)
        started = threading.Event()
        thread = threading.Thread(target=adaptiso.surface, args=(noise, 0.0), kwargs=dict(
            method="boxes", progress=lambda stage, done: started.set()))
        thread.start()
        started.wait()
        try:
            self.assertEqual(self.child(lambda: adaptiso.surface(volume, -15) == truth), 0)
        finally:
            thread.join()
        self.assertEqual(adaptiso.surface(volume, -15), truth)

    def test_a_pool_of_processes_works(self):
        volumes = [ball((24, 24, 24), (10 + n, 11.5, 11.5)) for n in range(4)]
        with multiprocessing.get_context("fork").Pool(2) as pool:
            meshes = pool.starmap(adaptiso.surface, [(volume, -7) for volume in volumes])
        self.assertEqual(meshes, [adaptiso.surface(volume, -7) for volume in volumes])


if __name__ == "__main__":
    unittest.main(verbosity=2)
