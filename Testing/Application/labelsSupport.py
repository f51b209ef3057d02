"""What the tests of adaptiso-labels share: label maps with known answers, and a case that runs it."""

import csv
import json
import subprocess

from support import BIN, OK, ApplicationTest, Image

LABELS = str(BIN / "adaptiso-labels")


def label_map(size, label, kind="h", spacing=(1, 1, 1), origin=(0, 0, 0)):
    """label(i, j, k) for every voxel."""
    return Image(size, kind, [label(i, j, k) for k in range(size[2]) for j in range(size[1])
                              for i in range(size[0])], spacing, origin)


def three_boxes(kind="h", spacing=(1, 1, 1), origin=(0, 0, 0)):
    """Boxes 1 and 2 side by side, with a smaller one, 7, that lies in both: 3 labels that all meet
    each other, and 0 around."""
    def label(i, j, k):
        if 5 <= i < 11 and 5 <= j < 9 and 4 <= k < 8:
            return 7
        if not (2 <= i < 14 and 2 <= j < 12 and 2 <= k < 10):
            return 0
        return 1 if i < 8 else 2
    return label_map((16, 14, 12), label, kind, spacing, origin)


class LabelsTest(ApplicationTest):
    def run_labels(self, *arguments, timeout=600, **options):
        """Runs adaptiso-labels in the test's folder; stdout and stderr are kept apart."""
        return subprocess.run([LABELS, *map(str, arguments)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=timeout,
                              **options)

    def labels(self, *arguments, **options):
        """The same, and it must succeed."""
        done = self.run_labels(*arguments, **options)
        self.assertEqual(done.returncode, OK, done.stderr)
        return done

    def refused(self, code, pattern, *arguments):
        """It must fail with this code and one line, and write nothing."""
        before = self.files()
        done = self.run_labels(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, pattern)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(self.files(), before)

    def files(self, folder=""):
        """Names and bytes of all files."""
        root = self.path(folder)
        return {str(path.relative_to(root)): path.read_bytes()
                for path in sorted(root.rglob("*")) if path.is_file()}

    def table(self, folder):
        """The rows of regions.tsv by label."""
        with open(self.path(folder) / "regions.tsv", encoding="utf-8", newline="") as file:
            return {int(row["index"]): row for row in csv.DictReader(file, delimiter="\t")}

    def folder_report(self, folder):
        return json.loads((self.path(folder) / "report.json").read_text())
