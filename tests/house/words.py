#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts words that a stranger stumbles over, in the pages and in the messages of the programs, and fails above the limits below.

words.py ROOT               the check
words.py ROOT --list WORD   where a word of LIMITS is
words.py --selftest         that the check counts what it should

docs/developers/style.md says what to write in their place. A limit is lowered where a page was mended, and never raised.
"""
import re
import sys
from pathlib import Path

# Words, and how many there may be in pages and messages together. A word stands for all of its forms in brackets.
LIMITS = {
    "told": (r"told", 8),
    "said": (r"(?:un)?said", 12),
    "tell": (r"tells?|telling", 25),
    "stays": (r"stays?|stayed", 72),
    "ways": (r"ways?", 127),
    "falls": (r"falls?|fell|fallen", 56),
    "hands on": (r"hand(?:s|ed)? (?:it |them )?on", 3),
    "passed over": (r"passe[sd] over", 3),
    "anew": (r"anew", 46),
    "at hand": (r"at hand", 4),
    "things": (r"things?", 18),
    "until now": (r"until (?:now|then)|before that|of before|since then", 20),
}
MOST_LINES = 300  # of a page that a user reads
MANUAL = ("tutorials", "how-to", "reference", "explanation")


def is_generated(path):
    """Pages that the programs write: their words are counted in the sources."""
    return path.parent.name in ("trephine", "trephine-sim") or path.name == "extremes.md" or path.parent.name == "reference-sim"


def pages(root):
    found = [p for p in sorted(root.glob("docs/**/*.md")) if not is_generated(p) and p.name != "style.md"]
    if not (root / "docs/tutorials").is_dir():  # before the parts: docs/reference was generated as a whole
        found = [p for p in found if p.parent.name != "reference"]
    return found + [root / name for name in ("README.md", "CONTRIBUTING.md")]


def prose(text):
    """A page without its code, links' targets and anchors; lines keep their numbers."""
    blank = lambda m: re.sub(r"[^\n]", " ", m.group(0))
    text = re.sub(r"^```.*?^```", blank, text, flags=re.S | re.M)
    text = re.sub(r"`[^`\n]*`", blank, text)
    return re.sub(r"\]\([^)]*\)|<!--.*?-->", blank, text, flags=re.S)


def messages(text):
    """The string literals of a source, lines kept; comments and includes are none."""
    token = re.compile(r'//[^\n]*|/\*.*?\*/|^[ \t]*#include[^\n]*|R"([a-z]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.S | re.M)
    out, at = [], 0
    for m in token.finditer(text):
        out.append(re.sub(r"[^\n]", " ", text[at:m.start()]))
        literal = m.group(0)
        out.append(literal if literal[0] in '"R' else re.sub(r"[^\n]", " ", literal))
        at = m.end()
    out.append(re.sub(r"[^\n]", " ", text[at:]))
    return "".join(out)


def texts(root):
    found = [(path, prose(path.read_text(encoding="utf-8"))) for path in pages(root)]
    for folder in ("lib", "simulator", "tools"):
        sources = (path for path in sorted((root / folder).glob("**/*")) if path.suffix in (".h", ".cpp"))
        found += [(path, messages(path.read_text(encoding="utf-8"))) for path in sources]
    return found


def places(read, root, form):
    """Where a word is in what texts() gave; a line's end within it counts as a blank."""
    expression = re.compile(r"\b(?:" + form.replace(" ", r"\s+") + r")\b", re.I)
    for path, text in read:
        for m in expression.finditer(text):
            line = text.count("\n", 0, m.start()) + 1
            yield f"{path.relative_to(root)}:{line}", text.split("\n")[line - 1].strip()


def check(root, limits=None):
    faults, counts, read = [], {}, texts(root)
    for word, (form, most) in (limits or LIMITS).items():
        counts[word] = sum(1 for _ in places(read, root, form))
        if counts[word] > most:
            faults.append(f"{word}: {counts[word]} times, at most {most}; see docs/developers/style.md and words.py ROOT --list '{word}'")
    for part in MANUAL:
        for page in sorted((root / "docs" / part).glob("**/*.md")):
            lines = page.read_text(encoding="utf-8").count("\n")
            if lines > MOST_LINES and not is_generated(page):
                faults.append(f"{page.relative_to(root)}: {lines} lines, at most {MOST_LINES}")
    return faults, counts


def selftest():
    import tempfile
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        (root / "docs/tutorials").mkdir(parents=True)
        (root / "lib/grid").mkdir(parents=True)
        for name in ("README.md", "CONTRIBUTING.md"):
            (root / name).write_text("Nothing.\n")
        (root / "docs/tutorials/a.md").write_text("It is told `told` here.\n```\ntold\n```\n[x](told.md)\n")
        (root / "lib/grid/a.cpp").write_text('// told\nf("it is told", \'"\', "told");\n')
        limits = {"told": (r"told", 3)}
        assert check(root, limits)[1]["told"] == 3, check(root, limits)
        assert not check(root, limits)[0]
        assert check(root, {"told": (r"told", 2)})[0]
        (root / "docs/tutorials/a.md").write_text("line\n" * 301)
        assert any("301 lines" in fault for fault in check(root, limits)[0])
    print("ok")


def main():
    if sys.argv[1:] == ["--selftest"]:
        return selftest()
    if len(sys.argv) == 4 and sys.argv[2] == "--list" and sys.argv[3] in LIMITS:
        root = Path(sys.argv[1]).resolve()
        for place, line in places(texts(root), root, LIMITS[sys.argv[3]][0]):
            print(f"{place}: {line}")
        return
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    faults, counts = check(Path(sys.argv[1]).resolve())
    print("\n".join(faults + [", ".join(f"{word} {count}" for word, count in counts.items())]))
    sys.exit(1 if faults else 0)


main()
