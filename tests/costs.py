#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""costs.py BUILD [--write]: the ten tests that took longest in BUILD's runs of ctest. With --write, tests/costs.txt is written from
them: a first run of ctest in a new build then begins the longest tests first, and `ctest --preset quick` leaves them out."""
import pathlib
import sys

SLOW_S = 3


def main():
    data = pathlib.Path(sys.argv[1]) / "Testing/Temporary/CTestCostData.txt"
    rows = [line.rsplit(maxsplit=2) for line in data.read_text().split("\n---")[0].splitlines()]
    # A test that failed has the cost of a million.
    slowest = sorted(((float(r[2]), r[0]) for r in rows if len(r) == 3 and r[1].isdigit() and float(r[2]) < 1e6), reverse=True)
    print("The ten slowest tests, in seconds by the clock:")
    for seconds, name in slowest[:10]:
        print(f"{seconds:8.1f}  {name}")
    if "--write" in sys.argv:
        slow = sorted((name, round(s)) for s, name in slowest if s >= SLOW_S)
        pathlib.Path(__file__).with_name("costs.txt").write_text(
            f"# Written by tests/costs.py --write: tests of {SLOW_S} s and more, and their seconds on two cores.\n" +
            "".join(f"{name} {s}\n" for name, s in slow if " " not in name))


main()
