"""The table of options in each program's README.md, and the types of the npm package's, made from what the programs
say of them."""

import json
import os
import re
import subprocess

from support import BIN, SOURCE, ApplicationTest, main

BEGIN, END = "<!-- made from --help: ADAPTISO_RENEW_PAGES=1 ctest -R OptionTablesTest -->\n", "<!-- end -->\n"
PROGRAMS = sorted(path.name for path in (SOURCE / "Applications").glob("adaptiso-*") if (path / "main.cxx").exists())


TYPES = SOURCE / "Applications/web/npm/options.d.ts"
TYPED = ("bem", "check", "labels", "mend", "mesh", "simplify")
KINDS = {"flag": "boolean", "number": "number", "count": "number", "text": "number | string"}
UNITS = {"mm": "Mm", "mm3": "Mm3", "degrees": "Deg"}
#: Of what the package has not: volumes beside surfaces, meshers.
UNTYPED = ("Preprocessing of the volume", "Tetrahedra")


def options_of(program):
    return json.loads(subprocess.run([BIN / program, "--help-json"], capture_output=True, text=True,
                                     check=True).stdout)["options"]


def typed(row):
    """/** Largest distance. */ maxErrorMm?: number;"""
    name = re.sub("-(.)", lambda after: after[1].upper(), row["name"]) + UNITS.get(row.get("unit"), "")
    words = row.get("words")
    kind = KINDS[row["kind"]] if not words else " | ".join(
        word if word.isdigit() else json.dumps(word) for word in words)
    return f"  /** {row['help']}. */ {name}?: {kind};\n"


def types():
    """An interface for each function, of its program's rows; those of reading an image apart."""
    rows = {function: [typed(option["row"]) for option in options_of(f"adaptiso-{function}") if option["row"]
                       and not option["group"].startswith(UNTYPED) and option["needs"] != ["--volume"]]
            for function in TYPED}
    read = [line for line in rows["mesh"] if line in rows["labels"] and line in rows["bem"]]
    text = "// Generated from the programs' rows of options: ADAPTISO_RENEW_PAGES=1 ctest -R OptionTablesTest. Do not edit.\n"
    for name, lines in {"image": read, **rows}.items():
        base = " extends ImageRows" if lines != read and set(read) <= set(lines) else ""
        text += f"\nexport interface {name.title()}Rows{base} {{\n" + "".join(
            line for line in lines if not base or line not in read) + "}\n"
    return text


def table(program):
    """A heading and a row for each option."""
    text, group = "", None
    for option in options_of(program):
        if option["group"] != group:
            group = option["group"]
            text += ("\n" if text else "") + f"| {group} | |\n| --- | --- |\n"
        names = ", ".join(option["names"]) or option["value"]
        name = names + (" " + option["value"] if option["names"] and option["value"] else "")
        cells = [f"`{name}`", option["description"]]
        text += "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"
    return text


class OptionTables(ApplicationTest):
    def test_say_what_the_programs_say(self):
        self.assertEqual(len(PROGRAMS), 9)
        for program in PROGRAMS:
            with self.subTest(program):
                path = SOURCE / "Applications" / program / "README.md"
                before, begin, rest = path.read_text().partition(BEGIN)
                told, end, after = rest.partition(END)
                self.assertTrue(begin and end, f"{path}: has no table of options")
                made = table(program)
                if os.environ.get("ADAPTISO_RENEW_PAGES"):
                    path.write_text(before + BEGIN + made + END + after)
                else:
                    self.assertEqual(told, made)

    def test_types_of_the_npm_package_are_the_rows(self):
        if os.environ.get("ADAPTISO_RENEW_PAGES"):
            TYPES.write_text(types())
        self.assertEqual(TYPES.read_text(), types())

    def test_the_browser_page_offers_the_words_of_the_programs(self):
        page = (SOURCE / "Applications/web/page/src/page.html").read_text()
        for program, name, select in (("adaptiso-check", "--profile", "profile"),
                                      ("adaptiso-mesh", "--coordinates", "frame")):
            [words] = (option["value"].split("|") for option in options_of(program) if name in option["names"])
            offered = re.findall(r'<option value="([^"]+)"', page.partition(f'<select id="{select}">')[2].partition("</select>")[0])
            self.assertEqual(offered, words)

    def test_the_browser_page_takes_defaults_that_are_there(self):
        wanted = re.findall(r"{{DEFAULT (\w+) (\w+)", (SOURCE / "Applications/web/page/src/page.html").read_text())
        self.assertGreater(len(wanted), 5)
        for program, option in wanted:
            self.assertRegex(TYPES.read_text(), rf"interface {program}Rows[^}}]*default: [^\n]*\)\. \*/ {option}\?")

    def test_pages_name_no_option_that_a_program_has_not(self):
        for program in PROGRAMS:
            if program == "adaptiso-bids":  # it names those of the programs that it runs
                continue
            made = table(program)
            known = set(re.findall(r"--[a-z][a-z-]*", made))
            page = (SOURCE / "Applications" / program / "README.md").read_text()
            others = {name for other in PROGRAMS for name in re.findall(r"--[a-z][a-z-]*", table(other))}
            named = set(re.findall(r"`(--[a-z][a-z-]*)", page))
            self.assertEqual(sorted(named - known - others), [], program)


if __name__ == "__main__":
    main()
