"""Manual pages and completions say what --help says."""

import gzip
import json
import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

from support import BIN, ApplicationTest, main

MADE = Path(os.environ["ADAPTISO_BUILD"]) / "Applications" / "manual"
PROGRAMS = ("adaptiso", "adaptiso-mesh", "adaptiso-labels", "adaptiso-bem", "adaptiso-check",
            "adaptiso-compare", "adaptiso-simplify", "adaptiso-mend", "adaptiso-bids",
            "adaptiso-giant")


def output(*command, **options):
    return subprocess.run(list(map(str, command)), text=True, check=True, stdout=subprocess.PIPE,
                          **options).stdout


def words(text):
    return " ".join(text.split())


def options_of_help(program):
    """Names of the options that --help lists, by its own layout."""
    lines = re.findall(r"(?m)^  (-\S+)", output(BIN / program, "--help"))
    return {name for line in lines for name in line.split(",")}


def said(program):
    return json.loads(output(BIN / program, "--help-json"))


class HelpJson(ApplicationTest):
    def test_has_the_options_and_texts_of_help(self):
        for program in PROGRAMS:
            with self.subTest(program):
                options = said(program)["options"]
                self.assertEqual({name for option in options for name in option["names"]},
                                 options_of_help(program))
                text = words(output(BIN / program, "--help"))
                for option in options:
                    self.assertIn(words(option["description"]), text)
                self.assertIn(words(said(program)["footer"]), text)

    def test_is_hidden_and_stands_alone(self):
        self.assertNotIn("--help-json", output(BIN / "adaptiso-mesh", "--help"))
        self.assert_fails(2, "help-json", "ball.nii", "--help-json")


class Manual(ApplicationTest):
    def page(self, program):
        """The page as a terminal shows it, without breaks; roff may warn of nothing."""
        source = gzip.decompress((MADE / f"{program}.1.gz").read_bytes())
        done = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-P-c", "-P-b", "-P-u", "-rHY=0",
                               "-rLL=1000n"], input=source, check=True, capture_output=True)
        self.assertEqual(done.stderr.decode(), "")
        return words(done.stdout.decode())

    def test_holds_all_that_help_says(self):
        for program in PROGRAMS:
            with self.subTest(program):
                page = self.page(program)
                for option in said(program)["options"]:
                    tag = ", ".join(option["names"]) + " " + option["value"]
                    text = words(option["description"])
                    stop = "" if text.endswith(".") else "."
                    self.assertIn(f"{tag.strip()} {text}{stop}", page)
                for line in said(program)["footer"].splitlines():
                    # headings become the page's own
                    self.assertIn(words(re.sub(r"^[A-Z][^:.]*:( |$)", "", line)), page)

    def test_names_program_and_version(self):
        for program in PROGRAMS:
            page = self.page(program)
            self.assertRegex(page, f"NAME {program} - [a-z]")
            self.assertIn(f"adaptiso {said(program)['version']}", page)


class BashCompletion(ApplicationTest):
    def complete(self, *line):
        """What is offered for the last word of `line`, typed in the test's folder."""
        script = (f'source "{MADE}/{line[0]}.bash"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
                  f'_{line[0].replace("-", "_")}; printf "%s\\n" "${{COMPREPLY[@]}}"')
        return output("bash", "-c", script, "bash", *line, cwd=self.folder).split()

    def test_offers_every_option(self):
        for program in PROGRAMS:
            self.assertEqual(set(self.complete(program, "-")), options_of_help(program))
            self.assertEqual(self.complete(program, "--vers"), ["--version"])

    def test_offers_words_and_files(self):
        self.path("head.nii").touch()
        self.path("scans").mkdir()
        self.assertEqual(self.complete("adaptiso-mesh", "--method", ""),
                         ["adaptive", "boxes", "dmc", "asc", "mc"])
        self.assertEqual(self.complete("adaptiso-mesh", "--coordinates", "=", "t"), ["tkras"])
        self.assertEqual(self.complete("adaptiso-mesh", "--iso", "a"), ["auto"])
        self.assertEqual(self.complete("adaptiso-mesh", "he"), ["head.nii"])
        self.assertEqual(self.complete("adaptiso-mesh", "--json", "="), ["head.nii", "scans"])
        self.assertEqual(self.complete("adaptiso-bem", "--output", ""), ["scans"])
        self.assertEqual(self.complete("adaptiso-mesh", "--threads", ""), [])


@unittest.skipUnless(shutil.which("zsh"), "needs Debian's zsh")
class ZshCompletion(ApplicationTest):
    # _arguments is asked in a zsh of its own on a pseudo-terminal: what it lists is what a user sees
    SCRIPT = r"""
zmodload zsh/zpty
zpty shell "zsh -f -i"
zpty -w shell "PS1=; fpath=($1 \$fpath); autoload -U compinit; compinit -u -d $2/dump"
zpty -w shell "zstyle ':completion:*' list-max 1000; LISTMAX=1000; COLUMNS=200; LINES=500; cd $2"
zpty -w shell "bindkey '^I' list-choices; print READY"
zpty -r shell text '*READY*READY*'
zpty -w -n shell "$3"$'\t'
# until nothing has come for two seconds
for ((idle = 0, tries = 0; idle < 10 && tries < 200; ++idle, ++tries)); do
    sleep 0.2
    while zpty -r -t shell more; do print -r -- "$more"; idle=-1; done
done
zpty -d shell
"""

    def listed(self, line):
        return output("zsh", "-f", "-c", self.SCRIPT, "zsh", MADE, self.folder, line, timeout=60)

    def test_offers_every_option(self):
        for program in PROGRAMS:
            shown = self.listed(f"{program} -")
            for name in options_of_help(program):
                self.assertIn(name, shown)

    def test_offers_words(self):
        shown = self.listed("adaptiso-mesh --method ")
        for word in ("boxes", "adaptive", "dmc", "asc", "mc"):
            self.assertIn(word, shown)


if __name__ == "__main__":
    main()
