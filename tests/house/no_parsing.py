#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""No code reads a sentence: what an error or a warning says is for people, and what code asks is a value beside it.

no_parsing.py ROOT | no_parsing.py --selftest

Refused in lib, simulator and tools: a search in or a comparison of what(), field() or the text of a warning; a figure
that is found by its printed name; a form that turns a printed figure's name back into a number. And no message of the
rooms below the command line, the run and the desk names a command-line flag: it names a Setting (base/error.h), which
the edge words.
"""
import re
import sys
import tempfile
from pathlib import Path

ASKS = [
    r"\b(?:what|field)\(\)\)?\s*(?:\.\s*(?:find|rfind|compare|substr|starts_with)\b|[=!]=)",
    r"[=!]=\s*(?:std::string\()?\w+\.(?:what|field)\(\)",
    r"\b(?:find|count|contains|regex_match|regex_search)\([^;()]*\.(?:what|field)\(\)",
    r"\b(?:begins_with|ends_with|strstr|strcmp)\((?:std::string\()?\w+\.(?:what|field)\(\)",
    r"\b(?:warning|warnings\[\w+\]|warnings\.\w+\(\)|to_text\(\w*warning\w*\))\s*\.\s*(?:find|rfind|substr|compare)\b",
    r"\breport\w*\.find\(\"",
    r"\b(?:figures|report\w*)\.find\([^)]*\)\s*->",
    r"\bstoi\([^;]*(?:figure|name|first)\b",
]
# In words; a whole command may be shown in backticks or parentheses.
FLAG = re.compile(r'"(?=[^"]* )(?:[^"\\]|\\.)*--[a-z]')
COMMAND = re.compile(r"`?\b(?:trephine )?(?:import|convert|rubric) [^`\")]*--[a-z-]+[^`\")]*`?")
# These words are the case's own, read beside any program; error.cpp is where settings are worded.
WORDED = {"lib/base/error.cpp", "lib/mask/scan_verdict.cpp"}
LOW_ROOMS = """base json grid itk dicom codecs surface meshing meshio metrics mask segmentation head body trunk voxel boolean
face findings place consistency craniometry look phantom cases external compare contact picture""".split()


def without_comments(line):
    return re.sub(r'("(?:[^"\\]|\\.)*")|//.*', lambda m: m.group(1) or "", line)


def faults(root):
    for top in ("lib", "simulator", "tools"):
        for file in sorted((root / top).rglob("*")):
            if file.suffix not in (".h", ".cpp"):
                continue
            name = file.relative_to(root)
            low = top == "lib" and name.parts[1] in LOW_ROOMS
            for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
                code = without_comments(line)
                if any(re.search(p, code) for p in ASKS):
                    yield f"{name}:{number}: reads a text; give it a value to ask: {line.strip()}"
                if low and name.as_posix() not in WORDED and FLAG.search(COMMAND.sub("", code)):
                    yield f"{name}:{number}: names a flag; name a Setting: {line.strip()}"


def selftest():
    bad = [
        'if (e.field() == "mesh") throw;',
        'if (std::string(e.what()).find("limit") != std::string::npos) again();',
        'if (told.what() != std::string(e.what())) throw told;',
        'e.in_file(e.field().rfind("hardness", 0) == 0 ? a : b);',
        'if (given.count(e.field()) == 0) e.in_file(file);',
        'if (l.name == e.field()) e.in_file(file);',
        'if (warnings[i].find("ventricles") != std::string::npos) doubt();',
        'const auto* v = report.find("volume_ml");',
        'const int n = std::stoi(figure.first);',
        'throw Error(ExitCode::usage, "", "series", "there are two; give --series s1");',
    ]
    good = [
        'if (e.cause() == Cause::child_limit) again();',
        'if (e.field().empty()) e.in_field("lower_hu");',
        'log_warning(to_text(w));  // as by --warn',
        'return std::string(e.what()) + why;',
        'throw Error(ExitCode::usage, "", "series", "there are two; give " + Setting{"series", "s1"});',
        'throw refusal("canal", "not axial", {"take the axial series (`import --list` shows all)"});',
    ]
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        (root / "lib/mask").mkdir(parents=True)
        file = root / "lib/mask/a.cpp"
        for lines, wanted in ((bad, 1), (good, 0)):
            for line in lines:
                file.write_text(line + "\n", encoding="utf-8")
                found = len(list(faults(root)))
                if found != wanted:
                    sys.exit(f"{found} faults where {wanted} are: {line}")
        (root / "lib/cli").mkdir()
        file.rename(root / "lib/cli/a.cpp").write_text(bad[-1] + "\n", encoding="utf-8")
        if list(faults(root)):
            sys.exit("a flag is refused where the command line is made")


if sys.argv[1:] == ["--selftest"]:
    selftest()
else:
    found = list(faults(Path(sys.argv[1])))
    print("\n".join(found))
    sys.exit(1 if found else 0)
