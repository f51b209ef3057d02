"""The table of options in each program's README.md, made from what the program says of them."""

import json
import os
import re
import subprocess

from support import BIN, SOURCE, ApplicationTest, main

BEGIN, END = "<!-- made from --help: ADAPTISO_RENEW_PAGES=1 ctest -R OptionTablesTest -->\n", "<!-- end -->\n"
PROGRAMS = sorted(path.name for path in (SOURCE / "Applications").glob("adaptiso-*") if (path / "main.cxx").exists())


def table(program):
    """A heading and a row for each option."""
    said = json.loads(subprocess.run([BIN / program, "--help-json"], capture_output=True, text=True, check=True).stdout)
    text, group = "", None
    for option in said["options"]:
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
