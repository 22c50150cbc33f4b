#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well `trephine outcome` measures what was put in: phantoms before and after a procedure.

    bench/outcome.py TREPHINE FOLDER head|spine|needle|chest [WITH [WITHOUT [SEED,SEED ...]]]

Makes a case of each patient (the seeds), and of each in turn WITH (20) scans after the procedure, which differ in what was put in and
where, thickness of the slices, noise, kernel, tilt, how the patient lies and what of him is scanned (head: bend, shifted ventricles, air,
staples; spine: rods, streaks, dark bands, vertebrae that lean; chest: contrast medium, electrodes with streaks), and WITHOUT (10)
scans with nothing put in. Prints a row for each thing (tip, axis, registration at the tip and what was stated of it, in mm and degrees) and a
summary. A folder that exists is not made again.
"""
import json
import math
import pathlib
import random
import resource
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


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


def off(a, b):
    return math.sqrt(sum((x - y) ** 2 for x, y in zip(a, b)))


def placed(m, p):
    return [sum(m[4 * a + k] * p[k] for k in range(3)) + m[4 * a + 3] for a in range(3)]


def rows_of(matrix):
    return [x for row in matrix for x in row]


def unit(v):
    n = math.sqrt(sum(x * x for x in v))
    return [x / n for x in v]


def degrees(a, b):
    return math.degrees(math.acos(min(1, abs(sum(x * y for x, y in zip(unit(a), unit(b)))))))


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


def to_course(p, course):
    """How far a place lies off a polyline."""
    best = 1e9
    for a, b in zip(course, course[1:]):
        d = [y - x for x, y in zip(a, b)]
        t = sum((p[k] - a[k]) * d[k] for k in range(3)) / max(1e-9, sum(x * x for x in d))
        best = min(best, off(p, [a[k] + min(1, max(0, t)) * d[k] for k in range(3)]))
    return best


def slices(r, steps, heights, kernels, tilts, noises):
    step, height = r.choice(steps), r.choice(heights)
    return step, height, ["--slice-step-mm", step, "--slice-thickness-mm", step, "--slices-count", int(height / step), "--noise-hu",
                          r.choice(noises), "--kernel-mm", r.choice(kernels), "--tilt-deg", r.choice(tilts)]


def pose(r, turn_deg, shift_mm):
    turn, shift = [[round(r.uniform(-a, a), 1) for _ in range(3)] for a in (turn_deg, shift_mm)]
    return shift, ["--head-turn-deg", ",".join(map(str, turn)), "--head-shift-mm", ",".join(map(str, shift))]


def take_nearest(left, tip_mm):
    """What was found with its tip nearest to that place, taken out of the list; None where nothing is left."""
    if not left:
        return None
    found = min(left, key=lambda s: off(s["tip_mm"], tip_mm))
    left.remove(found)
    return found


class Head:
    scanner = ["--level", "hard", "--columns-count", "256", "--rows-count", "256", "--field-of-view-mm", "230", "--mesh-step-mm", "0",
               "--subvoxel-mm", "0.7", "--no-labels", "--quiet"]
    before = ["--slices-count", 110, "--slice-step-mm", 1.6, "--slice-thickness-mm", 1.6, "--noise-hu", 6, "--centre-mm", "0,-10,54"]
    seed_option, config, extras = "--seed", "ct_head.yaml", ("hole mm", "width off mm")

    def options(self, n, put_in):
        r = random.Random(1000 * (not put_in) + n)
        step, height, words = slices(r, [1, 1.5, 2, 2.5, 3], [125, 150, 170], [1, 1.4, 1.8], [0, 0, 8, -12, 16], [5, 10, 20])
        shift, lies = pose(r, 14, 25)
        words += lies + ["--centre-mm", f"{shift[0]},{shift[1] - 8},{round(shift[2] + 128 - height / 2)}",
                         "--variant", r.choice(["normal", "normal", "shifted"])]
        implants = "catheter" if put_in else r.choice(["none", "none", "burr_hole"])
        if implants != "none":
            words += ["--implants", implants, "--implant-side", r.choice(["right", "left"]),
                      "--implant-lateral-mm", round(r.uniform(-8, 12), 1), "--implant-anterior-mm", round(r.uniform(-8, 12), 1),
                      "--implant-hole-mm", r.choice([9, 11, 14]), "--implant-air-ml", r.choice([0, 0, 4, 12]),
                      "--implant-staples-count", r.choice([0, 0, 6])]
        if put_in:
            words += ["--implant-aim-mm", ",".join(str(round(r.uniform(-9, 9), 1)) for _ in range(3)),
                      "--implant-bend-mm", r.choice([0, 0, 1, 3]), "--implant-catheter-hu", r.choice([700, 1500, 2200])]
        elif r.random() < 0.4:
            words += ["--plexus"]
        return step, words

    def compare(self, case, truth, r):
        """What was put in beside what was found: rows, and what was found where there is none."""
        rows, put_in = [], truth.get("put_in", [])
        left = list(r["courses"]) if r["catheter"] != "none" else []
        for t in (t for t in put_in if "tip_mm" in t):
            row = {"name": t["side"]}
            if left:
                c = left[0]
                left = []  # another one beside it is a doubt of this one
                row |= {"tip": off(c["tip_mm"], t["tip_mm"]), "axis": degrees(c["axis"], line_through(t["course_mm"])),
                        "place": off(placed(rows_of(truth["head_to_scan"]), t["tip_mm"]), placed(r["registration"]["transform"], t["tip_mm"])),
                        "stated": c["error_mm"], "sure": r["catheter"] == "found", "doubts": r["catheter_doubts"], "wrong": c["side"] != t["side"]}
            rows.append(row)
        holes = [h for h in r["holes"] if h["confidence"] >= 0.5]
        for row, t in zip(rows, put_in):
            if holes:
                h = min(holes, key=lambda h: off(h["outer_mm"], t["hole_mm"]))
                row["hole mm"], row["width off mm"] = off(h["outer_mm"], t["hole_mm"]), abs(h["diameter_mm"] - t["hole_diameter_mm"])
        return rows, [f"catheter {c['side']}" for c in left] + ["hole"] * max(0, len(holes) - len(put_in))


class Spine:
    scanner = ["--body", "spine", "--columns-count", "256", "--rows-count", "256", "--field-of-view-mm", "230", "--no-labels", "--quiet"]
    before = ["--slices-count", 160, "--noise-hu", 10]
    seed_option, config, kind, extras = "--vertebrae-seed", "ct_spine.yaml", "screw", ("entry mm", "length off mm", "diameter off mm")

    def options(self, n, put_in):
        r = random.Random(1000 * (not put_in) + n)
        step, height, words = slices(r, [1, 1, 1.5, 2, 3], [90, 110, 140], [1, 1.4, 1.8], [0, 0, 0, 8, -10], [8, 15, 25])
        shift, lies = pose(r, 8, 15)
        words += lies + ["--streak-hu", r.choice([100, 200, 350]), "--vertebra-bend-deg", round(r.uniform(-3, 3), 1), "--seed", n + 1,
                         "--centre-mm", f"{shift[0]},{shift[1] - 10},{shift[2] + 42 + r.choice([0, 12])}"]
        if not put_in:
            return step, words
        needle = self.kind == "needle"
        levels = 1 if needle else r.choice([1, 1, 2])
        words += ["--screws", r.choice(["left", "right"] if needle else ["left", "right", "both"]), "--screw-levels-count", levels,
                  "--screw-diameter-mm", 3 if needle else r.choice([5.5, 6.5, 7.5]), "--screw-length-mm", r.choice([35, 40, 45, 50]),
                  "--screw-seat-mm", r.choice([0, 1, 3]), "--screw-aside-mm", round(r.uniform(-4, 4), 1),
                  "--screw-up-mm", round(r.uniform(-4, 4), 1), "--screw-axial-deg", round(r.uniform(-9, 9), 1),
                  "--screw-sagittal-deg", round(r.uniform(-9, 9), 1), "--screw-hu", r.choice([7000, 8000, 9500])]
        if needle:
            words += ["--screw-kind", "needle"]
        elif levels > 1 and r.random() < 0.5:
            words += ["--screw-rods"]
        return step, words

    @staticmethod
    def pedicle_of(case, screw):
        """The name that the case has for the pedicle of a screw: the one whose middle its true axis passes nearest."""
        at = {m["name"]: m["position_mm"] for m in case["landmarks"]}

        def passes(name):
            d = [0.6 * e + 0.4 * t - h for e, t, h in zip(at[name + "_entry"], at[name + "_target"], screw["head_mm"])]
            along = sum(a * b for a, b in zip(d, screw["axis"]))
            return off(d, [along * a for a in screw["axis"]])
        return min({name[:-6] for name in at if name.endswith("_entry")}, key=passes)

    def compare(self, case, truth, r):
        rows, left = [], list(r.get("screws", []))
        for t in truth.get("put_in", []):
            row = {"name": t["screw"]}
            rows.append(row)
            if not (s := take_nearest(left, t["tip_mm"])):
                continue
            number = int("".join(c for c in s["pedicle"] if c.isdigit()))
            true = self.pedicle_of(case, t)
            maps = [v["transform"] for v in r["vertebrae"] if v["number"] == number]
            row |= {"tip": off(s["tip_mm"], t["tip_mm"]), "axis": degrees(s["axis"], t["axis"]), "sure": s["sighting"] == "found",
                    "doubts": s["doubts"], "stated": s["error_mm"], "wrong": s["pedicle"] != true or s["kind"] != t["kind"],
                    "place": off(placed(rows_of(t["to_scan"]), t["tip_mm"]), placed(maps[0], t["tip_mm"])),
                    "entry mm": off(s["entry_mm"], t["entry_mm"]), "diameter off mm": abs(s["diameter_mm"] - t["diameter_mm"])}
            if self.kind == "screw":
                row["length off mm"] = abs(s["length_mm"] - t["length_mm"])
        return rows, [f"{s['pedicle']} {s['sighting']}" for s in left]


class Needle(Spine):
    kind, extras = "needle", ("entry mm", "diameter off mm")


class Chest:
    scanner = ["--body", "chest", "--columns-count", "256", "--rows-count", "256", "--field-of-view-mm", "330", "--quiet"]
    before = ["--slices-count", 112, "--noise-hu", 10]
    seed_option, config, extras = "--chest-seed", "ct_chest.yaml", ("skin mm", "vein mm", "course mm", "in lung off mm")

    def options(self, n, put_in):
        r = random.Random(1000 * (not put_in) + n)
        step, height, words = slices(r, [1, 1.5, 2, 3], [90, 105, 120], [1, 1.4, 1.8], [0, 0, 0, 8, -10], [8, 15, 25])
        shift, lies = pose(r, 8, 15)
        words += lies + ["--no-labels", "--seed", n + 1, "--vein-contrast-hu", r.choice([0, 0, 100]), "--electrodes-count", r.choice([0, 2, 4]),
                         "--streak-hu", r.choice([100, 200, 350]), "--centre-mm", f"{shift[0]},{shift[1] - 15},{shift[2] + 62 - round(height / 8)}"]
        if put_in:
            words += ["--line", r.choice(["right", "right", "left"]), "--line-ends", r.choice(["vein"] * 5 + ["lung"]),
                      "--line-enters-mm", round(r.uniform(28, 48), 1), "--line-steep-deg", round(r.uniform(38, 60), 1),
                      "--line-down-deg", round(r.uniform(0, 25), 1), "--line-tip-mm", round(r.uniform(0, 30), 1),
                      "--line-aside-mm", round(r.uniform(0, 2.5), 1), "--line-wide-mm", r.choice([1.7, 2.3, 2.8]),
                      "--line-hu", r.choice([900, 1500, 2500])]
        return step, words

    def compare(self, case, truth, r):
        rows, left = [], list(r.get("lines", []))
        for t in truth.get("put_in", []):
            row = {"name": t["side"]}
            rows.append(row)
            if not (s := take_nearest(left, t["tip_mm"])):
                continue
            course = [p["at_mm"] for p in s["course"]]
            row |= {"tip": off(s["tip_mm"], t["tip_mm"]), "sure": s["sighting"] == "found", "doubts": s["doubts"], "stated": s["error_mm"],
                    "axis": degrees([b - a for a, b in zip(s["skin_mm"], s["vein_mm"])], [b - a for a, b in zip(t["skin_mm"], t["vein_mm"])]),
                    "wrong": s["side"] != t["side"], "skin mm": off(s["skin_mm"], t["skin_mm"]), "vein mm": off(s["vein_mm"], t["vein_mm"]),
                    "place": off(placed(rows_of(truth["chest_to_scan"]), t["tip_mm"]), placed(r["registration"]["transform"], t["tip_mm"])),
                    "course mm": max(to_course(p, t["course_mm"]) for p in course), "in lung off mm": abs(s["in_lung_mm"] - t["in_lung_mm"])}
        return rows, [f"{s['side']} {s['sighting']}" for s in left]


BODIES = {"head": Head, "spine": Spine, "needle": Needle, "chest": Chest}


def case_of(program, folder, body, seed):
    at = folder / f"before{seed}"
    if not (at / "dicom").exists():
        must(program, "phantom", at, body.seed_option, seed, *body.scanner, *body.before)
    case = folder / "library" / f"case{seed}"
    if not (case / "case.json").exists():
        must(program, "run", ROOT / "configs" / body.config, "--series", at / "dicom", "--out", folder / "library", "--case", case.name,
             "--no-page", "--quiet")
    return case


class Sums:
    def __init__(self, extras):
        self.values = {what: [] for what in ("tip mm", "axis deg", "registration mm") + extras}
        self.stated, self.all, self.scans, self.bare = [], 0, 0, 0
        self.names = {what: [] for what in ("doubtful", "refused", "beyond the limits and doubtful", "beyond the limits and sure", "not found",
                                            "wrong side or level", "found where there is none")}

    def add(self, name, row):
        self.all += 1
        if "tip" not in row:
            self.names["not found"].append(name)
            return
        bad = row["tip"] > 1 or row["axis"] > 1.5
        if not row["sure"]:
            self.names["doubtful"].append(name)
            if bad:
                self.names["beyond the limits and doubtful"].append(name)
            return
        for what, key in (("tip mm", "tip"), ("axis deg", "axis"), ("registration mm", "place")):
            self.values[what].append(row[key])
        for what in list(self.values)[3:]:
            if what in row:
                self.values[what].append(row[what])
        self.stated.append((row["place"], row["stated"]))
        if bad:
            self.names["beyond the limits and sure"].append(name)
        if row["wrong"]:
            self.names["wrong side or level"].append(name)

    def print(self):
        print()
        for what, of in self.values.items():
            if of:
                print(f"{what}: median {percentile(of, 0.5):.2f}, 95th percentile {percentile(of, 0.95):.2f}, most {max(of):.2f} (of {len(of)})")
        if self.stated:
            print(f"registration error within twice what was stated: {sum(p <= 2 * s for p, s in self.stated)} of {len(self.stated)}")
        print(f"{self.all} things in {self.scans} scans, and {self.bare} scans without: " +
              "; ".join(f"{what} {len(of)} {of if of else ''}".strip() for what, of in self.names.items()))


def main():
    program, folder, body = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]), BODIES[sys.argv[3]]()
    counts = [int(sys.argv[k]) if len(sys.argv) > k else usual for k, usual in ((4, 20), (5, 10))]
    seeds = [int(s) for s in (sys.argv[6] if len(sys.argv) > 6 else "3,21,34").split(",")]
    folder.mkdir(parents=True, exist_ok=True)
    sums = Sums(body.extras)
    print("| scan | slices mm | tip mm | axis deg | registration mm | stated mm | " + " | ".join(body.extras) + " | found | CPU s |")
    print("|---" * (8 + len(body.extras)) + "|")
    for put_in, n in [(True, n) for n in range(counts[0])] + [(False, n) for n in range(counts[1])]:
        seed = seeds[n % len(seeds)]
        case = case_of(program, folder, body, seed)
        step, words = body.options(n, put_in)
        name = f"{'with' if put_in else 'without'}{n:02}-{seed}"
        after = folder / name
        if not (after / "dicom").exists():
            must(program, "phantom", after, body.seed_option, seed, *body.scanner, *words)
        begin = used()
        code, _, why = trephine(program, "outcome", case, "--series", after / "dicom", "--out", after / "outcome")
        cpu = used() - begin
        truth = json.loads((after / "truth/truth.json").read_text())
        sums.scans += put_in
        sums.bare += not put_in
        if code:
            sums.names["refused"].append(name)
            sums.all += len(truth.get("put_in", []))
            print(f"| {name} | {step} | | | | | {'| ' * len(body.extras)}refused {code}: {why.strip()[-120:]} | {cpu:.0f} |", flush=True)
            continue
        r = json.loads((after / "outcome/outcome.json").read_text())
        rows, false = body.compare(json.loads((case / "case.json").read_text()), truth, r)
        sums.names["found where there is none"] += [f"{name} {what}" for what in false]
        lies = r["registration"]["doubts"]
        for row in rows or [{"name": "nothing"}]:
            cells = [f"{row[k]:.2f}" if k in row else "" for k in ("tip", "axis", "place", "stated", *body.extras)]
            said = "none" if "tip" not in row else "found" if row["sure"] else f"doubtful ({row['doubts']})"
            print(f"| {name} {row['name']} | {step} | {' | '.join(cells)} | {said}{'; registration: ' + lies if lies else ''} | {cpu:.0f} |", flush=True)
        for row in rows:
            sums.add(f"{name} {row['name']}", row)
    sums.print()


if __name__ == "__main__":
    main()
