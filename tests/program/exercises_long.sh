#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The shipped library of exercises, from nothing to results, by the commands of docs/how-to/teach-a-group.md: heads of four classes, spines, and
# chests.
. "$(dirname "$0")/common.sh"
: "${SIM:?}"
PATH=$(dirname "$TREPHINE"):$(dirname "$SIM"):$PATH
cp -r "$SOURCE/configs" "$SOURCE/pipelines" "$SOURCE/examples" "$SOURCE/trephine.root" "$work"
cd "$work"
sed -n '/^## A library to begin with/,/^## A curriculum/p' "$SOURCE/docs/how-to/teach-a-group.md" | sed -n 's/^    //p' >commands.sh
[[ $(grep -c trephine commands.sh) -ge 6 ]] || fail "the page shows no commands"
bash -euo pipefail commands.sh >text || { cat text; fail "the page's commands fail"; }
# In turn by class, each done, and none left out but the spines, which are no heads.
python3 - results <<'PY'
import csv, sys
rows = list(csv.DictReader(open(sys.argv[1] + "/attempts-ventriculostomy.csv")))
assert sorted(r["case"] for r in rows) == ["hydrocephalic-1", "normal-1", "shifted-1", "small-1"], rows
for r in rows:
    print(r["case"], r["points"], "of", r["most_points"], {k: v for k, v in r.items() if k.endswith("_score")})
    assert int(r["points"]) >= 0.8 * int(r["most_points"]) > 0, r
rows = list(csv.DictReader(open(sys.argv[1] + "/attempts-spine_needle.csv")))
assert sorted(r["case"] for r in rows) == ["spine-1", "spine-2"], rows
for r in rows:
    print(r["case"], r["points"], "of", r["most_points"])
    assert int(r["points"]) >= 30 and r["most_points"] == "35", r
PY
# Where clavicles, veins and lungs lie is what the phantom has, and the needle of the page's script draws blood at its first pass.
python3 - results exercises <<'PY'
import csv, json, sys
rows = list(csv.DictReader(open(sys.argv[1] + "/attempts-subclavian.csv")))
assert sorted(r["case"] for r in rows) == ["chest-1", "chest-2"], rows
for r in rows:
    print(r["case"], r["points"], "of", r["most_points"], {k: v for k, v in r.items() if k.endswith("_score")})
    assert r["vein_score"] == "5" and r["lung_score"] == "5" and r["artery_score"] == "" and r["passes_count"] == "1", r
for name in ("chest-1", "chest-2"):
    case = json.load(open(f"{sys.argv[2]}/{name}/case.json"))
    assert not any("estimated" in json.dumps(a) for a in case["anatomies"] if a["name"] == "vein"), "the vein was not seen"
PY
# The axes that were found are those that the phantom has.
python3 - exercises <<'PY'
import json, math, sys
for name in ("spine-1", "spine-2"):
    at = {l["name"]: l["position_mm"] for l in json.load(open(f"{sys.argv[1]}/{name}/case.json"))["landmarks"]}
    truth = json.load(open(f"{sys.argv[1]}/.phantoms/{name}/truth/truth.json"))["pedicles"]
    assert len(truth) >= 4, truth
    for p in truth:
        e, t = at[p["name"] + "_entry"], at[p["name"] + "_target"]
        unit = lambda a, b: [(y - x) / math.dist(a, b) for x, y in zip(a, b)]
        found, true = unit(e, t), unit(p["entry_mm"], p["target_mm"])
        d = [m - x for m, x in zip(p["middle_mm"], e)]
        along = sum(x * y for x, y in zip(d, found))
        off = math.dist(d, [along * x for x in found])
        turned = math.degrees(math.acos(min(1, sum(x * y for x, y in zip(found, true)))))
        print(name, p["name"], f"{off:.2f} mm, {turned:.2f} degrees")
        assert off < 1.5 and turned < 4, (name, p["name"], off, turned)
PY
