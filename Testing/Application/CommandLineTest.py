"""Options: what is refused as wrong usage (exit code 2), and what the help says."""

import re

from support import SOURCE, USAGE, ApplicationTest, ball, main, write_nifti

README = SOURCE / "Applications" / "adaptiso-mesh" / "README.md"


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

    def test_version_names_the_libraries(self):
        done = self.mesh("--version")
        self.assertRegex(done.stdout, r"^adaptiso-mesh \d+\.\d+\.\d+\n.*ITK \d+\.\d+.*oneTBB \d+\.\d+")
        self.assertEqual(done.stderr, "")


if __name__ == "__main__":
    main()
