"""The same surface of many scans, several at a time.

cohort.py OUTPUT IMAGE...: makes OUTPUT/<image>.stl of each. Threads do: adaptiso works without
Python's lock. One scan that can't be used does not end the rest; the exit code is 1 then.
"""

import concurrent.futures
import os
import pathlib
import sys

import adaptiso


def make(image, folder):
    mesh = adaptiso.surface(image, "auto", max_error=0.5, largest=True, threads=1)
    mesh.save(folder / (image.name.split(".")[0] + ".stl"))
    return mesh


if len(sys.argv) < 3:
    sys.exit("usage: cohort.py OUTPUT IMAGE...")
folder, images = pathlib.Path(sys.argv[1]), [pathlib.Path(name) for name in sys.argv[2:]]
if len({image.name.split(".")[0] for image in images}) < len(images):
    sys.exit("cohort.py: two images have one name, and so would their surfaces")
folder.mkdir(exist_ok=True)
with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    jobs = {pool.submit(make, image, folder): image for image in images}
    failed = 0
    for job in concurrent.futures.as_completed(jobs):
        try:
            print(f"{jobs[job].name}: {job.result()}")
        except adaptiso.Error as error:
            failed += 1
            print(f"{jobs[job].name}: {error}")
print(f"{len(images) - failed} of {len(images)} made")
sys.exit(1 if failed else 0)
