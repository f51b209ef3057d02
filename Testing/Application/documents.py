"""Commands of the documentation, run as they stand, and what the pages say that they print.

A page's block without a language, behind a line that ends in "prints", is what the ```sh block before it prints, up to
the line of seconds and memory: to the digit. `ADAPTISO_RENEW_PAGES=1 ctest -R TutorialTest` writes it anew instead.
"""

import os
import re
import subprocess

from support import BIN, SOURCE

FENCE = re.compile(r"^```(?P<language>\w*)(?: (?P<file>[\w.-]+))?\n(?P<text>.*?)^```$", re.DOTALL | re.MULTILINE)
MARK = "=== block "
TIMES = re.compile(r"[\d.]+ s( \(.*\))?, peak memory [\d.]+ [MG]B")  # of this run and machine alone


def page(document):
    folder = SOURCE if document == "README.md" else SOURCE / "Documentation"
    return folder / document


def commands(document, marks=False, without=()):
    """The ```sh blocks of a page as one script; a ```LANGUAGE FILE block is written to FILE where it stands.
    \\param marks    print a line before each block, for printed()
    \\param without  leave out the blocks that hold one of these texts"""
    lines = []
    for block in FENCE.finditer(page(document).read_text()):
        text = block["text"]
        if any(part in text for part in without):
            continue
        if block["file"]:
            lines.append(f"cat >{block['file']} <<'END_OF_BLOCK'\n{text}END_OF_BLOCK\n")
        elif block["language"] == "sh":
            lines.append((f"echo '{MARK}{block.start()}'\n" if marks else "") + text)
    return "".join(lines)


def run(text, folder):
    """Runs a script by bash, which stops at the first failure, with this build's programs."""
    return subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", text], cwd=folder, text=True,
                          env={**os.environ, "PATH": f"{BIN}:/usr/bin:/bin"}, capture_output=True,
                          timeout=1700)


def up_to_times(text, keeps):
    """The lines before the first one of seconds and memory; with `keeps` that one too, without its numbers."""
    lines = []
    for line in text.splitlines():
        if TIMES.fullmatch(line):
            return lines + (["TIMES"] if keeps else [])
        lines.append(line)
    return lines


def check_printed(test, document, stdout):
    """Expects of each block of a page that follows "prints" that it was printed. \\param stdout  of a run of
    commands(document, marks=True)
    \\return  how many such blocks there are"""
    sections = dict(re.findall(rf"(?ms)^{MARK}(\d+)\n(.*?)(?=^{MARK}|\Z)", stdout))
    text = page(document).read_text()
    last, blocks, renewed = None, 0, text
    for block in FENCE.finditer(text):
        if block["language"] == "sh":
            last = sections.get(str(block.start()))
        if block["language"] or not re.search(r"prints\n+$", text[:block.start()]):
            continue
        blocks += 1
        keeps = any(map(TIMES.fullmatch, block["text"].splitlines()))
        printed = up_to_times(last, keeps)
        if os.environ.get("ADAPTISO_RENEW_PAGES"):
            times = [line for line in block["text"].splitlines() if TIMES.fullmatch(line)]
            lines = [times[0] if line == "TIMES" else line for line in printed]
            renewed = renewed.replace(block["text"], "\n".join(lines) + "\n")
        else:
            test.assertEqual(up_to_times(block["text"], keeps), printed, document)
    if renewed != text:
        page(document).write_text(renewed)
    return blocks
