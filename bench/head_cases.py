#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The phantom heads of bench/landmarks.py, and real heads with points, as whole cases of `configs/ct_head.yaml`.

    bench/head_cases.py TREPHINE FOLDER NAME...             makes and runs these heads (n01 to n15, h01 to h15, x01 to x10, t01 to t05)
    bench/head_cases.py TREPHINE FOLDER --probes DIR --data DIR [NAME...]   real heads with points that a reader placed
    bench/head_cases.py TREPHINE FOLDER --tables [--svg FILE]   makes nothing, and prints what was measured as tables

Each head that has run is a line of FOLDER/rows.jsonl with the program's version and commit, so a later call goes on; of a head that ran
twice the last line counts. A phantom is made once, with 256 x 256 pixels (--pixels). The tables: a row for each head (exit code, verdict,
Dice of brain and ventricles, class asked and found, sure landmarks and the worst of them, sure findings, CPU seconds), and how many
landmarks of each confidence lie within their radius (4 mm, 8 mm in slices of 5 mm and more, the reader's on real heads)."""
import argparse
import json
import math
import os
import pathlib
import resource
import shutil
import subprocess
import sys

import landmarks as marks
from thick_heads import measured

ROOT = pathlib.Path(__file__).resolve().parent.parent


def used():
    r = resource.getrusage(resource.RUSAGE_CHILDREN)
    return r.ru_utime + r.ru_stime


def made(program, at, row, pixels):
    name, variant, seed, noise, step, slices, tilt, *more = row
    if not (at / "truth/truth.json").exists():
        words = ["--level", "hard" if name[0] in marks.HARD else "clinical", "--variant", variant, "--seed", seed, "--noise-hu", noise,
                 "--slice-step-mm", step, "--slices-count", slices, "--tilt-deg", tilt, "--columns-count", pixels, "--rows-count", pixels,
                 "--mesh-step-mm", "0", "--no-labels", "--quiet", *more]
        if pixels == "256":
            words += ["--subvoxel-mm", "0.9"]
        if "--field-of-view-mm" not in more:
            words += ["--field-of-view-mm", "240"]
        if "--slice-thickness-mm" not in more:
            words += ["--slice-thickness-mm", step]
        shutil.rmtree(at, ignore_errors=True)
        subprocess.run([program, "phantom", at, *words], check=True)
    return at / "dicom"


def case_of(program, folder, name, series, more, keep):
    library = folder / "library"
    token = name.lower()
    words = [program, "run", ROOT / "configs/ct_head.yaml", "--series", series, "--out", library, "--case", token, "--no-page", "--no-use-cache",
             "--keep", keep, "--quiet", *more]
    before = used()
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, errors="replace")
    row = {"name": name, "code": done.returncode, "cpu_s": round(used() - before, 1)}
    if done.returncode:
        row["said"] = done.stderr.strip().splitlines()[-1][:400]
        return row
    case = json.loads((library / token / "case.json").read_text())
    figures = case["figures"]
    row["verdict"], row["class"] = figures.get("verdict", ""), figures.get("class", "")
    row["findings"] = [[f["kind"], f["side"], round(f["confidence"], 2), f["text"], [round(v, 1) for v in f["position_mm"]]]
                       for f in case.get("findings", [])]
    row["landmarks"] = {m["name"]: [m["confidence"], m["position_mm"]] for m in case["landmarks"]}
    return row


def phantom(program, folder, row, pixels):
    at = folder / row[0]
    keep = at / "keep"
    choice = ["--series-rule", "best"] if "--second-kernel-mm" in row else []  # of two series of one study
    found = case_of(program, folder, row[0], made(program, at, row, pixels), choice, keep)
    found.update(pixels=int(pixels), asked=row[1], options=" ".join(row[7:]), step_mm=float(row[4]), noise=row[3])
    if found["code"] == 0:
        truth = json.loads((at / "truth/truth.json").read_text())["landmarks_mm"]
        radius = 8.0 if float(row[4]) >= 5 else 4.0
        found["marks"] = {n: [found["landmarks"][n][0] if n in found["landmarks"] else None,
                              math.dist(p, found["landmarks"][n][1]) if n in found["landmarks"] else None, radius] for n, p in truth.items()}
        found["dice"] = [measured(program, at, keep, a, "dice_ratio") for a in ("brain", "ventricles")]
    shutil.rmtree(keep, ignore_errors=True)
    return found


def real(program, folder, data, file):
    reference = json.loads(file.read_text())
    name = file.stem
    settings = {"head_toshiba_5mm": ["--set", "import.series=s4"], "head_mass_d2s": ["--set", "import.volume_values=hu"],
                "head_doe_ge": ["--series-rule", "best"]}
    found = case_of(program, folder, name, data / name, settings.get(name, []), folder / "keep")
    shutil.rmtree(folder / "keep", ignore_errors=True)
    found["real"] = True
    if found["code"] == 0:
        found["marks"] = {}
        for n, m in reference["landmarks"].items():
            have = found["landmarks"].get(n)
            found["marks"][n] = [have[0] if have else None, math.dist(m["p"], have[1]) if have and m else None, m["radius_mm"] if m else 0]
    return found


def text_of_row(r):
    if r["code"]:
        return f"| {r['name']} | {r.get('asked', '')} {r.get('options', '')} | {r['code']} | {r['said'][:200]} | | | | | {r['cpu_s']:.0f} |"
    sure = [(off, n) for n, (c, off, _) in r["marks"].items() if c is not None and off is not None and c >= 0.5]
    worst = max(sure, default=(0, "none"))
    dice = ", ".join("-" if math.isnan(d) else f"{d:.3f}" for d in r.get("dice", []))
    findings = "; ".join(f"{kind} {side} {c}" for kind, side, c, _, _ in r["findings"] if c >= 0.5)
    verdict = r["verdict"].split("; to be looked at")[0]
    return (f"| {r['name']} | {r.get('asked', '')} {r.get('options', '')} | 0 | {verdict} | {dice} | {r['class']} | "
            f"{len(sure)}, {worst[0]:.1f} {worst[1]} | {findings} | {r['cpu_s']:.0f} |")


def tables(rows, svg):
    print("| head | | code | verdict | Dice brain, ventricles | class | sure landmarks, worst mm | sure findings | CPU s |\n"
          "|---|---|---|---|---|---|---|---|---|")
    for r in rows:
        print(text_of_row(r))
    bins = {}
    for kind in (False, True):
        counts = {b: [0, 0] for b in marks.BINS}
        for r in rows:
            if bool(r.get("real")) != kind or r["code"]:
                continue
            for n, (c, off, radius) in r["marks"].items():
                if c is None or off is None:
                    continue  # left out, or a reader does not see it
                b = next(b for b in marks.BINS if b[0] <= c < b[1])
                counts[b][0] += off <= radius
                counts[b][1] += 1
        bins[kind] = counts
        print("real heads" if kind else "phantoms", sum(bool(r.get("real")) == kind for r in rows))
        for b, (inside, count) in counts.items():
            print(f"  {b[0]:.1f} to {min(1, b[1]):.1f}    {inside:3d} of {count:3d}")
    if svg:
        marks.draw([(b[0], b[1], bins[False][b][0] + bins[True][b][0], bins[False][b][1] + bins[True][b][1]) for b in marks.BINS], svg)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trephine")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--pixels", default="256")
    parser.add_argument("--probes", type=pathlib.Path)
    parser.add_argument("--data", type=pathlib.Path)
    parser.add_argument("--tables", action="store_true")
    parser.add_argument("--svg")
    args = parser.parse_intermixed_args()
    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    record = folder / "rows.jsonl"
    if args.tables:
        last = {}
        for line in record.read_text().splitlines():
            r = json.loads(line)
            last[r["name"]] = r
        tables([last[n] for n in sorted(last)], args.svg)
        return
    program = os.path.abspath(args.trephine)
    version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout.strip().splitlines()[0]
    if args.probes:
        heads = [(f.stem, lambda f=f: real(program, folder, args.data, f)) for f in sorted(args.probes.glob("*.json"))]
    else:
        heads = [(row.split()[0], lambda row=row: phantom(program, folder, row.split(), args.pixels))
                 for row in marks.PHANTOMS.strip().splitlines()]
    for name, run in heads:
        if args.names and name not in args.names:
            continue
        found = run()
        found["program"] = version
        with open(record, "a") as out:
            out.write(json.dumps(found) + "\n")
        print(text_of_row(found), flush=True)


if __name__ == "__main__":
    sys.exit(main())
