"""The examples of adaptiso-simplify's README.md, run as they stand."""

import os
import re
import subprocess

from support import BIN, main
from headDefects import icosphere
from simplifySupport import (README, SimplifyTest, annot_table, patch, ply, write_annot,
                             write_curv, write_pial)


class Readme(SimplifyTest):
    def test_examples_run(self):
        ball = icosphere(10, 4)
        self.write("bone.off", ball)
        self.simplify("bone.off", "--reduction", "0", "-o", "bone.stl")
        self.path("bone.off").unlink()
        write_pial(self.path("lh.pial"), ball)
        write_curv(self.path("lh.thickness"), [p[2] for p in ball[0]])
        write_annot(self.path("lh.aparc.annot"), [1] * len(ball[0]), annot_table(["one"]))
        self.path("patch.ply").write_text(ply(patch()))
        given = set(self.names())
        examples = re.search(r"## Examples.*?```sh\n(.*?)```", README.read_text(), re.DOTALL)
        done = subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", examples.group(1)],
                              cwd=self.folder, env={**os.environ, "PATH": f"{BIN}:/usr/bin:/bin"},
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (0, "not sound\n"), done.stderr)
        self.assertRegex(done.stderr, "^adaptiso-simplify: patch.ply: is not sound, [^\n]*\n$")
        self.assertEqual(set(self.names()) - given, {"fewer", "many", "patch.html", "patch.vtp",
                                                     "report.json", "small.stl", "tenth.vtp"})
        self.assertEqual({p.name for p in self.path("fewer").iterdir()},
                         {"lh.pial", "lh.thickness", "lh.aparc.annot"})
        self.assertLessEqual({"bone.stl", "lh.pial", "patch.ply", "summary.html"},
                             {p.name for p in self.path("many").iterdir()})


if __name__ == "__main__":
    main()
