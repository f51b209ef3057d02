"""Commands of the documentation, run as they stand."""

import os
import re
import subprocess

from support import BIN, SOURCE

FENCE = re.compile(r"^```(\w+)(?: ([\w.-]+))?\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def script(document):
    """The ```sh blocks of a page as one script; a ```LANGUAGE FILE block is written to FILE where
    it stands."""
    lines = []
    for language, file, text in FENCE.findall((SOURCE / "Documentation" / document).read_text()):
        if file:
            lines.append(f"cat >{file} <<'END_OF_BLOCK'\n{text}END_OF_BLOCK\n")
        elif language == "sh":
            lines.append(text)
    return "".join(lines)


def run(text, folder):
    """Runs a script by bash, which stops at the first failure, with this build's programs."""
    return subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", text], cwd=folder, text=True,
                          env={**os.environ, "PATH": f"{BIN}:/usr/bin:/bin"}, capture_output=True,
                          timeout=1700)
