"""What the sources say of themselves: licences, citation, versions, claims. All of it is true."""

import json
import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

BUILD = Path(os.environ["ADAPTISO_BUILD"])
SOURCE = Path(os.environ["ADAPTISO_SOURCE"])
VERSION = os.environ["ADAPTISO_VERSION"]


def text(name):
    return (SOURCE / name).read_text(encoding="utf-8")


class Licences(unittest.TestCase):
    def test_every_file_says_its_licence(self):
        self.assertIsNotNone(shutil.which("reuse"), "reuse is missing: see Testing/packages.txt")
        done = subprocess.run(["reuse", "--root", SOURCE, "lint"], text=True, capture_output=True)
        self.assertEqual(done.returncode, 0, done.stdout[-3000:] + done.stderr)

    def test_the_licence_is_the_one_beside_the_readme(self):
        self.assertEqual(text("LICENSE"), text("LICENSES/Apache-2.0.txt"))


class Names(unittest.TestCase):
    """Two types of one name in one program are undefined behaviour that no linker reports."""

    @staticmethod
    def types(*patterns):
        """Qualified names of the types defined in these files."""
        found = {}
        for file in (file for pattern in patterns for file in sorted(SOURCE.glob(pattern))):
            for space, body in re.findall(r"^namespace ([\w:]+) \{(.*?)^\}  // namespace \1$",
                                          file.read_text(encoding="utf-8"), re.M | re.S):
                for name in re.findall(r"^(?:struct|class|enum class) (\w+)(?: final)?(?: : [^;{]*)? \{",
                                       body, re.M):
                    found.setdefault(f"{space}::{name}", []).append(file.name)
        return found

    def test_no_program_defines_a_type_of_the_libraries_again(self):
        shared = self.types("Modules/*/include/**/*.h", "Modules/*/src/**/*.h", "Applications/Common/*.h")
        self.assertIn("adaptiso::Finding", shared)
        self.assertEqual([name for name, files in shared.items() if len(files) > 1], [])
        for program in SOURCE.glob("Applications/adaptiso-*"):
            own = self.types(f"Applications/{program.name}/*.h")
            self.assertEqual([f"{name}: {shared[name]}" for name in own if name in shared], [], program.name)


class Citation(unittest.TestCase):
    """CITATION.cff, by the rules of its format's version 1.2.0."""

    TYPES = {"thesis", "conference-paper", "article", "book", "software"}

    def setUp(self):
        import yaml
        self.said = yaml.safe_load(text("CITATION.cff"))

    def test_has_what_the_format_requires(self):
        self.assertEqual(self.said["cff-version"], "1.2.0")
        self.assertLessEqual(set(self.said), {
            "cff-version", "message", "type", "title", "abstract", "version", "license", "authors",
            "keywords", "references", "date-released", "doi", "url", "repository-code"})
        for key in ("message", "title"):
            self.assertIsInstance(self.said[key], str)
        self.assertEqual(self.said["type"], "software")
        for author in self.said["authors"]:
            self.assertIn(set(author), ({"name"}, {"family-names", "given-names"}))

    def test_references_are_whole(self):
        for reference in self.said["references"]:
            self.assertLessEqual({"authors", "title", "type"}, set(reference))
            self.assertIn(reference["type"], self.TYPES)
            if "doi" in reference:
                self.assertRegex(reference["doi"], r"^10\.\d{4,9}(\.\d+)?/[A-Za-z0-9:/_;\-.()\[\]\\]+$")

    def test_is_of_this_version_and_licence(self):
        self.assertEqual((self.said["version"], self.said["license"]), (VERSION, "Apache-2.0"))


class Versions(unittest.TestCase):
    def test_the_changelog_begins_with_this_one(self):
        """Every heading says a version and a date."""
        headings = re.findall(r"(?m)^## (.*)$", text("CHANGELOG.md"))
        for heading in headings:
            self.assertRegex(heading, r"^\d+\.\d+\.\d+ \((unreleased|\d{4}-\d\d-\d\d)\)$")
        self.assertEqual(headings[0].split(" ")[0], VERSION)
        numbers = [tuple(map(int, heading.split(" ")[0].split("."))) for heading in headings]
        self.assertEqual(numbers, sorted(numbers, reverse=True))

    def test_the_readme_names_the_packages_of_this_one(self):
        named = set(re.findall(r"adaptiso(?:-dev)?_([\d.]+)-1_", text("README.md")))
        named.update(re.findall(r"^adaptiso \(([\d.]+)-1\)", text("Packaging/debian/changelog")))
        self.assertEqual(named, {VERSION})
        minor = ".".join(VERSION.split(".")[:2])
        for place in ("Documentation/Cpp.md", "Examples/meshScan/CMakeLists.txt"):
            self.assertIn(f"find_package(adaptiso {minor} REQUIRED", text(place))


class Compilation(unittest.TestCase):
    def test_no_sum_is_fused_with_a_product(self):
        """Documentation/Reproducibility.md: what may be fused gives other bytes on other processors."""
        commands = json.loads((BUILD / "compile_commands.json").read_text())
        ours = [(target, command["command"]) for command in commands
                for target in re.findall(r" -o ((?:Modules|Applications)/.*?)\.dir/", command["command"])]
        self.assertLessEqual({"Modules/CMakeFiles/adaptisoCore", "Modules/CMakeFiles/adaptisoExtraction",
                              "Applications/adaptiso-mesh/CMakeFiles/adaptiso-mesh"}, {target for target, _ in ours})
        for target, command in ours:
            self.assertIn(" -ffp-contract=off ", command, target)
            self.assertNotIn("-ffast-math", command)


class Validation(unittest.TestCase):
    def test_the_page_is_in_step_with_claims_and_tests(self):
        done = subprocess.run([sys.executable, "-B", SOURCE / "Documentation" / "validation.py",
                               SOURCE, "--check"], text=True, capture_output=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_a_test_that_is_not_there_is_told(self):
        sys.dont_write_bytecode = True
        sys.path.insert(0, str(SOURCE / "Documentation"))
        import validation
        claims = {"section": [{"claim": [{"tests": ["MarchingCubes.IsPerfect"]}]}]}
        self.assertEqual(validation.check(claims, validation.sources(SOURCE), None),
                         ["MarchingCubes.IsPerfect: there is no such test"])

    def test_one_failed_instance_fails_the_test(self):
        import tempfile
        import validation
        with tempfile.NamedTemporaryFile("w", suffix=".xml") as file:
            file.write('<testsuite><testcase name="All/A.B/mc" status="run"/>'
                       '<testcase name="All/A.B/boxes" status="fail"><failure/></testcase>'
                       '<testcase name="C.D" status="notrun"><skipped/></testcase>'
                       '<testcase name="E.F" status="run"/></testsuite>')
            file.flush()
            self.assertEqual(validation.results(file.name), {
                "A.B": validation.FAILED, "C.D": validation.NOT_RUN, "E.F": validation.PASSED})


class Pages(unittest.TestCase):
    def test_links_lead_somewhere(self):
        """From every page to files of the project, and to headings as GitHub names them."""
        def anchors(page):
            plain = re.sub(r"(?ms)^```.*?^```", "", page.read_text(encoding="utf-8"))
            headings = re.findall(r"(?m)^#+ (.*)$", plain)
            return {re.sub(r"[^\w\- ]", "", re.sub(r"\]\([^)]*\)", "", heading)).lower().replace(" ", "-")
                    for heading in headings}

        pages = [page for page in SOURCE.rglob("*.md")
                 if not {"build", "node_modules"} & set(page.relative_to(SOURCE).parts)]
        self.assertGreater(len(pages), 20)
        for page in pages:
            plain = re.sub(r"(?ms)^```.*?^```", "", page.read_text(encoding="utf-8"))
            for link in re.findall(r"\]\(([^)\s]+)\)", plain):
                if re.match(r"[a-z]+:", link):
                    continue
                name, _, anchor = link.partition("#")
                target = (page.parent / name).resolve() if name else page
                self.assertTrue(target.exists(), f"{page}: {link}")
                if anchor:
                    self.assertIn(anchor, anchors(target), f"{page}: {link}")

    def test_figures_are_as_they_are_drawn(self):
        done = subprocess.run([sys.executable, "-B", SOURCE / "Documentation" / "algorithmFigures.py",
                               "--check"], text=True, capture_output=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
