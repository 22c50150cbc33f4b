#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""bibliography.py ROOT: fails where a source cites a work that docs/developers/bibliography.md does not list, or the other way round.

Sources cite a work by its key in brackets, such as [Dempster1977] or [Rizzi, chapter 5].
"""
import re
import sys
from pathlib import Path

FOLDERS = ("lib", "simulator", "bench", "docs", "configs")
ENDINGS = {".c", ".cpp", ".h", ".md", ".py", ".sh", ".yaml"}
# A key with or without a chapter or table behind it. What follows says that it is no link of Markdown.
CITATION = re.compile(r"\[([A-Z][A-Za-z]+(?:[12][0-9]{3})?)((?:,\s(?:#\s|//+\s|\*\s)?[^\]\[]{1,40})?)\](?!\()")


def keys_of(page):
    return re.findall(r"^(?:\| )?\*\*([A-Z][A-Za-z]+(?:[0-9]{4})?)\*\*", page.read_text(encoding="utf-8"), re.MULTILINE)


def joined(text):
    """The text with the line breaks of comments as blanks, so that a citation may span two lines."""
    return re.sub(r"\n\s*(?:///?|#|\*)?[ \t]*", " ", text)


def main():
    root = Path(sys.argv[1])
    bibliography = root / "docs" / "developers" / "bibliography.md"
    keys = keys_of(bibliography)
    faults = [f"docs/developers/bibliography.md: {key} is listed twice" for key in set(keys) if keys.count(key) > 1]
    cited = set()
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in ENDINGS or path == bibliography or not path.is_file():
                continue
            for match in CITATION.finditer(joined(path.read_text(encoding="utf-8"))):
                key = match.group(1)
                cited.add(key)
                # Of the words without a year only Rizzi is a citation beyond doubt: brackets have other uses as well.
                if key not in keys and (key[-1].isdigit() or key.startswith("Rizzi")):
                    faults.append(f"{path.relative_to(root)}: [{key}] is not in docs/developers/bibliography.md")
    faults += [f"docs/developers/bibliography.md: nothing cites {key}" for key in keys if key not in cited]
    if not keys:
        faults.append("docs/developers/bibliography.md: lists no work")
    print("\n".join(faults) if faults else f"{len(keys)} works, all of them cited")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
