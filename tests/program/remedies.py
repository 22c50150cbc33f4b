#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows what refusals say to do, word for word, on the inputs that caused them.

remedies.py TREPHINE SOURCE WORK

Each scan below has a defect that makes `run` end otherwise than with 0. What its last line says to do is read as a person reads it:
a `--set KEY=VALUE` or a `--flag VALUE` is typed again, `set VALUE for `KEY`` and `set `KEY` to VALUE` become `--set STAGE.KEY=VALUE`
with the stage that the line names, `is made by FILE.yaml` is run instead. Each of them, tried alone, must end in 0, or in another
line that names another limit; 64 (no such parameter, no such value) is never right. At least one must end in 0 where the scan allows it.
"""
import pathlib
import re
import shutil
import subprocess
import sys

TREPHINE, SOURCE, WORK = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
faults = []


def run(config, series, more):
    shutil.rmtree(WORK / "library" / "a", ignore_errors=True)
    done = subprocess.run([TREPHINE, "run", config, "--root", SOURCE, "--series", series, "--out", WORK / "library", "--case", "a", "--quiet",
                           "--no-page", "--no-pictures", *more], capture_output=True, text=True, errors="replace", cwd=WORK)
    lines = [line for line in done.stderr.splitlines() if line.startswith("trephine run:")]
    return done.returncode, lines[-1] if lines else ""


def remedies(line):
    """[words for the command line, or a configuration] of all that the line says to do."""
    found = []
    for value in re.findall(r"--set ([a-z][\w.]*=[^\s,;()]+)", line):
        found.append(["--set", value.replace("=WHY", "=a reader said so")])
    for flag in re.findall(r"--(?!set\b|list\b)([a-z][a-z-]*)", line):
        faults.append(f"--{flag} is no flag of `run`: {line}")
    stage = re.match(r"trephine run: a: ([a-z0-9_.]+): ", line)
    where = stage[1] if stage else ""
    for value, key, of in re.findall(r"set ([\d.]+) for `(\w+)`(?: of the stage `(\w+)`)?", line):
        found.append(["--set", f"{of or where}.{key}={value.rstrip('.')}"])
    for key, value in re.findall(r"set `(\w+)` to ([\d.]+)", line):
        found.append(["--set", f"{where}.{key}={value.rstrip('.')}"])
    found += [SOURCE / "configs" / name for name in re.findall(r"is made by (\w+\.yaml)", line)]
    # The same words twice are one remedy.
    return [f for i, f in enumerate(found) if f not in found[:i]]


def follow(name, config, series, *, code, more=(), allowed=True, together=False):
    """`allowed`: one remedy ends in 0. `together`: the line says to do all of them at once."""
    config = SOURCE / "configs" / config  # a path of its own stays
    got, line = run(config, series, list(more))
    print(f"{name}: {got}: {line}")
    if got != code:
        faults.append(f"{name}: ends with {got} instead of {code}: {line}")
        return
    said = remedies(line)
    if not said:
        faults.append(f"{name}: nothing that can be typed: {line}")
        return
    if together:
        said = [[word for words in said if isinstance(words, list) for word in words]]
    ended = []
    for words in said:
        if isinstance(words, pathlib.Path):
            again, other = run(words, series, list(more))
        else:
            again, other = run(config, series, list(more) + words)
        print(f"    {words}: {again}: {other}")
        ended.append(again)
        if again not in (0, 65, 66, 80, 81):
            faults.append(f"{name}: {words} ends with {again}: {other}")
        elif again != 0 and other == line:
            faults.append(f"{name}: {words} changes nothing: {other}")
    if allowed and 0 not in ended:
        faults.append(f"{name}: no remedy ends in 0")


def phantom(name, *more, series="dicom"):
    folder = WORK / name
    small = ("--level hard --variant normal --seed 77 --columns-count 160 --rows-count 160 --slices-count 80 --field-of-view-mm 256 "
             "--slice-step-mm 2.5 --slice-thickness-mm 2.5 --noise-hu 5 --mesh-step-mm 0 --no-labels --quiet").split()
    # The flags that are given take the place of those above.
    given = {w for w in more if w.startswith("--")}
    words, i = [], 0
    while i < len(small):
        has_value = i + 1 < len(small) and not small[i + 1].startswith("--")
        if small[i] not in given:
            words += small[i : i + 1 + has_value]
        i += 1 + has_value
    if "--body" in given:
        words = [w for w in words if w not in ("--level", "hard", "--variant", "normal")]
    subprocess.run([TREPHINE, "phantom", folder, *words, *more], check=True, stdout=subprocess.DEVNULL)
    return folder / series


def rebuilt(defect, volume):
    out = WORK / f"{defect}.nrrd"
    subprocess.run([sys.executable, SOURCE / "bench/rebuild_defects.py", defect, volume, out], check=True)
    return out


head = phantom("head")
volume = WORK / "head.nrrd"
subprocess.run([TREPHINE, "import", head, "--output", volume, "--quiet"], check=True)
hu = ["--set", "import.volume_values=hu"]
# The tags say another place than the picture.
for defect in ("mirror-z", "turn-x", "turn-z", "quarter-z"):
    follow(defect, "ct_skull.yaml", rebuilt(defect, volume), code=65, more=hu)
follow("no offset", "ct_skull.yaml", rebuilt("no-offset", volume), code=65, more=hu)
follow("a volume without its unit", "ct_skull.yaml", volume, code=78)
# Two series of one scan, a slice that is missing, and another modality.
follow("two kernels", "ct_skull.yaml", phantom("two", "--second-kernel-mm", "0.6"), code=64)
gap = WORK / "gap"
shutil.copytree(head, gap)
for file in sorted(gap.iterdir())[40:42]:
    file.unlink()
follow("missing slices", "ct_skull.yaml", gap, code=65)
spine = "--body spine --slice-step-mm 1.25 --slice-thickness-mm 1.25 --slices-count 150".split()
# The field of view cuts the body, and the recipe needs its skin.
follow("narrow", "ct_spine.yaml", phantom("spine", *spine, "--field-of-view-mm", "150"), code=80)
follow("wholly inside", "ct_spine.yaml", phantom("inside", *spine, "--field-of-view-mm", "100"), code=80)
# Noise: the scene takes no simple brain.
follow("noise", "ct_head.yaml", phantom("noisy", "--noise-hu", "45"), code=80, more=["--set", "scene.strict=true"], together=True)
# Skin and bone too near to each other, as where the skin is taken for what it is not.
follow("near", "ct_head.yaml", head, code=80, more=["--set", "anatomy.min_skin_skull_gap_mm=19"])
# More triangles than the scene allows, which decimation may not take away.
follow("triangles", "ct_skull.yaml", head, code=80,
       more=["--set", "scene.anatomies.skull.max_triangles=5000", "--set", "skull.decimate.max_deviation_mm=0.05"])
# A hole that lies behind the suture.
drilled = (SOURCE / "configs/sample_drilled.yaml").read_text().replace(": ../", f": {SOURCE}/").replace("scene: ", f"scene: {SOURCE}/configs/")
drilled = drilled.replace("  inion:", "  bregma: [0, -12, 126]\n  inion:").replace("at: kocher,", "at: kocher, along_mm: 170,")
(WORK / "drilled.yaml").write_text(drilled)
coarse = ["--set", "resample.spacing_mm=[3.5,3.5,3.5]", "--set", "haptic.spacing_mm=[2,2,2]"]
follow("kocher", WORK / "drilled.yaml", SOURCE / "sample_dicom", code=80, more=coarse)

for fault in faults:
    print("FAILED:", fault)
sys.exit(bool(faults))
