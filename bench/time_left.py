#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the time left that `trephine run` tells is what then comes: time_left.py TREPHINE FOLDER NAME=CONFIG:SERIES[:SETTING]...

    bench/time_left.py build/release/bin/trephine /tmp/left chest=configs/ct_chest.yaml:/data/chest head=configs/ct_head.yaml:/data/head

Runs each case in a terminal of its own into a library that is empty, so that no earlier run says what the stages take, then once
more with the cache of its data taken away, so that one does. Of each run it prints a row of a table: the seconds, at a quarter, a half
and three quarters of them what was told to be left and what came, the worst factor between the two from the first telling until 3 s
before the end, the seconds at which that was, and whether the share of the whole ever fell. A run that is refused is told as such.
Run it where nothing else runs: the seconds of a busy machine are those of its other programs."""
import os
import pathlib
import pty
import re
import shutil
import subprocess
import sys
import time

TOLD = re.compile(r"(\d+) % of all(?:, about ((?:\d+ h )?(?:\d+ min ?)?(?:[\d.]+ s)?) ?left)?")
LAST_S = 3.0


def seconds(text):
    units = {"h": 3600, "min": 60, "s": 1}
    return sum(float(n) * units[u] for n, u in re.findall(r"([\d.]+) (h|min|s)", text))


def run(words):
    """The exit code, the seconds, and what was told: (when, percent, seconds left or None)."""
    master, slave = pty.openpty()
    began = time.monotonic()
    child = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=slave, close_fds=True)
    os.close(slave)
    told, rest = [], ""
    while True:
        try:
            got = os.read(master, 65536)
        except OSError:
            break
        if not got:
            break
        now = time.monotonic() - began
        pieces = (rest + got.decode(errors="replace")).split("\r")
        rest = pieces.pop()
        for line in pieces + [rest]:
            found = TOLD.search(line)
            if found:
                told.append((now, int(found[1]), seconds(found[2]) if found[2] else None))
    os.close(master)
    return child.wait(), time.monotonic() - began, told


def row(name, which, code, took, told):
    left = [(t, s) for t, _, s in told if s is not None]
    shares = [p for _, p, _ in told]
    falls = any(b < a for a, b in zip(shares, shares[1:]))
    cells = []
    for part in (0.25, 0.5, 0.75):
        near = min(left, key=lambda x: abs(x[0] - part * took), default=None)
        cells.append("" if near is None else f"{near[1]:.0f} / {took - near[0]:.0f}")
    worst, at = 1.0, 0.0
    for t, s in left:
        came = took - t
        if came < LAST_S:
            continue
        factor = max(s, 0.1) / came
        factor = max(factor, 1 / factor)
        if factor > worst:
            worst, at = factor, t
    print(f"| {name} | {which} | {code} | {took:.1f} | {' | '.join(cells)} | {worst:.1f} at {at:.0f} s | {'falls' if falls else 'no'} |",
          flush=True)


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    program, folder = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    print("| scan | run | code | s | told / came, s, at 1/4 | 1/2 | 3/4 | worst factor | share falls |\n|---|---|---|---|---|---|---|---|---|")
    for case in sys.argv[3:]:
        name, rest = case.split("=", 1)
        config, series, *settings = rest.split(":")
        library = folder / name
        shutil.rmtree(library, ignore_errors=True)
        words = [program, "run", config, "--series", series, "--out", str(library), "--case", name]
        for s in settings:
            words += ["--set", s]
        row(name, "first", *run(words))
        for file in (library / ".trephine-cache").rglob("*"):  # the seconds of the first run stay
            if file.is_file() and "seconds" not in file.name:
                file.unlink()
        row(name, "second", *run(words))
        shutil.copy(library / name / "run.json", folder / f"{name}.run.json")
        shutil.rmtree(library)


if __name__ == "__main__":
    main()
