#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""force_changes.py PROGRAM EXERCISES OUT [LESSON=CASE ...]: how often the force changes, and by how much, in whole lessons.

PROGRAM is trephine-sim; EXERCISES the library of exercises that docs/how-to/teach-a-group.md makes. Each lesson is done by the script of
examples/lessons, its recording replayed, and a row of docs/validation/haptics.md printed. Recordings stay in OUT. No figure depends on
what else the machine does."""
import json
import pathlib
import subprocess
import sys

SCRIPTS = pathlib.Path(__file__).resolve().parent.parent / "examples" / "lessons"
LESSONS = (
    [("ventriculostomy", case) for case in ("normal-1", "hydrocephalic-1", "shifted-1", "small-1")]
    + [("spine_needle", case) for case in ("spine-1", "spine-2")]
    + [("pedicle_screw", case) for case in ("spine-1", "spine-2")]
    + [("subclavian", case) for case in ("chest-1", "chest-2")]
)
LIMITS = ("0.02", "0.05", "0.1", "0.2", "0.5")


def row(name, ticks, changes, anomaly):
    above = " | ".join(f"{changes['above_n_per_ms'][limit]:,}" for limit in LIMITS)
    print(f"| {name} | {ticks} | {changes['ticks']:,} | {above} | {changes['named']:,} | "
          f"{changes['most_n_per_ms']:.3f} | {changes['turns']:,} | {anomaly} |", flush=True)


def main():
    program, exercises, out = sys.argv[1:4]
    lessons = [tuple(word.split("=")) for word in sys.argv[4:]] or LESSONS
    pathlib.Path(out).mkdir(parents=True, exist_ok=True)
    print("| lesson, case | ticks | of | > " + " | > ".join(LIMITS) + " | named | most, N/ms | turns | anomaly |")
    print("|---" * 12 + "|")
    for lesson, case in lessons:
        folder, file = pathlib.Path(exercises) / case, pathlib.Path(out) / f"{lesson}-{case}.lesson"
        said = pathlib.Path(out) / f"{lesson}-{case}.json"
        file.unlink(missing_ok=True)
        subprocess.run([program, "lesson", folder, "--script", SCRIPTS / f"{lesson}.json", "--record", file], check=True,
                       stdout=subprocess.DEVNULL)
        subprocess.run([program, "replay", folder, file, "--json", said], check=True, stdout=subprocess.DEVNULL)
        figures = json.loads(said.read_text())
        anomaly = f"{figures['recorded']['anomaly_ratio']:.4f}"
        row(f"{lesson}, {case}", "all", figures["force_changes"]["all"], anomaly)
        if figures["force_changes"]["drilling"]["ticks"]:
            row(f"{lesson}, {case}", "drilling", figures["force_changes"]["drilling"], anomaly)


if __name__ == "__main__":
    main()
