#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The scans of docs/validation/strangers.md, made again and run: strangers.py TREPHINE FOLDER [--data DIR] [NAME...]

    bench/strangers.py build/release/bin/trephine /tmp/strangers --data /data

Of each row of that page's table: the phantom is made once, or the given series is taken from DIR, a case is made of it without a cache
and without a page, and what a person would read of it is printed: the exit code, CPU seconds, the refusal or else the verdict, the
findings that are told with a confidence of at least 0.5, and the warnings. Names: those of SCANS below. Rows whose scan is not in DIR
are left out with a line."""
import argparse
import json
import pathlib
import re
import resource
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HARD = ("--level hard --columns-count 320 --rows-count 320 --field-of-view-mm 240 --slices-count 92 --slice-step-mm 2 "
        "--slice-thickness-mm 2 --noise-hu 8")
HU = ["--set", "import.volume_values=hu"]
# name: (row, phantom's parameters or a given scan, what is rebuilt in its voxels, recipe, further words of `run`)
SCANS = {
    "bleed": ("1", "--variant shifted --seed 3104 --blood intracerebral --slice-step-mm 5 --slice-thickness-mm 5 --slices-count 38", "", "ct_head", []),
    "bleed_d2s": ("1, 4", "head_mass_d2s", "", "ct_head", HU),
    "bleed_toshiba": ("1, 4", "head_toshiba_5mm", "", "ct_head", ["--set", "import.series=s4"]),
    "board": ("2", "--seed 41 --board --shoulders --field-of-view-mm 420 --centre-mm 0,40,20", "", "ct_head", []),
    "mirror_z": ("3", "--seed 42", "mirror-z", "ct_head", HU),
    "mirror_z_followed": ("3", "--seed 42", "mirror-z", "ct_head", HU),
    "turn_x": ("3", "--seed 42", "turn-x", "ct_head", HU),
    "turn_z": ("3", "--seed 42", "turn-z", "ct_head", HU),
    "quarter_z": ("3", "--seed 42", "quarter-z", "ct_head", HU),
    "mirror_x": ("3", "--seed 42", "mirror-x", "ct_head", HU),
    "doe_ge": ("4, 7", "head_doe_ge", "", "ct_head", ["--series-rule", "best"]),
    "contrast": ("5", "--seed 43 --contrast --shoulders --field-of-view-mm 230 --centre-mm 0,0,20", "", "ct_head", []),
    "lumbar": ("6", "spine_lumbar_hitachi", "", "ct_spine", []),
    "lumbar_bone": ("6", "spine_lumbar_hitachi", "", "ct_spine_bone", []),
    "kernel": ("8", "--seed 44 --kernel-mm 0.6 --sharpen-ratio 3 --noise-hu 14 --slice-step-mm 1.5 --slice-thickness-mm 1.5 --slices-count 122",
               "", "ct_head", []),
    "kernel_skull": ("8", "--seed 44 --kernel-mm 0.6 --sharpen-ratio 3 --noise-hu 14 --slice-step-mm 1.5 --slice-thickness-mm 1.5 --slices-count 122",
                     "", "ct_skull", []),
    "no_offset": ("9", "--seed 42", "no-offset", "ct_head", HU),
    "no_offset_followed": ("9", "--seed 42", "no-offset", "ct_head", HU),
    "several": ("10", "head_toshiba_5mm", "", "ct_head", []),
    "chest": ("11", "chest_clavicle_LIDC-0314_top80", "", "ct_chest", []),
    "other_mr": ("12", "MR", "", "head_ct_mr", []),
    "noise": ("14", "--level simple --seed 5 --noise-hu 25 --kernel-mm 0.6 --columns-count 340 --rows-count 340 --field-of-view-mm 238 "
                    "--slices-count 185 --slice-step-mm 1 --slice-thickness-mm 1", "", "ct_head", []),
    "slit": ("13, x05", "--variant slit --seed 2105 --noise-hu 12 --slice-step-mm 1.5 --slice-thickness-mm 1 --slices-count 122 "
                        "--asymmetry-ratio 0.5 --contrast --couch --burr-hole", "", "ct_head", []),
}


def used():
    r = resource.getrusage(resource.RUSAGE_CHILDREN)
    return r.ru_utime + r.ru_stime


def phantom(program, at, words):
    if (at / "dicom").exists():
        return at / "dicom"
    whole, at = at, at.with_name(at.name + ".part")  # what is cut short is not taken for whole
    shutil.rmtree(at, ignore_errors=True)
    given = {}
    key = None
    for w in (HARD + " " + words).split():  # what comes later takes the place of what came before
        if w.startswith("--"):
            key = w
            given[key] = []
        else:
            given[key].append(w)
    if given["--level"] == ["simple"]:
        given.pop("--level")
    subprocess.run([program, "phantom", at, *(w for k, v in given.items() for w in [k, *v]), "--mesh-step-mm", "0", "--no-labels", "--quiet"], check=True)
    shutil.rmtree(whole, ignore_errors=True)
    at.rename(whole)
    return whole / "dicom"


def series_of(program, folder, data, name, source, defect):
    if source == "MR":  # the CT of one head, the MR of another
        common = "--level clinical --slice-step-mm 2 --slice-thickness-mm 2 --slices-count 96 --columns-count 160 --rows-count 160 --field-of-view-mm 240 "
        second = "--second-scan mr --second-voxel-mm 1.5 --second-noise-ratio 0.04"
        ct = phantom(program, folder / "ct501", common + "--seed 501 " + second)
        phantom(program, folder / "ct502", common + "--seed 502 " + second)
        return ct, ["--scan", f"mr={folder / 'ct502/second/scan.nrrd'}"]
    if not source.startswith("--"):
        return (data / source if data and (data / source).exists() else None), []
    at = folder / re.sub(r"_followed$|_skull$", "", name)
    dicom = phantom(program, at, source)
    if not defect:
        return dicom, []
    stored = at / f"{defect}.nrrd"
    if not stored.exists():
        subprocess.run([program, "import", dicom, "--output", at / "volume.nrrd", "--quiet"], check=True)
        subprocess.run([sys.executable, ROOT / "bench/rebuild_defects.py", defect, at / "volume.nrrd", stored], check=True)
    return stored, []


def case_text(folder):
    case = json.loads((folder / "case.json").read_text())
    sure = [f"{f['kind']} {f.get('volume_ml', '')}".strip() for f in case.get("findings", []) if f["confidence"] >= 0.5]
    return f"{case['figures'].get('verdict', 'no verdict')}; told: {', '.join(sure) or 'nothing'}"


def main():
    parse = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("trephine")
    parse.add_argument("folder", type=pathlib.Path)
    parse.add_argument("names", nargs="*")
    parse.add_argument("--data", type=pathlib.Path)
    asked = parse.parse_intermixed_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    unknown = set(asked.names) - set(SCANS)
    if unknown:
        parse.error(f"no such scan: {', '.join(sorted(unknown))}")
    for name in asked.names or SCANS:
        row, source, defect, recipe, words = SCANS[name]
        folder = asked.folder.resolve()
        series, more = series_of(asked.trephine, folder, asked.data, name, source, defect)
        if series is None:
            print(f"{name} ({row}): {source} is not there", flush=True)
            continue
        library = folder / "library"
        shutil.rmtree(library / name, ignore_errors=True)
        run = [asked.trephine, "run", ROOT / f"configs/{recipe}.yaml", "--series", series, "--out", library, "--case", name, "--no-page", "--no-pictures",
               "--no-use-cache", "--quiet", *words, *more]
        before = used()
        done = subprocess.run([str(w) for w in run], capture_output=True, text=True, errors="replace")
        if name.endswith("_followed") and done.returncode == 65:
            remedy = re.search(r"mirrored by --set (import\.axes=\w+)", done.stderr) or re.search(r"--set (import\.offset_hu=-?\d+)", done.stderr)
            if not remedy:
                print(f"{name} ({row}): no remedy can be read: {done.stderr.strip().splitlines()[-1]}", flush=True)
                continue
            before = used()
            done = subprocess.run([str(w) for w in run + ["--set", remedy[1]]], capture_output=True, text=True, errors="replace")
        elif name.endswith("_followed"):
            print(f"{name} ({row}): {done.returncode} in place of a refusal with 65", flush=True)
            continue
        seconds = used() - before
        said = done.stderr.strip().splitlines()
        told = case_text(library / name) if done.returncode == 0 else (said or [""])[-1]
        print(f"{name} ({row}): {done.returncode}, {seconds:.1f} CPU s: {told}", flush=True)
        for line in said if done.returncode == 0 else []:
            print("    " + line[:400], flush=True)


if __name__ == "__main__":
    main()
