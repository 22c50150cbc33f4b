#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""15 heads in slices of 5 to 7 mm with bleeds, boards, masks, turned and mirrored, as whole cases.

    bench/thick_heads.py TREPHINE FOLDER [NAME ...]

Makes the phantoms once, runs `configs/ct_head.yaml` on each, and prints a row of a table: the exit code, what the case's verdict says
of its anatomies, Dice of brain and ventricles with the truth, the class asked and found, the worst landmark that is sure (mm), how
many are sure, what findings are told, and CPU seconds. A head that is turned or mirrored against its tags must be refused with 65; then
the axes that the message names are set. A bleed counts as told where a finding that is sure is dense tissue.
"""
import json
import math
import pathlib
import re
import resource
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# name variant seed noise slice slices tilt defect options
HEADS = """
k01 normal 3101 6 5 38 0 - --blood intracerebral
k02 normal 3102 8 5 40 -12 - --blood subdural --couch
k03 hydrocephalic 3103 6 5 38 0 - --blood intraventricular --shunt
k04 shifted 3104 7 5 38 0 - --blood intracerebral --board
k05 small 3105 8 5 40 15 - --board --shoulders --field-of-view-mm 420 --centre-mm 0,40,20
k06 normal 3106 5 6 32 0 - --mask --clamps --couch --field-of-view-mm 280
k07 hydrocephalic 3107 7 6 32 0 - --blood subdural --plexus
k08 shifted 3108 6 6 34 -10 - --craniectomy --blood subdural
k09 slit 3109 6 6 32 0 - --burr-hole --couch
k10 normal 3110 8 7 28 0 - --blood intracerebral --couch
k11 hydrocephalic 3111 6 7 28 0 - --board
k12 normal 3112 6 5 38 0 mirror-z --blood intracerebral
k13 hydrocephalic 3113 7 5 38 0 turn-z -
k14 small 3114 6 6 32 0 turn-x --blood intraventricular
k15 shifted 3115 8 5 38 0 quarter-z --couch
"""


def used():
    r = resource.getrusage(resource.RUSAGE_CHILDREN)
    return r.ru_utime + r.ru_stime


def trephine(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, errors="replace")
    return done.returncode, done.stderr


def made(program, at, row):
    name, variant, seed, noise, step, slices, tilt, defect, *more = row
    more = [m for m in more if m != "-"]
    if not (at / "dicom").exists():
        code, said = trephine(program, "phantom", at, "--level", "hard", "--variant", variant, "--seed", seed, "--noise-hu", noise,
                              "--slice-step-mm", step, "--slice-thickness-mm", step, "--slices-count", slices, "--tilt-deg", tilt,
                              "--columns-count", "320", "--rows-count", "320", "--mesh-step-mm", "0", "--no-labels", "--quiet",
                              *([] if "--field-of-view-mm" in more else ["--field-of-view-mm", "240"]), *more)
        if code:
            sys.exit(f"{name}: {said}")
    if defect == "-":
        return at / "dicom", []
    stored = at / f"{defect}.nrrd"
    if not stored.exists():
        trephine(program, "import", at / "dicom", "--output", at / "volume.nrrd", "--quiet")
        subprocess.run([sys.executable, ROOT / "bench/rebuild_defects.py", defect, at / "volume.nrrd", stored], check=True)
    return stored, ["--set", "import.volume_values=hu"]


def measured(program, at, keep, anatomy, key):
    """A figure of the anatomy's last field against the truth; nan without a field."""
    fields = [f for step in ("correct", "simplify", "shape_interpolate", "smooth_field", anatomy, "segment") for f in keep.glob(f"{anatomy}.{step}.nrrd")]
    if not fields:
        return math.nan
    report = at / f"{anatomy}.json"
    report.unlink(missing_ok=True)
    code, said = trephine(program, "measure", fields[0], "--truth", at / "truth/truth.json", "--anatomy", anatomy, "--sample-count", "3000",
                          "--report", report, "--quiet")
    if code:
        print(said, file=sys.stderr)
        return math.nan
    found = re.search(rf'"{key}": ([-0-9.e+]+)', report.read_text())
    return float(found[1]) if found else math.nan


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    program, folder, names = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), sys.argv[3:]
    folder.mkdir(parents=True, exist_ok=True)
    print("| head | | code | verdict | Dice brain, ventricles | class | sure landmarks, worst mm | sure findings | CPU s |\n|---|---|---|---|---|---|---|---|---|")
    for row in (line.split() for line in HEADS.strip().splitlines()):
        name, variant, defect = row[0], row[1], row[7]
        if names and name not in names:
            continue
        at, keep = folder / name, folder / name / "keep"
        series, more = made(program, at, row)
        run = [program, "run", ROOT / "configs/ct_head.yaml", "--series", series, "--out", folder / "library", "--case", name, "--no-page",
               "--no-pictures", "--keep", keep, "--quiet"]
        before = used()
        code, said = trephine(*run, *more)
        first = ""
        axes = re.search(r"mirrored by --set (import\.axes=\w+).*turned by --set (import\.axes=\w+)", said)
        if defect != "-" and code == 65 and axes:
            first = "65, then "
            code, said = trephine(*run, *more, "--set", axes[1 if defect.startswith("mirror") else 2])
        seconds = used() - before
        told = {"-": ""}.get(defect, defect) + " " + " ".join(w for w in row[8:] if w != "-")
        if code:
            print(f"| {name} | {variant} {row[4]} mm {told} | {first}{code} | {said.strip().splitlines()[-1][:300]} | | | | | {seconds:.0f} |", flush=True)
            continue
        case = json.loads((folder / "library" / name / "case.json").read_text())
        truth = json.loads((at / "truth/truth.json").read_text())
        figures = dict((f["name"], f["value"]) if isinstance(f, dict) else f for f in (case["figures"].items() if isinstance(case["figures"], dict) else case["figures"]))
        sure = [(math.dist(mark["position_mm"], truth["landmarks_mm"][mark["name"]]), mark["name"]) for mark in case["landmarks"]
                if mark["name"] in truth["landmarks_mm"] and mark["confidence"] >= 0.5]
        worst = max(sure, default=(0, "none"))
        dice = [measured(program, at, keep, a, "dice_ratio") for a in ("brain", "ventricles")]
        findings = [f"{f['kind']}" for f in case.get("findings", []) if f["confidence"] >= 0.5]
        print(f"| {name} | {variant} {row[4]} mm {told} | {first}0 | {figures.get('verdict', '')} | {dice[0]:.3f}, {dice[1]:.3f} | "
              f"{figures.get('class', '')} | {len(sure)}, {worst[0]:.1f} {worst[1]} | {', '.join(findings)} | {seconds:.0f} |", flush=True)


if __name__ == "__main__":
    main()
