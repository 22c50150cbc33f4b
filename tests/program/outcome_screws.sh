#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Pedicle screws and a needle from the CT before them to a score of the CT after them, and what must not be judged.
. "$(dirname "$0")/common.sh"
: "${SIM:?}"
cd "$work"

scan=(--body spine --columns-count 230 --rows-count 230 --field-of-view-mm 230 --no-labels --quiet)
"$TREPHINE" phantom before --vertebrae-seed 3 "${scan[@]}" --slices-count 120
"$TREPHINE" run "$SOURCE/configs/ct_spine.yaml" --series before/dicom --out library --case spine --no-page --quiet \
  --set "haptic.spacing_mm=[0.9,0.9,0.9]" 2>warnings || fail "the case: $(cat warnings)"
"$TREPHINE" rubric "$SOURCE/configs/rubrics/pedicle_screw.yaml" --output rubric.json --quiet
after() { # FOLDER SEED MORE...: a scan of another day, with less of the spine
  local folder=$1 seed=$2
  shift 2
  "$TREPHINE" phantom "$folder" --vertebrae-seed "$seed" "${scan[@]}" --slices-count 60 --slice-step-mm 1.5 --slice-thickness-mm 1.5 \
    --head-turn-deg 4,-3,6 --head-shift-mm 6,-5,9 --centre-mm 6,-15,51 --vertebra-bend-deg 2 --seed 5 "$@"
}
score() { # FOLDER MORE...: judged, the table in table
  local folder=$1
  shift
  "$SIM" score-outcome "$folder/outcome.json" --case library/spine --rubric rubric.json --participant r-01 --json "$folder/score.json" "$@" >table
}

# One screw inside of its pedicle and one on the other side that breaks the medial wall: each is judged by itself.
after one 3 --screws left
"$TREPHINE" outcome library/spine --series one/dicom --out one_out >said
grep -Eq 'pedicle_[0-9]_left +found' said || fail "no screw: $(cat said)"
[[ $(head -c 4 one_out/outcome.png | tail -c 3) == PNG ]] || fail "no picture"
if grep -rlE 'PHANTOM|TREPHINE\^|1\.2\.826|/(tmp|work|home)/' one_out; then fail "something of the patient or the place is in it"; fi
score one_out --page one_out/page.html
grep -q 'MEASURED on a CT' table || fail "not said what it is: $(cat table)"
after broken 3 --screws both --screw-aside-mm -5
"$TREPHINE" outcome library/spine --series broken/dicom --out broken_out >said
refuses 64 'several screws; name the pedicle of one: pedicle_[0-9]_left, pedicle_[0-9]_right' "$SIM" score-outcome broken_out/outcome.json \
  --case library/spine --rubric rubric.json --participant r-01
level=$(python3 -c 'import json; print(json.load(open("broken_out/outcome.json"))["screws"][0]["pedicle"].split("_")[1])')
score broken_out --task "pedicle_${level}_right"
python3 - <<'PY'
import json
load = lambda f: json.load(open(f))
off = lambda a, b: sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5
for folder, found in (("one", "one_out"), ("broken", "broken_out")):
    truth, got = load(f"{folder}/truth/truth.json")["put_in"], load(f"{found}/outcome.json")["screws"]
    assert len(truth) == len(got), got
    for t in truth:
        s = min(got, key=lambda s: off(s["tip_mm"], t["tip_mm"]))
        assert off(s["tip_mm"], t["tip_mm"]) < 1 and off(s["entry_mm"], t["entry_mm"]) < 1 and off(s["axis"], t["axis"]) < 0.026, (t, s)
        assert s["pedicle"].endswith(t["screw"]), (t["screw"], s["pedicle"])
one, broken = load("one_out/score.json"), load("broken_out/score.json")
rows = {r["name"]: r for r in one["rows"]}
assert one["checked"] == "measured" and one["facts"]["procedure_s"] is None, one["checked"]
for name in ("exposure", "passes", "time"):
    assert rows[name]["score"] == "not judged", rows[name]
for name in ("entry", "axial", "sagittal", "length", "breach", "acceptable", "size"):
    assert isinstance(rows[name]["score"], int), rows[name]
assert rows["breach"]["score"] == 5 and one["figures"]["gertzbein_grade"] == 0, one["figures"]
assert rows["axial"]["measured"]["axial_off_deg"] < 2 and rows["entry"]["measured"]["coronal_entry_off_mm"] < 2, rows
assert one["figures"]["passes_count"] is None and abs(one["figures"]["screw_diameter_mm"] - 6.5) < 0.6, one["figures"]
f = broken["figures"]
true = [t["breach_mm"] for t in load("broken/truth/truth.json")["put_in"]][1]
assert f["gertzbein_grade"] >= 1 and f["medial_wall_mm"] > f["lateral_wall_mm"], f
assert abs(f["medial_wall_mm"] - true) < 1, (f["medial_wall_mm"], true)
assert next(r for r in broken["rows"] if r["name"] == "breach")["score"] == 1
PY
# Another level than the one that was asked for is the wrong one.
score one_out --task pedicle_1_left
[[ $level == 1 ]] || grep -q 'wrong level\|another level\|was asked for' table || fail "a wrong level is none: $(cat table)"

long_only

# A needle on the axis of a pedicle, and the same in the simulator: judged alike.
"$TREPHINE" rubric "$SOURCE/configs/rubrics/spine_needle.yaml" --output needle_rubric.json --quiet
after needled 3 --screws left --screw-kind needle --screw-diameter-mm 3 --screw-length-mm 42
"$TREPHINE" outcome library/spine --series needled/dicom --out needled_out >said
"$SIM" score-outcome needled_out/outcome.json --case library/spine --rubric needle_rubric.json --participant r-01 \
  --task "pedicle_${level}_left" --json needled_out/score.json >table
python3 - "pedicle_${level}_left" <<'PY'
import json, math, sys
load = lambda f: json.load(open(f))
pedicle = sys.argv[1]
at = {m["name"]: m["position_mm"] for m in load("library/spine/case.json")["landmarks"]}
entry, target = at[pedicle + "_entry"], at[pedicle + "_target"]
truth, found = load("needled/truth/truth.json")["put_in"][0], load("needled_out/outcome.json")["screws"]
assert len(found) == 1 and found[0]["kind"] == "needle" and found[0]["pedicle"] == pedicle, found
assert math.dist(found[0]["tip_mm"], truth["tip_mm"]) < 1, (found, truth)
# The same needle: how far its ends lie off the case's own axis, and how far its tip stops before the target.
way = [(a - b) / math.dist(target, entry) for a, b in zip(target, entry)]
along = lambda p: sum((a - b) * w for a, b, w in zip(p, entry, way))
needle = {"pedicle": pedicle, "short_of_mm": round(along(target) - along(truth["tip_mm"]), 2)}
for name, p in (("entry", truth["entry_mm"]), ("target", truth["tip_mm"])):
    off = [a - b - w * along(p) for a, b, w in zip(p, entry, way)]
    needle[name + "_aside_mm"], needle[name + "_up_mm"] = round(off[0], 2), round(off[2], 2)
json.dump({"module": "spine_needle", "task": pedicle, "steps": [
    {"shoot": {"seconds": 0.5}}, {"needle": needle}, {"shoot": {"seconds": 0.5}}, "finish"]}, open("script.json", "w"))
PY
"$SIM" lesson library/spine --script script.json --record needle.lesson --participant r-01 >/dev/null
"$SIM" score needle.lesson --case library/spine --rubric needle_rubric.json --json simulated.json >/dev/null
python3 - <<'PY'
import json, math
simulated, real = (json.load(open(f)) for f in ("simulated.json", "needled_out/score.json"))
truth = json.load(open("needled/truth/truth.json"))["put_in"][0]
one, other = ({r["name"]: r for r in s["rows"]} for s in (simulated, real))
tip = simulated["facts"]["passes"][-1]["tip_mm"]
assert math.dist(tip, truth["tip_mm"]) < 3, (tip, truth)
for name in ("entry", "target", "breach", "depth"):
    a, b = one[name]["score"], other[name]["score"]
    assert isinstance(b, int) and abs(a - b) <= 1, (name, one[name], other[name])
for name in ("exposure", "passes", "time"):
    assert other[name]["score"] == "not judged", other[name]
assert real["checked"] == "measured" and real["figures"]["in_bone"] is True and real["figures"]["passes_count"] is None, real["figures"]
PY
# A rubric of a screw finds none: it is a needle.
score needled_out
grep -q 'the CT shows no screw there' table || fail "a needle is a screw: $(cat table)"

# No screws: nothing is judged.
after bare 3
"$TREPHINE" outcome library/spine --series bare/dicom --out bare_out >said
grep -q '^screws *none was found' said || fail "found something: $(cat said)"
score bare_out
grep -q 'the CT shows no screw there' table || fail "judged: $(cat table)"
! grep -Eq '^(Coronal|Axial|Sagittal|Length|Pedicle).* [1-5]  ' table || fail "judged: $(cat table)"

# Another patient's spine is refused or doubtful, and then no row of the screw is judged.
after other 11 --screws left
got=0
"$TREPHINE" outcome library/spine --series other/dicom --out other_out >said 2>why || got=$?
if [[ $got != 80 ]]; then
  [[ $got == 0 ]] && grep -q '^registration *doubtful' said || fail "taken for the patient's ($got): $(cat said why)"
  score other_out
  ! grep -Eq '^(Coronal|Axial|Sagittal|Length|Pedicle).* [1-5]  ' table || fail "judged: $(cat table)"
fi
