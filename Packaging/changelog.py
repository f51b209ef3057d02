"""Makes Debian's changelog of a package from CHANGELOG.md.

    changelog.py CHANGELOG.md PACKAGE MAINTAINER OUTPUT       OUTPUT may end in .gz

Every "## VERSION (DATE)", newest first, becomes an entry; its paragraphs and items become the entry's
items. Of a version that is not released the time is now, or what SOURCE_DATE_EPOCH says. Python's
standard library only; the same input gives the same bytes.
"""

import gzip
import os
import re
import sys
import textwrap
import time
from datetime import datetime, timezone
from email.utils import format_datetime
from pathlib import Path

HEADING = re.compile(r"^## (\S+) \((unreleased|\d{4}-\d\d-\d\d)\)\n", re.MULTILINE)
LINE = 79  # columns


def items(text):
    """The paragraphs and "- " items of an entry, each on one line, without Markdown's marks; an item of a group
    begins with the group's name: "Added: ..."."""
    group, found = "", []
    for part in re.split(r"\n\s*\n|\n(?=- |### )|(?<=^)(?=### )", text.strip()):
        heading, _, rest = part.strip().partition("\n") if part.startswith("### ") else ("", "", part)
        group = heading.removeprefix("### ") + ": " if heading else group
        if rest.strip():
            found.append(group + re.sub(r"\s+", " ", re.sub(r"`|\*\*|\]\([^)]*\)|\[(?=[^]]*\]\()", "", rest.removeprefix("- "))).strip())
    return found


def entry(package, maintainer, version, date, text):
    if date == "unreleased":
        moment = datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH", time.time())),
                                        timezone.utc)
    else:
        moment = datetime.fromisoformat(date).replace(tzinfo=timezone.utc)
    distribution = "UNRELEASED" if date == "unreleased" else "stable"
    told = [textwrap.fill(item, LINE, initial_indent="  * ", subsequent_indent="    ",
                          break_long_words=False, break_on_hyphens=False) for item in items(text)]
    return "\n".join([f"{package} ({version}) {distribution}; urgency=medium", "", *told, "",
                      f" -- {maintainer}  {format_datetime(moment)}", ""])


def changelog(text, package, maintainer):
    _, *parts = HEADING.split(text)
    if not parts:
        raise SystemExit("changelog.py: there is no '## VERSION (DATE)'")
    entries = zip(parts[::3], parts[1::3], parts[2::3])
    return "\n".join(entry(package, maintainer, *of) for of in entries)


def main():
    source, package, maintainer, output = sys.argv[1:]
    data = changelog(Path(source).read_text(encoding="utf-8"), package, maintainer).encode()
    if output.endswith(".gz"):
        data = gzip.compress(data, compresslevel=9, mtime=0)
    Path(output).write_bytes(data)


if __name__ == "__main__":
    main()
