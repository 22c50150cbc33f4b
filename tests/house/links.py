#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fails where a link leads nowhere.

links.py ROOT          README.md, CONTRIBUTING.md, CHANGELOG.md, SECURITY.md and docs/**/*.md of the repository: every relative
                       link and picture, and every #anchor as GitHub makes it of a heading; and that each promise of
                       SECURITY.md names tests that exist
links.py --site OUT    every link, picture and #anchor of a site that docs/build_site.sh has built
"""
import html.parser
import re
import sys
import urllib.parse
from pathlib import Path


def without_code(text):
    """The text with code blanked out, so that lines keep their numbers and links in code are none."""
    lines, fence = [], None
    for line in text.split("\n"):
        mark = re.match(r"\s*(```+|~~~+)", line)
        if fence is None and mark:
            fence = mark.group(1)[:3]
            lines.append("")
        elif fence is not None:
            if mark and mark.group(1).startswith(fence):
                fence = None
            lines.append("")
        else:
            lines.append(line)
    blank = lambda m: re.sub(r"[^\n]", " ", m.group(0))
    return re.sub(r"(`+)(?:(?!\1)[^\n]|\n(?!\n))*?\1", blank, "\n".join(lines))


def anchors_of(path):
    """What GitHub calls the headings of a page."""
    found, counts, fence = set(), {}, False
    for line in path.read_text(encoding="utf-8").split("\n"):
        if re.match(r"\s*(```|~~~)", line):
            fence = not fence
        heading = None if fence else re.match(r"#{1,6}\s+(.*?)\s*#*$", line)
        if heading:
            words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1)).lower()
            slug = re.sub(r"\s", "-", re.sub(r"[^\w\- ]", "", words))
            number = counts.get(slug, 0)
            counts[slug] = number + 1
            found.add(f"{slug}-{number}" if number else slug)
    return found


def check_promises(root):
    """The last column of a table that is headed "tested by": tests by their names, of CTest, of GoogleTest, or generators of attacks."""
    lists = "\n".join(p.read_text(encoding="utf-8") for p in root.glob("tests/*.cmake"))
    sources = "\n".join(p.read_text(encoding="utf-8") for p in root.glob("tests/*_test.cpp"))
    faults, tested = [], False
    for number, line in enumerate((root / "SECURITY.md").read_text(encoding="utf-8").split("\n"), 1):
        tested = line.startswith("|") and (tested or line.endswith("| tested by |"))
        if not tested or line.endswith(("| tested by |", "---|")):
            continue
        names = re.findall(r"`([^`]+)`", line.split("|")[-2])
        if not names:
            faults.append(f"SECURITY.md:{number}: names no test")
        for name in names:
            room, _, test = name.partition(".")
            there = (root / name).is_file() if "/" in name else \
                re.search(rf"\b{test}\b", lists) if room in ("program", "browser", "house") else \
                re.search(rf"\bTEST(?:_[FP])?\(\s*{room},\s*{test}\)", sources)
            if not there:
                faults.append(f"SECURITY.md:{number}: {name}: there is no such test")
    return faults


def check_repository(root):
    pages = [root / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")] + sorted(root.glob("docs/**/*.md"))
    faults, count = [], 0
    for page in pages:
        if not page.is_file():
            faults.append(f"{page.relative_to(root)}: is missing")
            continue
        text = without_code(page.read_text(encoding="utf-8"))
        links = [(m.start(), m.group(1)) for m in re.finditer(r"\]\(\s*<?([^)>\s]+)>?(?:\s+\"[^\"]*\")?\s*\)", text)]
        links += [(m.start(), m.group(1)) for m in re.finditer(r"^\[[^\]]+\]:\s*(\S+)", text, re.M)]
        for at, link in links:
            if re.match(r"[a-z][a-z0-9+.-]*:", link):
                continue
            count += 1
            where = f"{page.relative_to(root)}:{text.count(chr(10), 0, at) + 1}"
            name, _, anchor = urllib.parse.unquote(link).partition("#")
            target = (page.parent / name).resolve() if name else page
            if root != target and root not in target.parents:
                faults.append(f"{where}: {link}: leads out of the repository")
            elif not target.exists():
                faults.append(f"{where}: {link}: there is no such file")
            elif anchor and target.suffix == ".md" and anchor not in anchors_of(target):
                faults.append(f"{where}: {link}: there is no such heading")
    return faults, count


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.links, self.anchors = [], {"", "top"}

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (tag == "a" and name == "name"):
                self.anchors.add(value)
            elif name in ("href", "src") and value is not None:
                self.links.append((self.getpos()[0], value))


def check_site(out):
    pages = {}
    for path in sorted(out.glob("**/*.html")):
        pages[path] = Page()
        pages[path].feed(path.read_text(encoding="utf-8"))
    faults, count = [], 0
    for path, page in pages.items():
        if path.name in ("404.html", "search.html"):
            continue  # their links are of the place where the site is served
        for line, link in page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            count += 1
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            where = f"{path.relative_to(out)}:{line}: {link}"
            if not target.exists():
                faults.append(f"{where}: there is no such file")
            elif target in pages and urllib.parse.unquote(parts.fragment) not in pages[target].anchors:
                faults.append(f"{where}: there is no such place")
    if not pages:
        faults.append(f"{out}: holds no page")
    return faults, count


def main():
    if len(sys.argv) == 3 and sys.argv[1] == "--site":
        faults, count = check_site(Path(sys.argv[2]).resolve())
    elif len(sys.argv) == 2:
        root = Path(sys.argv[1]).resolve()
        faults, count = check_repository(root)
        faults += check_promises(root)
    else:
        sys.exit(__doc__)
    print("\n".join(faults + [f"{count} links, {len(faults)} faults"]))
    sys.exit(1 if faults else 0)


main()
