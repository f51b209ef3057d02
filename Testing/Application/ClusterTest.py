"""adaptiso-bids on a Slurm of three nodes that is started here: jobs killed, a node lost, two
submissions at once, for 100 subjects or ADAPTISO_SUBJECTS. Needs Debian's slurmctld, slurmd, slurm-client,
munge and mricron-data; exits 77 (skipped) without them. The Snakefile is tried where snakemake is installed."""

import gzip
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

from slurmSupport import Slurm, command_of, kill, missing
from support import BIN, OK, SOURCE, ApplicationTest, Image, main, write_nifti

BIDS = str(BIN / "adaptiso-bids")
SCAN = Path("/usr/share/mricron/templates/ch2.nii.gz")
WHAT = ("--surfaces", "iso=auto,largest", "--check", "--no-pictures")
SUBJECTS = int(os.environ.get("ADAPTISO_SUBJECTS", "100"))
KILLS, SIDE = max(8, SUBJECTS // 5), 40


def crops(count):
    """Parts of a real scan, as images of their own."""
    with gzip.open(SCAN) as file:
        content = file.read()
    size = [int.from_bytes(content[42 + 2 * axis:44 + 2 * axis], "little") for axis in range(3)]
    samples = content[352:]
    chance = random.Random(7)
    for _ in range(count):
        # about the head's middle, where all tissues are
        at = [chance.randrange(side // 4, 3 * side // 4 - SIDE) for side in size]
        starts = [((k + at[2]) * size[1] + j + at[1]) * size[0] + at[0]
                  for k in range(SIDE) for j in range(SIDE)]
        rows = [samples[start:start + SIDE] for start in starts]
        yield Image((SIDE, SIDE, SIDE), "B", b"".join(rows))


def content(folder):
    """Names and bytes of what is made, without records and the page, which hold times."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*")
            if path.is_file() and ".adaptiso-" not in path.name and path.name != "summary.html"}


class ClusterTest(ApplicationTest):
    def setUp(self):
        super().setUp()
        self.environment = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"}
        shutil.copytree(SOURCE / "Examples/cohort", self.path("cohort"))

    def make_study(self, count):
        for number, image in enumerate(crops(count), 1):
            path = self.path(f"study/sub-{number:03}/anat/sub-{number:03}_T1w.nii")
            path.parent.mkdir(parents=True)
            write_nifti(path, image)
        self.path("study/dataset_description.json").write_text('{"Name": "crops", "BIDSVersion": "1.8.0"}')

    def make_undisturbed(self):
        for level in (("participant", "--jobs", "2", "--threads", "1"), ("group",)):
            done = subprocess.run([BIDS, "study", "still", *level, *WHAT], cwd=self.folder, text=True,
                                  capture_output=True)
            self.assertEqual(done.returncode, OK, done.stdout[-2000:] + done.stderr)
        return content(self.path("still"))

    def start_slurm(self):
        folder = Path(tempfile.mkdtemp(prefix="slurm-"))  # short: it holds a socket
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        slurm = Slurm(folder)
        slurm.environment["PATH"] = f"{BIN}:{slurm.environment['PATH']}"
        self.addCleanup(slurm.stop)
        slurm.start()
        return slurm

    def jobs(self, program):
        """Running processes of that program that work on this test's output."""
        found = []
        for path in Path("/proc").iterdir():
            if path.name.isdigit() and str(self.path("out")) in command_of(int(path.name)):
                try:
                    if Path(os.readlink(path / "exe")).name == program:
                        found.append(int(path.name))
                except OSError:
                    pass
        return found

    def kill_one(self, chance):
        """A job, or the program that it runs, at any moment of its life. \\return whether one was there"""
        running = self.jobs(chance.choice(("adaptiso-bids", "adaptiso-mesh")))
        if not running:
            return False
        kill(chance.choice(running))
        return True

    def submit(self, slurm, *arguments, options=""):
        environment = {**slurm.environment, "ADAPTISO_SBATCH": f"--mem=400 {options}"}
        return subprocess.Popen(["cohort/submit.sh", *arguments], cwd=self.folder, env=environment,
                                text=True, stdout=subprocess.PIPE)


class JobArray(ClusterTest):
    def test_killed_jobs_a_lost_node_and_two_submissions_change_no_byte(self):
        began = time.monotonic()
        self.make_study(SUBJECTS)
        still = self.make_undisturbed()
        print(f"undisturbed: {time.monotonic() - began:.0f} s", flush=True)
        slurm = self.start_slurm()
        # each has a node that the other has not, so that both work on the same participants at once
        both = [self.submit(slurm, jobs, "study", "out", *WHAT, options=f"--exclude={node}")
                for jobs, node in (("first", "n3"), ("second", "n1"))]
        ids = [process.communicate(timeout=60)[0].split() for process in both]
        self.assertEqual([process.returncode for process in both], [OK, OK])

        chance, killed, isLost, isCrashed = random.Random(1), 0, False, False
        while killed < KILLS and slurm.pending() > 0:
            killed += self.kill_one(chance)
            if killed == KILLS // 2 and not isLost:
                slurm.lose_node("n2")
                isLost = True
            if killed == KILLS * 3 // 4 and not isCrashed:
                slurm.crash_node("n3")
                slurm.start_node("n3")  # it comes up again, and knows nothing
                isCrashed = True
            time.sleep(chance.uniform(0.2, 1.0))
        self.assertEqual((killed, isLost, isCrashed), (KILLS, True, True))
        slurm.wait(lambda: slurm.pending() == 0, 900, "the end of the jobs")
        failed = [job for job, state in slurm.states().items() if state == "FAILED"]
        print(f"with {killed} kills: {time.monotonic() - began:.0f} s; failed: {len(failed)}", flush=True)

        again = self.submit(slurm, "first").communicate(timeout=60)[0].split()
        slurm.wait(lambda: slurm.pending() == 0, 900, "the end of the second try")
        group = slurm.states()[again[1]]
        self.assertEqual(group, "COMPLETED", self.path("first/logs/group.log").read_text())
        print(f"whole again: {time.monotonic() - began:.0f} s; array and group jobs {ids + [again]}", flush=True)
        made = content(self.path("out"))
        self.assertEqual(made["quality.tsv"], still["quality.tsv"])
        self.assertEqual(len([name for name in made if name.endswith(".vtp")]), SUBJECTS)
        self.assertEqual(sorted(made), sorted(still))
        for name, text in made.items():
            self.assertEqual(text, still[name], name)
        left = [path for path in self.path("out").rglob(".adaptiso-*")]
        self.assertEqual(left, [])


@unittest.skipUnless(shutil.which("snakemake"), "needs snakemake")
class Snakemake(ClusterTest):
    COUNT = 6

    def snakemake(self, *arguments, environment):
        self.path("cohort/config.yaml").write_text(
            f"bids: ../study\nout: {self.path('out')}\nwhat: {' '.join(WHAT)}\n")
        return subprocess.Popen(["snakemake", "--nocolor", *arguments], cwd=self.path("cohort"), text=True,
                                env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def test_the_profile_survives_killed_jobs(self):
        self.make_study(self.COUNT)
        still = self.make_undisturbed()
        slurm = self.start_slurm()
        process = self.snakemake("--profile", "slurm", environment=slurm.environment)
        killed = 0
        while killed < 2 and process.poll() is None:
            killed += self.kill_one(random.Random(killed))
            time.sleep(0.1)
        out = process.communicate(timeout=900)[0]
        self.assertEqual((process.returncode, killed), (OK, 2), out)
        self.assertEqual(content(self.path("out")), still)

    def test_here(self):
        self.make_study(2)
        process = self.snakemake("--cores", "2", environment=self.environment)
        out = process.communicate(timeout=600)[0]
        self.assertEqual(process.returncode, OK, out)
        self.assertIn("2 participants, 2 whole", out)


if __name__ == "__main__":
    absent = missing() + ([] if SCAN.exists() else [str(SCAN)])
    if absent:
        print("skipped: needs", ", ".join(absent))
        sys.exit(77)
    main()
