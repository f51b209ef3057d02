"""adaptiso-giant on volumes of 512^3 and 1,024^3: one process, two workers, five orders of jobs, 20 jobs
killed at random moments, and a Slurm of three nodes of which one is lost and one crashes: the same bytes, and nothing that
was done is done again. ADAPTISO_GIANT_SIDE (512), ADAPTISO_GIANT_ORDERS (5) and ADAPTISO_GIANT_METHOD
(adaptive) choose another. Slurm's part is skipped without Debian's slurmctld, slurmd, slurm-client and munge."""

import hashlib
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
import zlib
from pathlib import Path

import numpy

import slurmSupport
from support import BIN, OK, SOURCE, ApplicationTest, main

GIANT = str(BIN / "adaptiso-giant")
SIDE = int(os.environ.get("ADAPTISO_GIANT_SIDE", "512"))
ORDERS = int(os.environ.get("ADAPTISO_GIANT_ORDERS", "5"))
METHOD = os.environ.get("ADAPTISO_GIANT_METHOD", "adaptive")
TILE, CHUNK, KILLS, GROUP = SIDE // 4, 64, 20, 4
# balls in units of a tile: across walls, edges and a corner, and small ones
BALLS = [(2, 2, 2, 0.45), (1, 1.5, 3, 0.4), (3, 1, 1.5, 0.35), (0.5, 3.2, 2.5, 0.3), (3.4, 3.4, 3.4, 0.45),
         (1, 1, 1, 0.3), (2.5, 0.6, 2.4, 0.4), (0.1, 0.1, 0.1, 0.3)]


def chunk_values(low):
    """int16 depths, 100 a voxel, or None where all is outside."""
    best = numpy.full((CHUNK,) * 3, -400.0)
    for *middle, radius in BALLS:
        far = [max(low[a] - TILE * middle[a], TILE * middle[a] - low[a] - CHUNK, 0) for a in range(3)]
        if sum(away * away for away in far) > (TILE * radius + 5) ** 2:
            continue
        z, y, x = ((numpy.arange(low[a], low[a] + CHUNK) - TILE * middle[a]) ** 2 for a in range(3))
        squared = z[:, None, None] + y[None, :, None] + x[None, None, :]
        best = numpy.maximum(best, numpy.clip(100 * (TILE * radius - numpy.sqrt(squared)), -400, 400))
    return numpy.rint(best).astype("<i2") if best.max() > -400 else None


def write_zarr(path):
    (path / "0").mkdir(parents=True)
    (path / ".zgroup").write_text('{"zarr_format": 2}')
    (path / ".zattrs").write_text(json.dumps({"multiscales": [{
        "version": "0.4", "axes": [{"name": a, "type": "space", "unit": "millimeter"} for a in "zyx"],
        "datasets": [{"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [0.01] * 3}]}]}]}))
    (path / "0/.zarray").write_text(json.dumps({
        "zarr_format": 2, "shape": [SIDE] * 3, "chunks": [CHUNK] * 3, "dtype": "<i2", "order": "C",
        "compressor": {"id": "zlib", "level": 1}, "fill_value": -400, "filters": None}))
    for z in range(0, SIDE, CHUNK):
        for y in range(0, SIDE, CHUNK):
            for x in range(0, SIDE, CHUNK):
                values = chunk_values((z, y, x))
                if values is not None:
                    (path / f"0/{z // CHUNK}.{y // CHUNK}.{x // CHUNK}").write_bytes(
                        zlib.compress(values.tobytes(), 1))


def sum_of(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def spent():
    """Processor seconds of children that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Kills(ApplicationTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.shared = Path(tempfile.mkdtemp())
        write_zarr(cls.shared / "balls.zarr")
        cls.options = ["--input", str(cls.shared / "balls.zarr"), "--iso", "0", "--tile", str(TILE),
                       "--method", METHOD, "--no-warnings"]
        before = spent()
        subprocess.run([GIANT, "run", "work", *cls.options, "--threads", "1", "-o", "one.ply", "-q"],
                       cwd=cls.shared, check=True)
        cls.seconds = spent() - before
        cls.truth = sum_of(cls.shared / "one.ply")
        print(f"{SIDE}^3 {METHOD}: undisturbed {cls.seconds:.1f} processor s", flush=True)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.shared)
        super().tearDownClass()

    def giant(self, *arguments):
        done = subprocess.run([GIANT, *map(str, arguments)], cwd=self.folder, text=True, capture_output=True)
        self.assertEqual(done.returncode, OK, done.stderr)
        return done.stdout

    def plan(self, work):
        self.giant("plan", work, *self.options)
        plan = json.loads(self.path(f"{work}/plan.json").read_text())
        return {stage: plan[stage + "s"] for stage in ("tile", "seam") if plan.get(stage + "s")}

    def join(self, work):
        self.giant("join", work, "-o", f"{work}.ply", "-q")
        return sum_of(self.path(f"{work}.ply"))

    def test_two_workers(self):
        self.giant("run", "two", *self.options, "--workers", 2, "-o", "two.ply", "-q")
        self.assertEqual(sum_of(self.path("two.ply")), self.truth)

    def test_orders_and_killed_jobs(self):
        all_extra = all_wasted = all_undisturbed = 0
        for order in range(ORDERS):
            calm, work = f"calm{order}", f"order{order}"
            before, self.looking = spent(), 0
            self.make_with_kills(calm, random.Random(order), 0)
            undisturbed, before = spent() - before, spent()
            wasted, kills = self.make_with_kills(work, random.Random(order), KILLS)
            extra = spent() - before - self.looking - undisturbed
            again = sum(json.loads(self.giant(stage, work, "--json", "-", "-q"))["made"]
                        for stage in self.plan(work))
            print(f"order {order}: {kills} kills, {wasted:.2f} s in killed jobs, {extra:.2f} s more than the "
                  f"same jobs undisturbed ({undisturbed:.1f}); {again} pieces left to the end", flush=True)
            self.assertEqual((self.join(work), self.join(calm)), (self.truth, self.truth), order)
            self.assertEqual((kills, again), (KILLS, 0), order)
            all_extra, all_wasted, all_undisturbed = all_extra + extra, all_wasted + wasted, all_undisturbed + undisturbed
            shutil.rmtree(self.path(calm))
        print(f"all: {all_wasted:.2f} s in killed jobs, {all_extra:.2f} s more than undisturbed", flush=True)
        # the same work takes some hundredths more or less, by what else the machine does
        self.assertLess(all_extra, all_wasted + 0.05 * all_undisturbed)

    def make_with_kills(self, work, chance, kills):
        """All pieces, in a random order; jobs are killed at random moments and begun again.
        \\return the seconds of killed jobs, their number"""
        wasted, killed = 0, 0
        for stage, left in self.plan(work).items():
            chance.shuffle(left)
            jobs = [left[begin:begin + GROUP] for begin in range(0, len(left), GROUP)]
            while jobs:
                job = jobs.pop(0)
                isLast = stage == "seam" or METHOD == "mc"
                wants = killed < (kills if isLast else kills // 2)
                ended = self.run_job(stage, work, job, chance if wants else None)
                if ended is not None:
                    wasted, killed = wasted + ended, killed + 1
                    done = self.pieces_there(work, stage, job)
                    jobs.insert(chance.randrange(len(jobs) + 1), job)
                    self.assertGreaterEqual(self.count_found(stage, work, done), len(done))
        return wasted, killed

    def pieces_there(self, work, stage, job):
        return [one for one in job if self.path(f"{work}/{stage}s/{one}.tile").exists()]

    def count_found(self, stage, work, done):
        """What a killed job has left whole is not made again."""
        if not done:
            return 0
        before = spent()
        found = json.loads(self.giant(stage, work, *done, "--json", "-", "-q"))["found"]
        self.looking += spent() - before
        return found

    def run_job(self, stage, work, job, chance):
        """\\return the processor seconds of a job that was killed, or None"""
        before = spent()
        child = subprocess.Popen([GIANT, stage, work, *job, "-q", "--threads", "1"], cwd=self.folder)
        if chance is not None:
            time.sleep(chance.uniform(0.005, 0.3 * SIDE / 512))
            child.send_signal(signal.SIGKILL)
        code = child.wait()
        self.assertIn(code, (OK, -signal.SIGKILL))
        return spent() - before if code else None

    @unittest.skipIf(slurmSupport.missing(), "needs Slurm")
    def test_slurm_with_a_crashed_node(self):
        folder = Path(tempfile.mkdtemp(prefix="slurm-"))  # short: it holds a socket
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        slurm = slurmSupport.Slurm(folder)
        slurm.environment["PATH"] = f"{BIN}:{slurm.environment['PATH']}"
        self.addCleanup(slurm.stop)
        slurm.start()
        shutil.copytree(SOURCE / "Examples/giant", self.path("giant"))
        environment = {**slurm.environment, "ADAPTISO_SBATCH": "--mem=600", "ADAPTISO_PER_TASK": "2"}
        chance, killed, isLost, isCrashed = random.Random(3), 0, False, False
        for attempt in range(3):
            subprocess.run(["giant/submit.sh", "work", "out.ply", *self.options], cwd=self.folder, env=environment, check=True,
                           stdout=subprocess.PIPE)
            while slurm.pending() > 0:
                if killed < KILLS and (victims := self.jobs()):
                    slurmSupport.kill(chance.choice(victims))
                    killed += 1
                if killed >= 5 and not isLost:
                    slurm.lose_node("n2")
                    isLost = True
                if killed >= 10 and not isCrashed:
                    slurm.crash_node("n3")
                    isCrashed = True
                time.sleep(chance.uniform(0.02, 0.2))
            if self.path("out.ply").exists():
                break
        print(f"Slurm: {killed} kills, a node lost whose jobs go on: {isLost}, one that died with its jobs: "
              f"{isCrashed}; submissions: {attempt + 1}", flush=True)
        self.assertTrue(isLost and isCrashed)
        self.assertEqual(sum_of(self.path("out.ply")), self.truth)

    def jobs(self):
        """Running processes of adaptiso-giant that work on this test's folder."""
        found = []
        for path in Path("/proc").iterdir():
            if path.name.isdigit() and str(self.path("work")) in slurmSupport.command_of(int(path.name)):
                try:
                    if Path(os.readlink(path / "exe")).name == "adaptiso-giant":
                        found.append(int(path.name))
                except OSError:
                    pass
        return found


if __name__ == "__main__":
    main()
