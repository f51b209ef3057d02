"""The Debian packages of this build, unpacked into a clean prefix and used from there."""

import gzip
import json
import os
import shutil
import subprocess
from pathlib import Path

from support import SOURCE, ApplicationTest, ball, main, write_nifti

BUILD = Path(os.environ["ADAPTISO_BUILD"])
VERSION = os.environ["ADAPTISO_VERSION"]
PROGRAMS = ("adaptiso-mesh", "adaptiso-bem", "adaptiso-check", "adaptiso-compare")


def output(*command, **options):
    done = subprocess.run(list(map(str, command)), text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command}: exit code {done.returncode}\n{done.stdout[-4000:]}")
    return done.stdout


class Packages(ApplicationTest):
    def setUp(self):
        super().setUp()
        output(os.environ["ADAPTISO_CPACK"], "-G", "DEB", "-B", self.path("packages"), cwd=BUILD)
        self.debs = {deb.name.split("_")[0]: deb for deb in self.path("packages").glob("*.deb")}
        self.prefix = self.path("prefix")
        for deb in self.debs.values():
            output("dpkg-deb", "-x", deb, self.prefix)

    def field(self, package, name):
        return output("dpkg-deb", "-f", self.debs[package], name).strip()

    # making packages takes a while: one test looks at them from all sides
    def test_packages_are_whole_and_work_from_a_clean_prefix(self):
        self.assertEqual(sorted(self.debs), ["adaptiso", "libadaptiso-dev"])
        self.look_at_fields()
        self.look_at_files()
        self.ask_lintian()
        self.use_programs()
        self.use_library()

    def look_at_fields(self):
        for package in self.debs:
            self.assertEqual(self.field(package, "Version"), VERSION)
        needed = self.field("adaptiso", "Depends")
        for library in ("libc6", "libinsighttoolkit5", "libvtk9", "libtbb12"):
            self.assertIn(library, needed)
        self.assertNotIn("-dev", needed)
        self.assertIn("libtbb-dev", self.field("libadaptiso-dev", "Depends"))

    def look_at_files(self):
        files = {str(path.relative_to(self.prefix)) for path in self.prefix.rglob("*")
                 if path.is_file()}
        for program in PROGRAMS:
            wanted = {f"usr/bin/{program}", f"usr/share/man/man1/{program}.1.gz",
                      f"usr/share/bash-completion/completions/{program}",
                      f"usr/share/zsh/vendor-completions/_{program}",
                      f"usr/share/doc/adaptiso/Applications/{program}/README.md"}
            self.assertEqual(wanted - files, set())
            page = gzip.decompress((self.prefix / f"usr/share/man/man1/{program}.1.gz").read_bytes())
            self.assertIn(program.upper().replace("-", "\\-"), page.decode())
        for package in self.debs:
            self.assertIn(f"usr/share/doc/{package}/copyright", files)
            changes = gzip.decompress(
                (self.prefix / f"usr/share/doc/{package}/changelog.gz").read_bytes())
            self.path("changelog").write_bytes(changes)
            for field, value in (("Source", "adaptiso"), ("Version", VERSION)):
                self.assertEqual(output("dpkg-parsechangelog", "-l", self.path("changelog"), "-S",
                                        field).strip(), value)
            for line in changes.decode().splitlines():
                self.assertLessEqual(len(line), 80)

    def ask_lintian(self):
        """Debian's checker of packages finds neither errors nor warnings."""
        self.assertIsNotNone(shutil.which("lintian"), "lintian is missing: see Testing/packages.txt")
        done = subprocess.run(["lintian", "--no-cfg", "--allow-root", *map(str, self.debs.values())],
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual((done.returncode, done.stdout), (0, ""))

    def use_programs(self):
        write_nifti(self.path("ball.nii"), ball(24, 9))
        only = {"PATH": f"{self.prefix}/usr/bin:/bin", "LANG": "C.UTF-8"}
        for program in PROGRAMS:
            self.assertIn(f"{program} {VERSION}", output(program, "--version", env=only))
        output("adaptiso-mesh", "ball.nii", "--iso", "100", "-o", "ball.stl", cwd=self.folder, env=only)
        said = json.loads(output("adaptiso-check", "ball.stl", "--json", "-", cwd=self.folder,
                                 env=only))
        self.assertTrue(said["passed"])

    def use_library(self):
        """The example that users copy, built against the unpacked package."""
        example = self.prefix / "usr/share/doc/libadaptiso-dev/examples/meshScan"
        self.assertTrue((SOURCE / "Examples" / "meshScan").is_dir())
        cmake = os.environ["ADAPTISO_CMAKE"]
        output(cmake, "-S", example, "-B", self.path("build"), "-G", "Ninja",
               f"-DCMAKE_PREFIX_PATH={self.prefix}/usr", "-DCMAKE_BUILD_TYPE=Release")
        output(cmake, "--build", self.path("build"))
        done = output(self.path("build") / "meshScan", "ball.nii", "own.ply", cwd=self.folder)
        self.assertRegex(done, r"^\d+ triangles at \d")
        output(self.prefix / "usr/bin/adaptiso-check", "own.ply", cwd=self.folder)


if __name__ == "__main__":
    main()
