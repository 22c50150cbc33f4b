#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every refusal (exit code 80) says what to do about it, with names that exist.

refusals.py ROOT REFERENCE

An Error of code 80 is made by refusal() of base/refusal.h alone, which wants a Remedy. Here every remedy of the sources is
read: it must name a key, a stage or an option of the reference (a folder that the build makes) in backticks, or say which series to take, or name a
configuration that is shipped; and each name in backticks and each configuration must exist.
"""
import os
import re
import sys
from pathlib import Path

# Keys of scenes, cases and libraries that stand in schemas, beside the parameters of stages in the pages.
ROOT, REFERENCE = Path(sys.argv[1]), Path(sys.argv[2])
if not (REFERENCE / "trephine/index.md").exists() or not (REFERENCE / "trephine-sim/index.md").exists():
    print(f"skipped: the build has made no reference of both programs in {REFERENCE}")
    sys.exit(1 if os.environ.get("TREPHINE_CHECK") == "1" else 77)


def known_names():
    names = set()
    for page in REFERENCE.glob("*/*.md"):
        names.add(page.stem.replace("-", "_"))
        for name in re.findall(r"`--(?:\[no-\])?([a-z][a-z0-9-]*)", page.read_text(encoding="utf-8")):
            names.add(name.replace("-", "_"))
        for name in re.findall(r"`([a-z][a-z0-9_]*)`", page.read_text(encoding="utf-8")):
            names.add(name)
    for schema in (REFERENCE / "trephine").glob("*.json"):
        names.update(re.findall(r'"([a-z][a-z0-9_]*)"\s*:\s*\{', schema.read_text(encoding="utf-8")))
    return names


def literals(text):
    """The string literals in a piece of C++, joined where they follow each other; code between them is a gap."""
    return " ".join(re.findall(r'"((?:[^"\\]|\\.)*)"', re.sub(r'"\s*"', "", text)))


def closing(text, start, pair):
    depth = 0
    in_string = False
    for i in range(start, len(text)):
        c = text[i]
        if in_string:
            if c == "\\":
                continue
            if c == '"' and text[i - 1] != "\\":
                in_string = False
        elif c == '"':
            in_string = True
        elif c == pair[0]:
            depth += 1
        elif c == pair[1]:
            depth -= 1
            if depth == 0:
                return i
    return len(text)


def last_argument(call):
    """What follows the last comma of a call that stands in no brackets and no string."""
    depth, in_string, last = 0, False, 0
    for i, c in enumerate(call):
        if in_string:
            if c == '"' and call[i - 1] != "\\":
                in_string = False
        elif c == '"':
            in_string = True
        elif c in "([{":
            depth += 1
        elif c in ")]}":
            depth -= 1
        elif c == "," and depth == 0:
            last = i + 1
    return call[last:]


def remedies(text):
    """(offset, remedy) of every Remedy with a text of its own, and of every refusal whose remedy stands in place."""
    for m in re.finditer(r"\brefus(?:al|e)\(", text):
        end = closing(text, m.end() - 1, "()")
        argument = last_argument(text[m.end():end]).strip()
        if argument.startswith("{"):
            yield m.start(), argument
    for m in re.finditer(r"\bRemedy\s+(\w+)\s*\{", text):
        yield m.start(), text[m.end() - 1:closing(text, m.end() - 1, "{}") + 1]


def main():
    names, faults, count = known_names(), [], 0
    sources = sorted(p for folder in ("lib", "simulator") for p in (ROOT / folder).rglob("*") if p.suffix in (".cpp", ".h"))
    texts = {p: p.read_text(encoding="utf-8") for p in sources}
    constants = {}
    for text in texts.values():
        for m in re.finditer(r"\b(?:how_to_give\w*|wrong_shape)\s*=", text):
            constants[re.match(r"\w+", m.group(0)).group(0)] = literals(text[m.end():text.index(";", text.index('";', m.end()))])
    for path, text in texts.items():
        where = path.relative_to(ROOT).as_posix()
        for m in re.finditer(r"(?<!= )ExitCode::quality\b", text):
            line = text.count("\n", 0, m.start()) + 1
            if where not in ("lib/base/refusal.h", "lib/base/child.cpp", "lib/cli/man.cpp", "lib/pipeline/stage_cache.cpp"):
                faults.append(f"{where}:{line}: an Error of code 80 is made by refusal() of base/refusal.h")
        for at, remedy in remedies(text):
            line = text.count("\n", 0, at) + 1
            words = literals(remedy)
            for name, value in constants.items():
                if re.search(r"\b" + name + r"\b", remedy):
                    words += " " + value
            if not words:
                continue  # a variable: it is read where it is made
            count += 1
            quoted = re.findall(r"`([^`]+)`", words)
            files = re.findall(r"\b(?:configs|pipelines)/[\w/]+\.yaml", words)
            for name in quoted:
                first = re.split(r"[ =:]", name)[0].replace("-", "_")
                if first.split(".")[0] not in names and first not in names:
                    faults.append(f"{where}:{line}: `{name}` is no key, stage or command of the reference")
            for name in files:
                if not (ROOT / name).is_file():
                    faults.append(f"{where}:{line}: {name} does not exist")
            if not quoted and not files and "series" not in words:
                faults.append(f"{where}:{line}: names no key, stage, series or configuration: {words}")
    for fault in faults:
        print(fault)
    if count < 60:
        print(f"only {count} remedies were found: the sources are written otherwise than this script reads them")
    print(f"{count} remedies read")
    return 1 if faults or count < 60 else 0


sys.exit(main())
