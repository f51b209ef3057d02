"""The Debian packages and the archive of this build, unpacked into a clean folder and used there."""

import gzip
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from support import SOURCE, ApplicationTest, ball, main, write_nifti

BUILD = Path(os.environ["ADAPTISO_BUILD"])
SOURCES = Path(os.environ["ADAPTISO_SOURCE"])
VERSION = os.environ["ADAPTISO_VERSION"]
REVISION = f"{VERSION}-1"
MOMENT = 1700000000  # s since 1970: 2023-11-14 22:13:20 UTC
PROGRAMS = ("adaptiso", "adaptiso-mesh", "adaptiso-labels", "adaptiso-bem", "adaptiso-check",
            "adaptiso-compare", "adaptiso-simplify", "adaptiso-mend", "adaptiso-bids",
            "adaptiso-giant")


def output(*command, **options):
    done = subprocess.run(list(map(str, command)), text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command}: exit code {done.returncode}\n{done.stdout[-4000:]}")
    return done.stdout


PYTHON_MINOR = sys.version_info.minor  # tests are run by the Python that the package is for


class Packages(ApplicationTest):
    def unpack(self):
        self.debs = self.packed("packages")
        self.prefix = self.path("prefix")
        for deb in self.debs.values():
            output("dpkg-deb", "-x", deb, self.prefix)

    def packed(self, folder, **environment):
        """Packages of this build, {name: file}."""
        output(SOURCES / "Packaging" / "debian.sh", "binary", self.path(folder), BUILD, umask=0o077,
               env={**os.environ, "SOURCE_DATE_EPOCH": str(MOMENT), "DPKG_DEB_COMPRESSOR_TYPE": "gzip",
                    "DPKG_DEB_COMPRESSOR_LEVEL": "1", **environment})
        return {deb.name.split("_")[0]: deb for deb in self.path(folder).glob("*.deb")}

    def field(self, package, name):
        return output("dpkg-deb", "-f", self.debs[package], name).strip()

    # making packages takes a while: one test looks at them from all sides
    def test_packages_are_whole_and_work_from_a_clean_prefix(self):
        self.unpack()
        self.assertEqual(sorted(self.debs), ["adaptiso", "adaptiso-itk", "libadaptiso-dev", "libadaptiso-vtk",
                                             "python3-adaptiso"])
        self.look_at_fields()
        self.look_at_files()
        self.ask_lintian()
        self.look_at_materials()
        self.look_for_traces()
        self.pack_again()
        self.use_programs()
        self.use_library()
        self.use_python()

    def test_build_without_python_makes_no_empty_package_of_it(self):
        self.path("source").mkdir()
        self.path("source/CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(partial NONE)\n"
            "foreach(component programs itk development vtk)\n"
            "install(FILES CMakeLists.txt DESTINATION share/${component} COMPONENT ${component})\nendforeach()\n")
        output("cmake", "-S", self.path("source"), "-B", self.path("partial"))
        done = subprocess.run([SOURCE / "Packaging" / "debian.sh", "binary", self.path("debs"), self.path("partial")],
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(f"{self.path('partial')} lacks what python3-adaptiso is made of", done.stdout)
        self.assertEqual(list(self.path("debs").glob("*.deb")), [])

    def look_at_fields(self):
        for package in self.debs:
            self.assertEqual(self.field(package, "Version"), REVISION)
        needed = self.field("adaptiso", "Depends")
        for library in ("libc6", "libgdcm3", "libtbb12"):
            self.assertIn(library, needed)
        for package in ("adaptiso", "python3-adaptiso"):  # ITK, with VTK, fills 700 MB on Debian 13
            for library in ("libinsighttoolkit", "libvtk"):
                self.assertNotIn(library, self.field(package, "Depends"))
        self.assertIn("libinsighttoolkit5", self.field("adaptiso-itk", "Depends"))
        self.assertNotIn("-dev", needed)
        self.assertIn("libtbb-dev", self.field("libadaptiso-dev", "Depends"))
        filters = self.field("libadaptiso-vtk", "Depends")
        for needed in (f"libadaptiso-dev (= {REVISION})", "libvtk9-dev"):
            self.assertIn(needed, filters)
        python = self.field("python3-adaptiso", "Depends")
        self.assertIn(f"python3 (>= 3.{PYTHON_MINOR}~)", python)
        for needed in (f"python3 (<< 3.{PYTHON_MINOR + 1})", "python3-numpy", "libtbb12"):
            self.assertIn(needed, python)

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
        cohort = self.prefix / "usr/share/doc/adaptiso/examples/cohort"
        for script in ("submit.sh", "slurm/status.py"):
            self.assertTrue(os.access(cohort / script, os.X_OK), script)
        giant = self.prefix / "usr/share/doc/adaptiso/examples/giant"
        self.assertTrue(os.access(giant / "submit.sh", os.X_OK))
        for header in ("vtkAdaptisoIsosurface.h", "vtkAdaptisoSimplify.h"):
            self.assertIn(f"usr/include/adaptiso/VtkAdaptor/{header}", files)
        self.assertTrue([file for file in files if file.endswith("/adaptiso/itk/libadaptisoItkIO.so")])
        for package in self.debs:
            self.assertIn(f"usr/share/doc/{package}/copyright", files)
            self.assertIn(f"usr/share/doc/{package}/changelog.gz", files)
            self.assertIn(f"usr/share/doc/{package}/changelog.Debian.gz", files)

    def ask_lintian(self):
        """Debian's checker of packages finds neither errors nor warnings."""
        self.assertIsNotNone(shutil.which("lintian"), "lintian is missing: see Testing/packages.txt")
        done = subprocess.run(["lintian", "--no-cfg", "--allow-root", *map(str, self.debs.values())],
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual((done.returncode, done.stdout), (0, ""))

    def look_at_materials(self):
        """The bill of materials: whole, and with all that the programs are linked to."""
        said = json.loads((self.prefix / "usr/share/doc/adaptiso/adaptiso.spdx.json").read_text())
        self.assertEqual((said["spdxVersion"], said["dataLicense"], said["SPDXID"]),
                         ("SPDX-2.3", "CC0-1.0", "SPDXRef-DOCUMENT"))
        self.assertRegex(said["creationInfo"]["created"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assertRegex(said["documentNamespace"], r"^https://[^\s#]+$")
        parts = {part["SPDXID"]: part for part in said["packages"]}
        self.assertEqual(len(parts), len(said["packages"]))
        for name, part in parts.items():
            self.assertRegex(name, r"^SPDXRef-[A-Za-z0-9.-]+$")
            for key in ("name", "downloadLocation", "licenseConcluded", "licenseDeclared",
                        "copyrightText"):
                self.assertIn(key, part)
        for relation in said["relationships"]:
            for end in (relation["spdxElementId"], relation["relatedSpdxElement"]):
                self.assertIn(end, {"SPDXRef-DOCUMENT", *parts})
        versions = {part["name"]: part.get("versionInfo") for part in parts.values()}
        self.assertEqual(versions["adaptiso"], VERSION)
        # dpkg-shlibdeps found these by its own way; "libc6 (>= 2.34), libtbb12 (>= 2021.4)"
        for needed in self.field("adaptiso", "Depends").split(", "):
            package = needed.split(" ")[0]
            self.assertEqual(versions[package],
                             output("dpkg-query", "-W", "-f", "${Version}\n", package).split()[0])
        self.assertIn("nlohmann-json3-dev", versions)  # headers leave no trace in a program

    def look_for_traces(self):
        """Nothing says in which folder, when or by whom it was built."""
        folders = [str(path).encode() for path in (BUILD, SOURCES)]
        for path in self.prefix.rglob("*"):
            if not path.is_file():
                continue
            content = path.read_bytes()
            if path.suffix == ".gz":
                content = gzip.decompress(content)
            for folder in folders:
                self.assertNotIn(folder, content, path)
        for deb in self.debs.values():
            for line in output("dpkg-deb", "-c", deb, env={**os.environ, "TZ": "UTC"}).splitlines():
                _, owner, _, day, hour, *_ = line.split()
                self.assertEqual((owner, day, hour), ("root/root", "2023-11-14", "22:13"), line)

    def pack_again(self):
        """The same build packed elsewhere, in another place of the world, gives the same bytes."""
        again = self.packed("elsewhere/deeper", TZ="Pacific/Kiritimati", LC_ALL="C.UTF-8")
        for name, deb in self.debs.items():
            self.assertEqual(deb.read_bytes(), again[name].read_bytes(), name)

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

    def use_python(self):
        """import adaptiso from the unpacked package, and the same mesh as the program's."""
        package = self.prefix / "usr/lib/python3/dist-packages"
        script = """
import adaptiso, sys
mesh = adaptiso.surface("ball.nii", 100)
mesh.save("python.stl")
print(adaptiso.__version__, adaptiso.__file__)
"""
        version, file = output("/usr/bin/python3", "-B", "-c", script, cwd=self.folder,
                               env={"PYTHONPATH": str(package), "LANG": "C.UTF-8"}).split()
        self.assertEqual(version, VERSION)
        self.assertEqual(file, str(package / "adaptiso" / "__init__.py"))
        self.assertEqual(self.path("python.stl").read_bytes(), self.path("ball.stl").read_bytes())

    def test_archive_holds_the_libraries_that_it_needs(self):
        archive = Path(output(SOURCES / "Packaging" / "archive.sh", BUILD, self.folder,
                              env={**os.environ, "SOURCE_DATE_EPOCH": str(MOMENT)}).strip())
        self.assertLess(archive.stat().st_size, 60e6)
        output("tar", "-xzf", archive, "-C", self.folder)
        tree = self.path(archive.name.removesuffix(".tar.gz"))
        runtime = ("libc.so", "libm.so", "libdl.so", "libpthread.so", "librt.so", "libresolv.so")
        for program in PROGRAMS:
            for line in output("ldd", tree / "bin" / program, env={"LANG": "C"}).splitlines():
                library = line.split()[0]
                if "=>" in line and not library.startswith(runtime):
                    self.assertIn(f"=> {tree}/", line)
        only = {"PATH": f"{tree}/bin", "LANG": "C.UTF-8"}
        write_nifti(self.path("ball.nii"), ball(24, 9))
        output("adaptiso-mesh", "ball.nii", "--iso", "100", "-o", "ball.stl", cwd=self.folder, env=only)
        script = "import adaptiso; adaptiso.surface('ball.nii', 100).save('python.stl')"
        output("/usr/bin/python3", "-B", "-c", script, cwd=self.folder,
               env={"PYTHONPATH": str(tree / "python"), "LANG": "C.UTF-8"})
        self.assertEqual(self.path("python.stl").read_bytes(), self.path("ball.stl").read_bytes())


if __name__ == "__main__":
    main()
