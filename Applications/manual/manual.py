"""Makes a manual page, or the completions of a shell, from what a program says of its options.

    manual.py man|bash|zsh PROGRAM OUTPUT       OUTPUT may end in .gz

Runs `PROGRAM --help-json` (Applications/Common/RunApp.cxx), the source of --help too, so that
none of them can say something else. Python's standard library only; the same program gives the same
bytes.
"""

import gzip
import json
import re
import subprocess
import sys
from pathlib import Path

FILES = re.compile(r"^(FILE|OUT|IMG|MESH|DIR|ROOT|LIST|INPUT|A|B)\b")
FOLDERS = re.compile(r"^(DIR|ROOT)\b")


def choices(option):
    """The words that a value like "ras|lps" or "V|auto" may be; what is not lower-case stands for
    a value of the user's."""
    return [word for word in option["value"].split("|") if re.fullmatch(r"[a-z0-9-]+", word)]


def takes_value(option):
    return bool(option["value"]) and bool(option["names"])


# ---- manual pages

def escaped(text):
    """`text` as roff shows it as it is; a hyphen is the character that is typed."""
    for character, name in (("\\", "\\e"), ("-", "\\-"), ("'", "\\(aq"), ("`", "\\(ga"),
                            ('"', "\\(dq"), ("^", "\\(ha"), ("~", "\\(ti")):
        text = text.replace(character, name)
    return re.sub(r"(?m)^\.", r"\\&.", text)


def bold(text):
    return f"\\fB{escaped(text)}\\fR"


def italic(text):
    return f"\\fI{escaped(text)}\\fR"


def marked(text):
    """Names of options in bold."""
    parts = re.split(r"((?<![\w-])--?[a-z][a-z0-9-]*)", text)
    return "".join(bold(part) if n % 2 else escaped(part) for n, part in enumerate(parts))


def sentence(text):
    """`text` as a page of prose has it: with a full stop."""
    return text if text.endswith((".", "!", "?")) else text + "."


def option_entry(option):
    tag = ", ".join(map(bold, option["names"]))
    if option["value"]:
        tag += (" " if tag else "") + italic(option["value"])
    lines = [".TP", tag, marked(sentence(option["description"]))]
    for word, names in (("Needs", option["needs"]), ("Not together with", option["excludes"])):
        if names:
            lines.append(f"{word} " + ", ".join(map(bold, names)) + ".")
    return lines


def option_sections(options):
    """Arguments, then the groups in the order of --help, "Options" (--help, --version) last."""
    groups = {}
    for option in options:
        if option["names"]:
            groups.setdefault(option["group"], []).append(option)
    lines = [".SH ARGUMENTS"]
    for option in options:
        if not option["names"]:
            lines += option_entry(option)
    lines.append(".SH OPTIONS")
    for name in sorted(groups, key=lambda name: name == "Options"):
        lines.append(f'.SS "{escaped("Others" if name == "Options" else name)}"')
        for option in groups[name]:
            lines += option_entry(option)
    return lines


def footer_sections(footer):
    """A section for each "Heading:" at the start of a paragraph; indented lines stay as they are."""
    lines = []
    is_literal = False
    is_start = True
    for line in (text for block in footer.split("\n\n") for text in (None, *block.split("\n"))):
        if is_literal and not (line and line.startswith("  ")):
            lines.append(".fi")
            is_literal = False
        if line is None:
            is_start = True
            continue
        heading = re.match(r"([A-Z][^:.]*):(?: |$)", line) if is_start else None
        if heading:
            lines.append(f'.SH "{escaped(heading[1].upper())}"')
            line = line[heading.end():]
        elif is_start:
            lines.append(".PP")
        is_start = False
        if line.startswith("  ") and not is_literal:
            lines.append(".nf")
            is_literal = True
        if line:
            lines.append(escaped(line) if is_literal else marked(line))
    return lines


def synopsis(program, options):
    words = [bold(program), "[" + italic("OPTION") + "]..."]
    for option in options:
        if not option["names"]:
            word = italic(option["value"]) + ("..." if option["repeats"] else "")
            words.append(word if option["required"] else f"[{word}]")
    return " ".join(words)


def manual_page(said, programs):
    program = said["program"]
    description = " ".join(said["description"].split())
    summary = re.sub(r"[:.(].*", "", description)
    lines = [f'.TH {escaped(program.upper())} 1 "" "adaptiso {said["version"]}" "User Commands"',
             ".SH NAME", f"{escaped(program)} \\- {escaped(summary[0].lower() + summary[1:].strip())}",
             ".SH SYNOPSIS", synopsis(program, said["options"]),
             ".SH DESCRIPTION", marked(sentence(description))]
    lines += option_sections(said["options"]) + footer_sections(said["footer"])
    others = [f"{bold(other)}(1)" for other in programs if other != program]
    lines += [".SH SEE ALSO", ", ".join(others), ".PP",
              "Each program's README.md, in " + italic("/usr/share/doc/adaptiso") + "."]
    return "\n".join(lines) + "\n"


# ---- completions

BASH = """# bash completion of {program}; made from {program} --help-json
_{function}() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}}
    # "--name=value" comes as three words
    if [[ $current == "=" ]]; then
        current=
    elif [[ $previous == "=" ]]; then
        previous=${{COMP_WORDS[COMP_CWORD - 2]}}
    fi
    COMPREPLY=()
    case $previous in
{cases}
    esac
    if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "{names}" -- "$current")
        return
    fi
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
}}
complete -F _{function} {program}
"""


def bash_case(option):
    pattern = "|".join(option["names"])
    if choices(option):
        action = f'mapfile -t COMPREPLY < <(compgen -W "{" ".join(choices(option))}" -- "$current")'
    elif FOLDERS.match(option["value"]):
        action = ('compopt -o filenames 2>/dev/null; '
                  'mapfile -t COMPREPLY < <(compgen -d -- "$current")')
    elif FILES.match(option["value"]):
        action = ('compopt -o filenames 2>/dev/null; '
                  'mapfile -t COMPREPLY < <(compgen -f -- "$current")')
    else:
        action = ":"  # a number or a name: nothing to offer
    return f"        {pattern}) {action}; return ;;"


def bash_completion(said):
    return BASH.format(program=said["program"], function=said["program"].replace("-", "_"),
                       cases="\n".join(bash_case(o) for o in said["options"] if takes_value(o)),
                       names=" ".join(name for o in said["options"] for name in o["names"]))


def zsh_value(option):
    if choices(option):
        return "(" + " ".join(choices(option)) + ")"
    if FOLDERS.match(option["value"]):
        return "_files -/"
    return "_files" if FILES.match(option["value"]) else " "


def zsh_quoted(text):
    """Inside '...' of an _arguments specification."""
    text = re.sub(r"([\\\[\]:])", r"\\\1", " ".join(text.split()))
    return text.replace("'", "'\\''")


def zsh_specification(option):
    value = ""
    if option["value"]:
        label = zsh_quoted(option["value"]).replace("\\|", "|")
        value = f":{label}:{zsh_value(option)}"
    if not option["names"]:
        return f"'{'*' if option['repeats'] else ''}{value or ':'}'"
    several = "*" if option["repeats"] else ""
    text = f"[{zsh_quoted(option['description'])}]"
    lines = []
    for name in option["names"]:
        others = "" if option["repeats"] else f"({' '.join(option['names'] + option['excludes'])})"
        equals = "=" if value and name.startswith("--") else ""
        lines.append(f"'{others}{several}{name}{equals}{text}{value}'")
    return " \\\n    ".join(lines)


def zsh_completion(said):
    specifications = " \\\n    ".join(map(zsh_specification, said["options"]))
    return (f"#compdef {said['program']}\n# made from {said['program']} --help-json\n"
            f"_arguments -s \\\n    {specifications}\n")


def main():
    kind, program, output = sys.argv[1:]
    said = json.loads(subprocess.run([program, "--help-json"], check=True, text=True,
                                     stdout=subprocess.PIPE).stdout)
    programs = ["adaptiso-mesh", "adaptiso-labels", "adaptiso-bem", "adaptiso-check",
                "adaptiso-compare", "adaptiso-simplify", "adaptiso-mend",
                "adaptiso-bids", "adaptiso-giant"]
    text = {"man": lambda: manual_page(said, programs), "bash": lambda: bash_completion(said),
            "zsh": lambda: zsh_completion(said)}[kind]()
    data = text.encode()
    if output.endswith(".gz"):
        data = gzip.compress(data, 9, mtime=0)  # no time: the same bytes in every build
    Path(output).write_bytes(data)


if __name__ == "__main__":
    main()
