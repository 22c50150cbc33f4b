#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts of a case, a scan or a configuration reach a terminal through `printable` alone: standard output by std::cout, which
lib/cli/plain_output.cpp filters in both programs, standard error by lib/base/log.cpp. This lists every other way there is, and fails
for one that is not known. A known one says why it may be.

    sinks.py ROOT [--selftest]"""
import pathlib
import re
import sys

SINK = re.compile(r"\b(?:std::)?(?:printf|vprintf|puts|fputs|putchar|putc|fputc|fprintf|vfprintf|fwrite|perror|dprintf)\s*\(|"
                  r"\bfmt::print\s*\(|\bstd::(?:cerr|clog)\b|\bSTD(?:OUT|ERR)_FILENO\b|\bwrite\s*\(\s*[12]\s*,|/dev/(?:stdout|stderr|tty)\b|"
                  r"\bcout\.rdbuf\s*\(|\bstdout\b|\bstderr\b")
KNOWN = {
    "lib/base/log.cpp": "the sink of standard error: every line passes printable",
    "lib/cli/run_program.cpp": "flushes standard output",
    "lib/itk/program/main.cpp": "a fixed text",
    "lib/tetra/program/main.cpp": "a fixed text",
    "tools/library_display.cpp": "the status line: what is in it passes printable",
    "tools/library_keep.cpp": "a file's name that means standard output",
}
COMMENT = re.compile(r"^\s*(//|\*|/\*)")


def sinks(text):
    for number, line in enumerate(text.splitlines(), 1):
        code = re.sub(r'"(?!/dev/)(?:[^"\\]|\\.)*"', '""', line).split("//")[0]
        if not COMMENT.match(line) and SINK.search(code):
            yield number, line.strip()


def main():
    root = pathlib.Path(sys.argv[1])
    if "--selftest" in sys.argv:
        for bad in ('std::printf("%s", name);', "fputs(text.c_str(), stdout);", "std::cerr << text;", "::write(2, t, n);",
                    "fmt::print(text);", "std::cout.rdbuf();", 'open("/dev/tty")'):
            assert list(sinks(bad)), bad
        for good in ("std::cout << text;", "std::snprintf(t, 3, f);", "out.write(t, n);", "// printf("):
            assert not list(sinks(good)), good
        return
    found, faults = set(), 0
    for folder in ("lib", "tools", "simulator"):
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in (".cpp", ".h"):
                continue
            name = str(file.relative_to(root))
            for number, line in sinks(file.read_text()):
                found.add(name)
                if name not in KNOWN:
                    print(f"{name}:{number}: {line}: write to std::cout, or log_line")
                    faults += 1
    for name in sorted(set(KNOWN) - found):
        print(f"tests/house/sinks.py: {name} has no sink any more")
        faults += 1
    for program in ("lib/cli/run_program.cpp",):
        if "const PlainOutput plain;" not in (root / program).read_text():
            print(f"{program}: std::cout is not filtered")
            faults += 1
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
