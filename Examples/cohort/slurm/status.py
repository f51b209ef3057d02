#!/usr/bin/python3
"""How a job of Slurm stands, for Snakemake 7's --cluster-status: running, success or failed.

scontrol knows a job for MinJobAge (300 s by default) after its end; then sacct is asked, where
there is one. A job that Slurm requeues (its node was lost) is running."""

import re
import subprocess
import sys
import time

RUNNING = {"PENDING", "CONFIGURING", "COMPLETING", "RUNNING", "SUSPENDED", "REQUEUED", "REQUEUE_HOLD",
           "SPECIAL_EXIT", "RESIZING", "SIGNALING", "STAGE_OUT", "PREEMPTED"}


def answer(*command):
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout if done.returncode == 0 else ""


def state(job):
    found = re.search(r"JobState=(\w+)", answer("scontrol", "-o", "show", "job", job))
    if found:
        return found.group(1)
    words = answer("sacct", "-X", "-n", "-P", "-j", job, "-o", "State").split()
    return words[0] if words else ""


def main():
    job = sys.argv[1].split(";")[0]
    for _ in range(5):
        now = state(job)
        if now:
            print("success" if now == "COMPLETED" else "running" if now in RUNNING else "failed")
            return
        time.sleep(2)
    print("failed")


if __name__ == "__main__":
    main()
