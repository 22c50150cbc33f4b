#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well `trephine outcome` measures pedicle screws: phantoms of a spine before and after.

    bench/outcome_spine.py TREPHINE FOLDER [SCANS [WITHOUT [SEED,SEED ...]]]

Makes a case of each spine (seeds 3, 21), and of each in turn SCANS (20) scans with screws, which differ in side, level, place, direction,
size, rods, thickness of the slices, noise, tilt, how the spine lies and bends, what of it is scanned; and WITHOUT (10) scans without
screws. Prints a row for each screw (tip, axis, entry, length, diameter, registration at the tip and what was stated of it, in mm and
degrees) and a summary. A folder that exists is not made again.
"""
import json
import math
import pathlib
import random
import sys

from outcome import ROOT, must, off, percentile, placed, trephine, used

SCANNER = ["--body", "spine", "--columns-count", "256", "--rows-count", "256", "--field-of-view-mm", "230", "--no-labels", "--quiet"]


def case_of(program, folder, seed):
    at = folder / f"before{seed}"
    if not (at / "dicom").exists():
        must(program, "phantom", at, "--vertebrae-seed", seed, *SCANNER, "--slices-count", 160, "--noise-hu", 10)
    case = folder / "library" / f"spine{seed}"
    if not (case / "case.json").exists():
        must(program, "run", ROOT / "configs/ct_spine.yaml", "--series", at / "dicom", "--out", folder / "library", "--case", case.name,
             "--no-page", "--quiet")
    return case


def options_of(n, kind):
    r = random.Random(1000 * (kind != "screws") + n)
    step = r.choice([1, 1, 1.5, 2, 3])
    height = r.choice([90, 110, 140])
    turn, shift = [[round(r.uniform(-a, a), 1) for _ in range(3)] for a in (8, 15)]
    words = ["--slice-step-mm", step, "--slice-thickness-mm", step, "--slices-count", int(height / step), "--noise-hu", r.choice([8, 15, 25]),
             "--kernel-mm", r.choice([1, 1.4, 1.8]), "--tilt-deg", r.choice([0, 0, 0, 8, -10]), "--streak-hu", r.choice([100, 200, 350]),
             "--head-turn-deg", ",".join(map(str, turn)), "--head-shift-mm", ",".join(map(str, shift)),
             "--centre-mm", f"{shift[0]},{shift[1] - 10},{shift[2] + 42 + r.choice([0, 12])}",
             "--vertebra-bend-deg", round(r.uniform(-3, 3), 1), "--seed", n + 1]
    if kind == "screws":
        levels = r.choice([1, 1, 2])
        words += ["--screws", r.choice(["left", "right", "both"]), "--screw-levels-count", levels,
                  "--screw-diameter-mm", r.choice([5.5, 6.5, 7.5]), "--screw-length-mm", r.choice([35, 40, 45, 50]),
                  "--screw-seat-mm", r.choice([0, 1, 3]), "--screw-aside-mm", round(r.uniform(-4, 4), 1),
                  "--screw-up-mm", round(r.uniform(-4, 4), 1), "--screw-axial-deg", round(r.uniform(-9, 9), 1),
                  "--screw-sagittal-deg", round(r.uniform(-9, 9), 1), "--screw-hu", r.choice([7000, 8000, 9500])]
        if levels > 1 and r.random() < 0.5:
            words += ["--screw-rods"]
    return step, words


def pedicle_of(case, screw):
    """The name that the case has for the pedicle of a screw: the one whose middle its true axis passes nearest."""
    at = {m["name"]: m["position_mm"] for m in case["landmarks"]}

    def passes(name):
        d = [0.6 * e + 0.4 * t - h for e, t, h in zip(at[name + "_entry"], at[name + "_target"], screw["head_mm"])]
        along = sum(a * b for a, b in zip(d, screw["axis"]))
        return off(d, [along * a for a in screw["axis"]])
    return min({name[:-6] for name in at if name.endswith("_entry")}, key=passes)


def main():
    program, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    without = int(sys.argv[4]) if len(sys.argv) > 4 else 10
    seeds = [int(s) for s in (sys.argv[5] if len(sys.argv) > 5 else "3,21").split(",")]
    folder.mkdir(parents=True, exist_ok=True)
    values = {what: [] for what in ("tip mm", "axis deg", "entry mm", "length off mm", "diameter off mm", "registration mm")}
    doubtful, missed, wrong, false, bad_and_sure, bad_and_doubtful, stated, screws = [], [], [], [], [], [], [], 0
    print("| screw | slices mm | tip mm | axis deg | entry mm | length mm | diameter mm | registration mm | stated mm | found | CPU s |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for kind, n in [("screws", n) for n in range(count)] + [("without", n) for n in range(without)]:
        seed = seeds[n % len(seeds)]
        case = case_of(program, folder, seed)
        before = json.loads((case / "case.json").read_text())
        step, words = options_of(n, kind)
        name = f"{kind[0]}{n:02}"
        after = folder / f"{name}-{seed}"
        if not (after / "dicom").exists():
            must(program, "phantom", after, "--vertebrae-seed", seed, *SCANNER, *words)
        begin = used()
        code, _, why = trephine(program, "outcome", case, "--series", after / "dicom", "--out", after / "outcome")
        cpu = used() - begin
        put_in = json.loads((after / "truth/truth.json").read_text()).get("put_in", [])
        if code:
            doubtful += [name] * max(1, len(put_in))
            screws += len(put_in)
            print(f"| {name} | {step} | | | | | | | | refused {code}: {why.strip()[-140:]} | {cpu:.0f} |")
            continue
        r = json.loads((after / "outcome/outcome.json").read_text())
        left = list(r.get("screws", []))
        margin = f"next level {r['registration']['next_level_residual_mm'] / r['registration']['residual_mm']:.1f} x"
        for t in put_in:
            screws += 1
            at = name + " " + t["screw"]
            if not left:
                missed.append(at)
                print(f"| {at} | {step} | | | | | | | | not found; {margin} | {cpu:.0f} |")
                continue
            s = min(left, key=lambda s: off(s["tip_mm"], t["tip_mm"]))
            left.remove(s)
            number = int("".join(c for c in s["pedicle"] if c.isdigit()))
            true = pedicle_of(before, t)
            maps = [v["transform"] for v in r["vertebrae"] if v["number"] == number]
            tip, axis = off(s["tip_mm"], t["tip_mm"]), math.degrees(math.acos(min(1, sum(a * b for a, b in zip(s["axis"], t["axis"])))))
            entry, length, wide = off(s["entry_mm"], t["entry_mm"]), s["length_mm"] - t["length_mm"], s["diameter_mm"] - t["diameter_mm"]
            place = off(placed([x for row in t["to_scan"] for x in row], t["tip_mm"]), placed(maps[0], t["tip_mm"]))
            sure = s["sighting"] == "found"
            found = s["sighting"] + (" (" + s["doubts"] + ")" if s["doubts"] else "") + "; " + margin
            if r["registration"]["doubts"]:
                found += "; registration: " + r["registration"]["doubts"]
            bad = tip > 1 or axis > 1.5
            if sure:
                for what, value in zip(values, (tip, axis, entry, abs(length), abs(wide), place)):
                    values[what].append(value)
                stated.append((place, s["error_mm"]))
                if bad:
                    bad_and_sure.append(at)
                if s["pedicle"] != true:
                    wrong.append(f"{at}: {s['pedicle']} for {true}")
            else:
                doubtful.append(at)
                if bad:
                    bad_and_doubtful.append(at)
            print(f"| {at} | {step} | {tip:.2f} | {axis:.2f} | {entry:.2f} | {length:+.1f} | {wide:+.2f} | {place:.2f} | {s['error_mm']:.2f} | "
                  f"{found} | {cpu:.0f} |", flush=True)
        false += [f"{name} {s['pedicle']} {s['sighting']}" for s in left]
        if not put_in:
            print(f"| {name} | {step} | | | | | | | | {len(r.get('screws', []))} screws; {margin} "
                  f"{r['registration']['doubts']} | {cpu:.0f} |", flush=True)
    print()
    for what, of in values.items():
        if of:
            print(f"{what}: median {percentile(of, 0.5):.2f}, 95th percentile {percentile(of, 0.95):.2f}, most {max(of):.2f} (of {len(of)})")
    if stated:
        print(f"registration error within twice what was stated: {sum(p <= 2 * s for p, s in stated)} of {len(stated)}")
    print(f"{screws} screws: doubtful or refused {len(doubtful)} {doubtful}, of them beyond the limits {bad_and_doubtful}, beyond the limits and "
          f"sure {bad_and_sure}, not found {missed}, wrong side or level {wrong}, found where there is none {false}")


if __name__ == "__main__":
    main()
