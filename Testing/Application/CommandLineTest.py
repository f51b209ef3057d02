"""Options: what is refused as wrong usage (exit code 2), and what the help says."""

import json
import re
import subprocess

from support import BIN, SOURCE, USAGE, ApplicationTest, ball, main, write_nifti

PROGRAMS = ("adaptiso-mesh", "adaptiso-labels", "adaptiso-bem", "adaptiso-check",
            "adaptiso-compare", "adaptiso-simplify", "adaptiso-mend", "adaptiso-bids",
            "adaptiso-giant")
README = SOURCE / "Applications" / "adaptiso-mesh" / "README.md"


def run_program(folder, *command):
    return subprocess.run([BIN / command[0], *command[1:]], cwd=folder, text=True,
                          capture_output=True, timeout=120)


class WrongUsage(ApplicationTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("ball.nii"), ball(8, 3))

    def refused(self, pattern, *arguments):
        done = self.assert_fails(USAGE, pattern, *arguments)
        self.assertIn("--help", done.stderr)

    def test_no_arguments(self):
        self.refused("INPUT")

    def test_no_isovalue(self):
        self.refused("--iso", "ball.nii")

    def test_isovalue_without_a_number(self):
        for text in ("nan", "inf", "-inf", "1e999", "-1e999", "12x", "x", "", " 5", "0x10", "5,6"):
            with self.subTest(text):
                self.refused(r"--iso.* (finite number|empty)", "ball.nii",
                             f"--iso={text}")

    def test_the_same_isovalue_twice(self):
        self.refused("--iso 100.0: given twice", "ball.nii", "--iso", "100", "--iso", "100.0")
        self.refused("--iso auto: given twice", "ball.nii", "--iso", "auto", "--iso", "auto")

    def test_unknown_words(self):
        for option in ("--method", "--block-size", "--border", "--search", "--coordinates"):
            with self.subTest(option):
                self.refused(option, "ball.nii", "--iso", "100", option, "3")

    def test_unknown_options(self):
        self.refused("--frobnicate", "ball.nii", "--iso", "100", "--frobnicate")

    # CLI11 would take "=a.vtp" and "utput" for the file's name
    def test_no_equals_sign_goes_behind_a_letter(self):
        for option in ("-o=a.vtp", "-qo=a.vtp"):
            with self.subTest(option):
                self.refused("--output: no = goes between -o and its value; give -o a.vtp or "
                             "--output=a.vtp", "ball.nii", "--iso", "100", option)
        self.refused("give -o OUT or", "ball.nii", "--iso", "100", "-o=")
        self.refused("--quiet: takes no value", "ball.nii", "--iso", "100", "-q=1")
        self.refused("-output: there is no such option; did you mean --output", "ball.nii", "--iso",
                     "100", "-output", "a.vtp")
        self.assertEqual(self.names(), ["ball.nii"])

    def test_two_inputs_for_one_output(self):
        self.refused("{name}", "ball.nii", "other.nii", "--iso", "100", "-o", "a.vtp")

    def test_threads_must_be_a_positive_number(self):
        for text in ("0", "-1", "1.5", "many", "99999999999"):
            with self.subTest(text):
                self.refused("--threads", "ball.nii", "--iso", "100", "--threads", text)

    def test_min_volume_must_be_a_volume(self):
        for text in ("-1", "nan", "big"):
            with self.subTest(text):
                self.refused("--min-volume", "ball.nii", "--iso", "100", f"--min-volume={text}")

    def test_pieces_of_an_open_surface(self):
        for option in (["--fill-cavities"], ["--min-volume", "5"]):
            with self.subTest(option):
                self.refused("closed surfaces", "ball.nii", "--iso", "100", "--border", "open",
                             *option)

    def test_adjusted_vertices_of_another_method(self):
        for method in ([], ["--method", "boxes"], ["--method", "mc"]):
            with self.subTest(method):
                self.refused("--adjust-vertices: .*dmc", "ball.nii", "--iso", "100",
                             "--adjust-vertices", *method)

    def test_two_counts(self):
        self.refused("--triangles and --reduction: are two ways to ask for one count", "ball.nii",
                     "--iso", "100", "--triangles", "100", "--reduction", "0.5")

    def test_merging_within_blocks_of_another_method(self):
        for method in ([], ["--method", "boxes"], ["--method", "asc"], ["--method", "mc"]):
            with self.subTest(method):
                self.refused("--merge-within-blocks: .*dmc", "ball.nii", "--iso", "100",
                             "--merge-within-blocks", *method)

    def test_unknown_output_format_is_told_before_the_input_is_read(self):
        for name in ("out.xyz", "out", "out.nii", ".vtp"):
            with self.subTest(name):
                self.refused(re.escape(name), "missing.nii", "--iso", "100", "-o", name)

    def test_report_and_mesh_under_one_name(self):
        self.refused("--json", "ball.nii", "--iso", "100", "-o", "a.vtp", "--json", "a.vtp")
        self.refused("--json", "ball.nii", "--iso", "100", "-o", "a.vtp", "--json", "./a.vtp")


class Help(ApplicationTest):
    def test_goes_to_stdout_and_is_no_error(self):
        for option in ("--help", "-h"):
            done = self.mesh(option)
            self.assertIn("Usage: ", done.stdout)
            self.assertEqual(done.stderr, "")

    def test_h_is_one_screen_with_every_option(self):
        for program in PROGRAMS:
            short = run_program(self.folder, program, "-h").stdout
            self.assertLessEqual(len(short.splitlines()), 46, program)
            self.assertLessEqual(max(map(len, short.splitlines())), 100, program)
            said = json.loads(run_program(self.folder, program, "--help-json").stdout)
            for option in filter(lambda option: option["names"], said["options"]):
                self.assertTrue(set(option["names"]) & set(re.findall(r"--[\w-]+", short)), option["names"])

    def test_tells_examples_exit_codes_and_formats(self):
        text = self.mesh("--help").stdout
        for word in ("Examples:", "Exit codes:", ".vtp", ".stl", ".gii", ".pial", ".tri", "Otsu",
                     "ras", "lps", "tkras", "voxel"):
            self.assertIn(word, text)

    def test_names_the_options_that_the_readme_names(self):
        def options(text):
            return set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", text))
        used = options("\n".join(re.findall(r"`[^`]*`", README.read_text())))
        self.assertEqual(options(self.mesh("--help").stdout) - used, set())
        self.assertEqual(used - options(self.mesh("--help").stdout), set())

    def test_readmes_name_the_options_of_every_program(self):
        """In the program's README or, for options that it shares, in that of adaptiso-mesh."""
        def named(program):
            text = (SOURCE / "Applications" / program / "README.md").read_text()
            return set(re.findall(r"(?<![\w-])--?[a-z][\w-]*",
                                  "\n".join(re.findall(r"(?s)```.*?```|`[^`]*`", text))))
        for program in PROGRAMS:
            used = named(program) | named("adaptiso-mesh")
            said = json.loads(run_program(self.folder, program, "--help-json").stdout)
            for option in said["options"]:
                if option["names"]:
                    self.assertTrue(used & set(option["names"]), (program, option["names"]))

    def test_version_names_the_library_of_threads(self):
        done = self.mesh("--version")
        self.assertRegex(done.stdout, r"\Aadaptiso-mesh \d+\.\d+\.\d+\noneTBB \d+\.\d+\.\d+\n\Z")
        self.assertEqual(done.stderr, "")

    def test_version_has_the_same_letter_in_every_program(self):
        for program in ("adaptiso", *PROGRAMS):
            with self.subTest(program):
                said = [run_program(self.folder, program, option) for option in ("-v", "--version")]
                self.assertEqual([done.returncode for done in said], [0, 0])
                self.assertRegex(said[0].stdout, rf"^{program} \d+\.\d+\.\d+\n")
                self.assertEqual(said[0].stdout, said[1].stdout)


class OneCommand(ApplicationTest):
    """`adaptiso mesh ...` is `adaptiso-mesh ...`."""

    def test_lists_every_program(self):
        done = run_program(self.folder, "adaptiso")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        listed = re.findall(r"(?m)^  ([a-z]+)  +\S.*", done.stdout)
        self.assertEqual(["adaptiso-" + word for word in listed], list(PROGRAMS))
        self.assertEqual(run_program(self.folder, "adaptiso", "--help").stdout, done.stdout)

    def test_starts_each_program(self):
        for program in PROGRAMS:
            with self.subTest(program):
                word = program.removeprefix("adaptiso-")
                self.assertEqual(run_program(self.folder, "adaptiso", word, "--help").stdout,
                                 run_program(self.folder, program, "--help").stdout)

    def test_passes_arguments_output_and_exit_code(self):
        write_nifti(self.path("ball.nii"), ball(8, 3))
        done = run_program(self.folder, "adaptiso", "mesh", "ball.nii", "--iso", "100", "-o", "a b.ply")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("a b.ply", done.stdout)
        run_program(self.folder, "adaptiso-mesh", "ball.nii", "--iso", "100", "-o", "other.ply")
        self.assertEqual(self.path("a b.ply").read_bytes(), self.path("other.ply").read_bytes())
        done = run_program(self.folder, "adaptiso", "mesh", "no.nii", "--iso", "100")
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, "^adaptiso-mesh: ")

    def test_is_found_from_any_folder_and_through_a_link(self):
        link = self.path("link")
        link.symlink_to(BIN / "adaptiso")
        done = subprocess.run([link, "check", "--version"], cwd="/", text=True, capture_output=True)
        self.assertRegex(done.stdout, "^adaptiso-check ")

    def test_finds_options_by_the_words_of_other_tools(self):
        done = run_program(self.folder, "adaptiso", "help", "decimate")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("adaptiso-mesh\ndecimate: did you mean --reduction?\n\n", done.stdout)
        self.assertIn("adaptiso-bem\ndecimate: did you mean --vertices?\n\n", done.stdout)
        done = run_program(self.folder, "adaptiso", "help", "no-such-word")
        self.assertEqual(done.returncode, USAGE)
        self.assertIn("help no-such-word: no program or option is named so, and no help has the word", done.stderr)
        done = run_program(self.folder, "adaptiso", "help", "no", "such", "word")
        self.assertIn("help no-such-word: no program", done.stderr)
        self.assertIn("--max-hole", run_program(self.folder, "adaptiso", "help", "fill", "holes").stdout)
        # hyphens or none, and words by their beginning: ico is not in DICOM
        self.assertIn("--lead-field", run_program(self.folder, "adaptiso", "help", "leadfield").stdout)
        self.assertNotIn("adaptiso-mesh", run_program(self.folder, "adaptiso", "help", "ico").stdout)

    def test_refuses_other_words(self):
        done = run_program(self.folder, "adaptiso", "mehs", "--iso", "3")
        self.assertEqual(done.returncode, USAGE)
        done = run_program(self.folder, "adaptiso", "mehs")
        self.assertEqual(done.returncode, USAGE)
        self.assertIn("mehs: there is no such program; did you mean mesh?", done.stderr)


if __name__ == "__main__":
    main()
