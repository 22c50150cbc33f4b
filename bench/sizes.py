#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""sizes.py [ROOT] [--check PAGE]: lines of C++ by room, file and function, as docs/developers/architecture.md has them. Functions with a body, of
one line or more, in namespaces and classes; a lambda belongs to the function around it. With --check it fails where a figure of that
table is more than a tenth off what is counted."""
import re
import sys
from pathlib import Path

ROOT = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
PAGE = Path(sys.argv[3]) if sys.argv[2:3] == ["--check"] else None
BARE = re.compile(r'R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|//[^\n]*|/\*.*?\*/|^#(?:[^\n]*\\\n)*[^\n]*', re.S | re.M)
SCOPE = re.compile(r"\b(namespace|class|struct|union|enum)\b|\bextern\s*$")


def functions_of(text):
    """The lines of each function."""
    text = BARE.sub(lambda m: "\n" * m.group().count("\n"), text)
    stack, head, parens, found = [], 0, 0, []
    for at, c in enumerate(text):
        if c == "(":
            parens += 1
        elif c == ")":
            parens -= 1
        elif c == ";" and parens == 0:
            head = at + 1
        elif c == "{":
            before = text[head:at].strip()
            outside = all(kind == "scope" for kind, _, _ in stack)
            if outside and parens == 0 and SCOPE.search(re.sub(r"<[^<>]*>|\([^()]*\)", "", before)) and not before.endswith(")"):
                kind = "scope"
            elif outside and parens == 0 and ")" in before and not before.endswith(("=", ",")):
                kind = "function"
            else:
                kind = "block"
            stack.append((kind, head + len(text[head:at]) - len(text[head:at].lstrip()), parens))
            if kind != "block":
                head = at + 1
        elif c == "}" and stack:
            kind, begin, parens = stack.pop()
            if kind == "function":
                found.append(text.count("\n", begin, at) + 1)
            if kind != "block" or all(k == "scope" for k, _, _ in stack):
                head = at + 1
    return found


def row(name, lines):
    lines = sorted(lines)
    share = lambda q: lines[min(len(lines) - 1, int(q * len(lines)))]
    figures = [len(lines), share(0.5), share(0.9), lines[-1]]
    print(f"| {name} | " + " | ".join(f"{v:,}" for v in figures) + " |")
    if PAGE is None:
        return True
    told = re.search(rf"^\| {name} \|([0-9,| ]+)\|$", PAGE.read_text(), re.M)
    old = [int(v.replace(",", "")) for v in told.group(1).split("|")] if told else []
    return len(old) == 4 and all(abs(a - b) <= max(1, 0.1 * b) for a, b in zip(old, figures))


rooms, files, functions = {}, [], []
for part in ("lib", "simulator"):
    for room in sorted(p for p in (ROOT / part).iterdir() if p.is_dir()):
        for file in sorted(room.rglob("*")):
            if file.suffix not in (".h", ".cpp"):
                continue
            text = file.read_text()
            count = text.count("\n")
            own = file.parent if file.parent.parent == ROOT / "simulator/lessons" else room  # a lesson is a room
            rooms[own] = rooms.get(own, 0) + count
            files.append(count)
            functions += functions_of(text)
print("| lines in `lib/` and `simulator/` | count | median | 90th percentile | most |\n|---|---|---|---|---|")
same = [row("of a room", rooms.values()), row("of a file", files), row("of a function", functions)]
if not all(same):
    sys.exit(f"{PAGE} has other figures: put these into its table")
