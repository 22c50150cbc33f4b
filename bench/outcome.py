#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well `trephine outcome` measures what was put in: phantoms of a head before and after a ventriculostomy.

    bench/outcome.py TREPHINE FOLDER [CATHETERS [WITHOUT [SEED,SEED ...]]]

Makes a case of each head (seeds 3, 21, 34), and of each in turn CATHETERS (20) scans after the procedure in all, which differ in side, hole, aim, bend,
thickness of the slices, noise, tilt, how the head lies, what of it is scanned, shifted ventricles, air and staples; and WITHOUT (10)
scans without a catheter, some with a hole. Prints a row for each (tip, axis, registration at the tip and what was stated of it, hole, in
mm and degrees) and a summary. A folder that exists is not made again.
"""
import json
import math
import pathlib
import random
import resource
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCANNER = ["--level", "hard", "--columns-count", "256", "--rows-count", "256", "--field-of-view-mm", "230", "--mesh-step-mm", "0", "--subvoxel-mm",
           "0.7", "--no-labels", "--quiet"]


def used():
    r = resource.getrusage(resource.RUSAGE_CHILDREN)
    return r.ru_utime + r.ru_stime


def trephine(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, errors="replace")
    return done.returncode, done.stdout, done.stderr


def must(*words):
    code, _, said = trephine(*words)
    if code:
        sys.exit(f"{' '.join(map(str, words[1:4]))}: {code}: {said}")


def case_of(program, folder, seed):
    at = folder / f"before{seed}"
    if not (at / "dicom").exists():
        must(program, "phantom", at, "--seed", seed, *SCANNER, "--slices-count", 110, "--slice-step-mm", 1.6, "--slice-thickness-mm", 1.6,
             "--noise-hu", 6, "--centre-mm", "0,-10,54")
    case = folder / "library" / f"head{seed}"
    if not (case / "case.json").exists():
        must(program, "run", ROOT / "configs/ct_head.yaml", "--series", at / "dicom", "--out", folder / "library", "--case", case.name,
             "--no-page", "--quiet")
    return case


def options_of(n, kind):
    r = random.Random(1000 * (kind != "catheter") + n)
    step = r.choice([1, 1.5, 2, 2.5, 3])
    height = r.choice([125, 150, 170])  # mm: the upper head, or nearly all of it
    turn, shift = [[round(r.uniform(-a, a), 1) for _ in range(3)] for a in (14, 25)]
    words = ["--slice-step-mm", step, "--slice-thickness-mm", step, "--slices-count", int(height / step),
             "--centre-mm", f"{shift[0]},{shift[1] - 8},{round(shift[2] + 128 - height / 2)}", "--noise-hu", r.choice([5, 10, 20]), "--kernel-mm", r.choice([1, 1.4, 1.8]),
             "--tilt-deg", r.choice([0, 0, 8, -12, 16]),
             "--head-turn-deg", ",".join(map(str, turn)), "--head-shift-mm", ",".join(map(str, shift))]
    variant = r.choice(["normal", "normal", "shifted"])
    implants = kind if kind == "catheter" else r.choice(["none", "none", "burr_hole"])
    if implants != "none":
        words += ["--implants", implants, "--implant-side", r.choice(["right", "left"]),
                  "--implant-lateral-mm", round(r.uniform(-8, 12), 1), "--implant-anterior-mm", round(r.uniform(-8, 12), 1),
                  "--implant-hole-mm", r.choice([9, 11, 14]), "--implant-air-ml", r.choice([0, 0, 4, 12]),
                  "--implant-staples-count", r.choice([0, 0, 6])]
    if implants == "catheter":
        words += ["--implant-aim-mm", ",".join(str(round(r.uniform(-9, 9), 1)) for _ in range(3)),
                  "--implant-bend-mm", r.choice([0, 0, 1, 3]), "--implant-catheter-hu", r.choice([700, 1500, 2200])]
    if kind == "without" and r.random() < 0.4:
        words += ["--plexus"]
    return variant, step, words


def off(a, b):
    return math.sqrt(sum((x - y) ** 2 for x, y in zip(a, b)))


def placed(m, p):
    return [sum(m[4 * a + k] * p[k] for k in range(3)) + m[4 * a + 3] for a in range(3)]


def unit(v):
    n = math.sqrt(sum(x * x for x in v))
    return [x / n for x in v]


def percentile(values, share):
    v = sorted(values)
    at = share * (len(v) - 1)
    low = int(at)
    return v[low] + (at - low) * (v[min(low + 1, len(v) - 1)] - v[low])


def line_through(points):
    """The direction of the longest axis, by power iteration."""
    m = [sum(p[a] for p in points) / len(points) for a in range(3)]
    d = [[p[a] - m[a] for a in range(3)] for p in points]
    v = unit([points[0][a] - points[-1][a] for a in range(3)])
    for _ in range(30):
        v = unit([sum(q[a] * sum(x * y for x, y in zip(q, v)) for q in d) for a in range(3)])
    return v


def main():
    program, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    without = int(sys.argv[4]) if len(sys.argv) > 4 else 10
    seeds = [int(s) for s in (sys.argv[5] if len(sys.argv) > 5 else "3,21,34").split(",")]
    folder.mkdir(parents=True, exist_ok=True)
    tips, axes, places, stated, holes, doubtful, missed, wrong, false = [], [], [], [], [], [], [], [], []
    bad_and_sure, widths = [], []
    print("| scan | slices mm | tip mm | axis deg | registration at the tip mm | stated mm | hole mm | width off mm | found | CPU s |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for kind, n in [("catheter", n) for n in range(count)] + [("without", n) for n in range(without)]:
        seed = seeds[n % len(seeds)]
        case = case_of(program, folder, seed)
        variant, step, words = options_of(n, kind)
        name = f"{kind[0]}{n:02}"
        after = folder / name
        if not (after / "dicom").exists():
            must(program, "phantom", after, "--seed", seed, "--variant", variant, *SCANNER, *words)
        begin = used()
        code, said, why = trephine(program, "outcome", case, "--series", after / "dicom", "--out", after / "outcome")
        cpu = used() - begin
        truth = json.loads((after / "truth/truth.json").read_text())
        put_in = truth.get("put_in", [])
        if code:
            doubtful.append(name)
            print(f"| {name} | {step} | | | | | | | refused {code}: {why.strip()[-120:]} | {cpu:.0f} |")
            continue
        r = json.loads((after / "outcome/outcome.json").read_text())
        pose = [x for row in truth["head_to_scan"] for x in row]
        where = put_in[0]["tip_mm"] if put_in and "tip_mm" in put_in[0] else [0, -10, 60]
        place = off(placed(pose, where), placed(r["registration"]["transform"], where))
        places.append(place)
        cells = ["", "", f"{place:.2f}", "", "", ""]
        found = r["catheter"] + (" (" + r["catheter_doubts"] + ")" if r["catheter_doubts"] else "")
        sure_holes = [h for h in r["holes"] if h["confidence"] >= 0.5]
        if r["registration"]["sighting"] != "found":
            found += "; registration doubtful: " + r["registration"]["doubts"]
        if kind == "catheter":
            t = put_in[0]
            if not r["courses"]:
                missed.append(name)
            else:
                c = r["courses"][0]
                tip, axis = off(c["tip_mm"], t["tip_mm"]), math.degrees(math.acos(min(1, abs(sum(
                    x * y for x, y in zip(c["axis"], line_through(t["course_mm"] )))))))
                cells[0], cells[1], cells[3] = f"{tip:.2f}", f"{axis:.2f}", f"{c['error_mm']:.2f}"
                stated.append((place, c["error_mm"]))
                if r["catheter"] == "doubtful":
                    doubtful.append(name)
                else:
                    tips.append(tip), axes.append(axis)
                    if tip > 1 or axis > 1.5:
                        bad_and_sure.append(name)
                if c["side"] != t["side"]:
                    wrong.append(name)
        elif r["courses"]:
            false.append(name)
        if put_in:
            if r["holes"]:
                h = min(r["holes"], key=lambda h: off(h["outer_mm"], put_in[0]["hole_mm"]))
                cells[4] = f"{off(h['outer_mm'], put_in[0]['hole_mm']):.2f}"
                cells[5] = f"{h['diameter_mm'] - put_in[0]['hole_diameter_mm']:+.1f}"
                cells[5] += "" if h["confidence"] >= 0.5 else " (doubtful)"
                if h["confidence"] >= 0.5:
                    holes.append(float(cells[4])), widths.append(h["diameter_mm"] - put_in[0]["hole_diameter_mm"])
                if h["side"] != put_in[0]["side"]:
                    wrong.append(name + " hole")
            else:
                missed.append(name + " hole")
        false += [name + " hole"] * max(0, len(sure_holes) - len(put_in))
        print(f"| {name} | {step} | {' | '.join(cells)} | {found} | {cpu:.0f} |", flush=True)
    print()
    for what, values in (("tip mm", tips), ("axis deg", axes), ("registration mm", places), ("hole mm", holes)):
        if values:
            print(f"{what}: median {percentile(values, 0.5):.2f}, 95th percentile {percentile(values, 0.95):.2f}, most {max(values):.2f}"
                  f" (of {len(values)})")
    if widths:
        print(f"sure holes' width off mm: {min(widths):+.2f} to {max(widths):+.2f}, median {percentile(widths, 0.5):+.2f} (of {len(widths)})")
    if stated:
        print(f"registration error within twice what was stated: {sum(p <= 2 * s for p, s in stated)} of {len(stated)}")
    print(f"doubtful or refused {len(doubtful)} {doubtful}, beyond the limits and sure {bad_and_sure}, not found {missed}, "
          f"wrong side {wrong}, found where there is none {false}")


if __name__ == "__main__":
    main()
