"""The recipes of CONTRIBUTING.md, followed on a copy of a module's sources: a mesh format and a label table are three
files each, as are a check and its option; an option is two. What changed is compiled as the build folder compiles its
like, and linked before the module's library into its unit tests.

recipes.py SOURCE BUILD NINJA mesh|labels|check|option"""
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = 77
RECIPES = Path(__file__).parent / "recipes"


class Copy:
    """A module's sources in a folder of their own."""

    def __init__(self, source: Path, build: Path, ninja: str, module: str, folder: Path):
        self.build, self.ninja, self.module, self.folder = build, ninja, module, folder
        self.original = source / "Modules" / module
        shutil.copytree(self.original, folder / module)
        self.commands = {Path(entry["file"]): shlex.split(entry["command"])
                         for entry in json.loads((build / "compile_commands.json").read_text())}

    def add(self, name: str) -> None:
        shutil.copy(RECIPES / name, self.folder / self.module / "src" / name)

    def insert(self, name: str, line: str, before: str) -> None:
        path = self.folder / self.module / name
        text = path.read_text()
        assert before in text, f"{name} lacks {before!r}"
        path.write_text(text.replace(before, line + before, 1))

    def touched(self) -> list:
        return sorted(str(path.relative_to(self.folder / self.module)) for path in (self.folder / self.module).rglob("*")
                      if path.is_file() and not same(path, self.original / path.relative_to(self.folder / self.module)))

    def of_test(self, name: str) -> Path:
        """the test, or the unit of a unity build that includes it"""
        return next(path for path in self.commands if path.name == name
                    or (path.name.startswith("unity_") and f"/{name}\"" in path.read_text()))

    def compile(self, file: Path, like: Path) -> str:
        words = list(self.commands[like])
        output = str(self.folder / (file.stem + ".o"))
        words[words.index("-o") + 1] = output
        words[words.index("-c") + 1] = str(file)
        words = [word for word in words if "ccache" not in word] + ["-O0"]  # compiling takes most of the time
        words[1:1] = [f"-I{self.folder / self.module / name}" for name in ("include", "src")]
        subprocess.run(words, check=True, cwd=self.build)
        return output

    def run_tests(self, objects: list, only: str) -> None:
        """\\param objects  take the place of the tests' own of the same names"""
        target, library = f"test{self.module}", f"libadaptiso{self.module}.a"
        # " : && c++ ... -o test ... && : "
        commands = subprocess.run([self.ninja, "-t", "commands", target], cwd=self.build, text=True, check=True,
                                  capture_output=True).stdout.splitlines()
        names = {Path(name).stem for name in objects}
        link = [word for word in shlex.split(commands[-1].split("&&")[1]) if Path(word).name[:-len(".cxx.o")] not in names]
        at = next(n for n, word in enumerate(link) if word.endswith(library))
        link[at:at] = objects
        program = str(self.folder / target)
        link[link.index("-o") + 1] = program
        subprocess.run(link, check=True, cwd=self.build)
        tests = subprocess.run([program, f"--gtest_filter={only}", "--gtest_brief=1"], cwd=self.folder, text=True,
                               capture_output=True, env={**os.environ, "ADAPTISO_RENEW_PAGES": ""})
        print(tests.stdout[-4000:])
        assert tests.returncode == 0 and " 0 tests ran" not in tests.stdout, tests.stdout[-4000:]


def same(a: Path, b: Path) -> bool:
    return b.exists() and a.read_bytes() == b.read_bytes()


def mesh(copy: Copy) -> list:
    copy.add("Plain.cxx")
    copy.insert("src/Formats.cxx", "extern const Codec kPlainCodec;\n", "extern const Codec kVtkXmlCodec")
    copy.insert("src/Formats.cxx", 'constexpr Extensions kPlain = {".plain"};\n', "constexpr Extensions kOpenMeeg")
    copy.insert("src/Formats.cxx", '{"Plain", kPlain, &meshio::kPlainCodec, Text, Ras, no, yes, yes, no, no, no, no, yes, kInt32},\n',
                "    // read alone")
    copy.insert("CMakeLists.txt", "    src/Plain.cxx\n", "    src/Ply.cxx")
    sources = copy.folder / copy.module / "src"
    like = copy.original / "src" / "Formats.cxx"
    copy.run_tests([copy.compile(sources / name, like) for name in ("Plain.cxx", "Formats.cxx")],
                   "*/plain*:MeshFormats.*:MeshFile.*:EveryFile.*:-*OfTheirPage")
    return copy.touched()


def labels(copy: Copy) -> list:
    copy.add("ListedTables.cxx")
    copy.insert("src/LabelTable.cxx", "extern const TableCodec kListedTables;\n", "extern const TableCodec kDelimitedTables")
    copy.insert("src/LabelTable.cxx", '{"listed names", {".listed"}, &kListedTables, "names in their order"},\n',
                '    {"FreeSurfer, MRtrix"')
    copy.insert("CMakeLists.txt", "    src/ListedTables.cxx\n", "    src/Rows.cxx")
    sources = copy.folder / copy.module / "src"
    like = copy.original / "src" / "LabelTable.cxx"
    test = copy.of_test("LabelTableTest.cxx")
    copy.run_tests([copy.compile(RECIPES / "ListedTablesTest.cxx", test),
                    *(copy.compile(sources / name, like) for name in ("ListedTables.cxx", "LabelTable.cxx"))],
                   "-*OfTheirPage")
    return copy.touched()


def check(copy: Copy) -> list:
    header = "include/adaptiso/SurfaceChecks/Checks.h"
    copy.insert(header, "    std::optional<double> maxAreaMm2;\n", "    std::optional<double> maxOffMm;")
    copy.insert("src/Checks.cxx", 'constexpr CheckRule kArea{"area", "area", "the area is as asked for", false, false, false};\n',
                "constexpr std::array kCheckRules")
    copy.insert("src/Checks.cxx", "kArea, ", "kGenus,")
    copy.insert("src/Checks.cxx", "addUnless(kArea, facts_.areaMm2 > rules_.maxAreaMm2.value_or(facts_.areaMm2), \"too large\");\n",
                "        const auto genus =")
    copy.insert("src/CheckRules.cxx", """option<&CheckRules::maxAreaMm2>({.name = "max-area", .key = "maxAreaMm2", .valueName = "MM2",
        .help = "Largest area that passes", .rule = {.least = 0, .unit = "mm2"}}),\n""",
                "        option<&CheckRules::maxOffMm>(")
    like = copy.original / "src" / "Checks.cxx"
    test = copy.of_test("ChecksTest.cxx")
    copy.run_tests([copy.compile(RECIPES / "AreaTest.cxx", test), copy.compile(test, test),
                    *(copy.compile(copy.folder / copy.module / "src" / name, like)
                      for name in ("Checks.cxx", "CheckRules.cxx", "SurfaceFacts.cxx"))], "-*OfTheirPage")
    return copy.touched()


def option(copy: Copy) -> list:
    copy.insert("include/adaptiso/Tetrahedra/MesherFiles.h", "    std::optional<double> radiusEdge{};\n", "\n    bool isRequested()")
    copy.insert("src/MesherFiles.cxx", """option<&MesherOptions::radiusEdge>({.name = "radius-edge", .key = "radiusEdge", .valueName = "R",
        .help = "Largest radius by shortest edge", .standard = "1.4", .rule = {.least = 1, .isAbove = true}}),\n""",
                "option<&MesherOptions::elementMm>(")
    copy.insert("src/MesherFiles.cxx", """    if (options.mesher == "tetgen" && options.radiusEdge)
        return {"tetgen", {"-pq" + shortestText(*options.radiusEdge) + "/10aAQ", "head.poly"}, {}, {}, {}};\n""",
                '    if (options.mesher == "tetgen") {')
    # where all rows are taken: the command line (--help, pages, README, types for npm) and Python (types, docstrings)
    for taker in ("Applications/Common/Mesher.cxx", "Wrapping/Python/src/OptionRows.cxx"):
        assert "elementOptions()" in (copy.original.parents[1] / taker).read_text(), taker
    test = copy.of_test("MesherFilesTest.cxx")
    copy.run_tests([copy.compile(RECIPES / "RadiusEdgeTest.cxx", test),
                    copy.compile(copy.folder / copy.module / "src/MesherFiles.cxx", copy.original / "src/MesherFiles.cxx")],
                   "RadiusEdge*:Mesher*")
    return copy.touched()


def main() -> int:
    source, build, ninja, which = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3], sys.argv[4]
    if not ninja.endswith("ninja") or not (build / "compile_commands.json").exists():
        print("needs a build folder of ninja with compile_commands.json")
        return SKIPPED
    module, recipe = {"mesh": ("MeshIO", mesh), "labels": ("LabelNames", labels), "check": ("SurfaceChecks", check),
                      "option": ("Tetrahedra", option)}[which]
    with tempfile.TemporaryDirectory() as folder:
        touched = recipe(Copy(source, build, ninja, module, Path(folder)))
    print(f"{len(touched)} files of the module touched: {', '.join(touched)}")
    return 0 if len(touched) <= 3 else 1


sys.exit(main())
