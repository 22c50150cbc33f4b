#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A central line: the same needle's way in the simulator and on a CT of a phantom is judged alike; and what must not be judged.
. "$(dirname "$0")/common.sh"
: "${SIM:?}"
cd "$work"

scan=(--body chest --columns-count 256 --rows-count 256 --field-of-view-mm 330 --quiet)
"$TREPHINE" phantom before --chest-seed 3 "${scan[@]}" --slices-count 112
"$TREPHINE" run "$SOURCE/configs/ct_chest_artery.yaml" --series before/dicom --out library --case chest --no-page --quiet \
  --set artery.labels.file=before/truth/labels.nrrd --set artery.labels.label=5 2>warnings || fail "the case: $(cat warnings)"
"$TREPHINE" rubric "$SOURCE/configs/rubrics/subclavian.yaml" --output rubric.json --quiet
after() { # FOLDER SEED MORE...: a scan of another day, with less of the chest
  local folder=$1 seed=$2
  shift 2
  "$TREPHINE" phantom "$folder" --chest-seed "$seed" "${scan[@]}" --no-labels --slices-count 50 --slice-step-mm 2 --slice-thickness-mm 2 \
    --head-turn-deg 4,-3,6 --head-shift-mm 6,-5,9 --centre-mm 6,-15,51 --vein-contrast-hu 0 --seed 5 "$@"
}
score() { # FOLDER MORE...: judged, the table in table
  local folder=$1
  shift
  "$SIM" score-outcome "$folder/outcome.json" --case library/chest --rubric rubric.json --participant r-01 --json "$folder/score.json" "$@" >table
}

after lined 3 --line right --electrodes-count 2
"$TREPHINE" outcome library/chest --series lined/dicom --out one >said
grep -Eq '^ +right +found: tip' said || fail "no line: $(cat said)"
[[ $(head -c 4 one/outcome.png | tail -c 3) == PNG ]] || fail "no picture"
if grep -rlE 'PHANTOM|TREPHINE\^|1\.2\.826|/(tmp|work|home)/' one; then fail "something of the patient or the place is in it"; fi
score one --task right --page one/page.html
grep -q 'MEASURED on a CT' table || fail "not said what it is: $(cat table)"

# The same needle in the simulator.
python3 - <<'PY'
import json
truth = json.load(open("lined/truth/truth.json"))
line, notch = truth["put_in"][0], truth["notch_mm"]
way = [b - a for a, b in zip(line["skin_mm"], line["vein_mm"])]
deep = 1 + 9 / sum(x * x for x in way) ** 0.5  # 9 mm on: the vein is 10 mm wide, and its wall holds the needle back
at = lambda p: {"at": "notch", "offset_mm": [round(a - b, 3) for a, b in zip(p, notch)]}
tip = [a + deep * x for a, x in zip(line["skin_mm"], way)]
json.dump({"module": "subclavian", "task": "right", "steps": [{"puncture": {"from": at(line["skin_mm"]), "toward": at(tip)}},
                                                              "aspirate", "finish"]}, open("script.json", "w"))
PY
"$SIM" lesson library/chest --script script.json --record same.lesson --participant r-01 >/dev/null
"$SIM" score same.lesson --case library/chest --rubric rubric.json --json simulated.json >/dev/null
python3 - <<'PY'
import json
load = lambda f: json.load(open(f))
off = lambda a, b: sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5
truth, found = load("lined/truth/truth.json")["put_in"][0], load("one/outcome.json")["lines"]
assert len(found) == 1, found
for name, most in (("tip_mm", 1), ("skin_mm", 1.5), ("vein_mm", 2)):
    assert off(truth[name], found[0][name]) < most, (name, truth[name], found[0][name])
simulated, real = load("simulated.json"), load("one/score.json")
course = simulated["facts"]["passes"][0]
assert off(course["entry_mm"], truth["skin_mm"]) < 4 and off(course["tip_mm"], truth["vein_mm"]) < 10, course
one, other = ({r["name"]: r["score"] for r in s["rows"]} for s in (simulated, real))
for name in ("puncture", "direction", "vein", "artery", "lung"):
    assert isinstance(other[name], int) and abs(one[name] - other[name]) <= 1, (name, one, other)
for name in ("passes", "time"):
    assert other[name] == "not judged", (name, other)
assert real["checked"] == "measured" and real["facts"]["procedure_s"] is None and real["facts"]["vein_s"] is None, real["facts"]
assert real["facts"]["entered"] == ["vein"] and real["figures"]["success"] is None, real
PY

# Asked for on the left, it lies on the wrong side.
score one --task left
grep -q 'CRITICAL: .*wrong side' table || fail "no wrong side: $(cat table)"

expect 64 'line_tip_mm.*without a line' "$TREPHINE" phantom none "${scan[@]}" --line-tip-mm 3

long_only

# Through the vein into the lung.
after lung 3 --line left --line-ends lung
"$TREPHINE" outcome library/chest --series lung/dicom --out lung_out >said
score lung_out
grep -q 'CRITICAL: the \(lung\|pleura\) was entered' table || fail "the lung is not seen: $(cat said table)"

# One on each side: the side must be named. None, and another patient's: nothing is judged.
after both 3 --line both
"$TREPHINE" outcome library/chest --series both/dicom --out both_out --quiet
refuses 64 'a line on each side' "$SIM" score-outcome both_out/outcome.json --case library/chest --rubric rubric.json --participant r-01
score both_out --task left
grep -q 'the line lies in the vein' table || fail "not judged: $(cat table)"
after bare 3
"$TREPHINE" outcome library/chest --series bare/dicom --out bare_out >said
grep -q '^lines *none was found' said || fail "found something: $(cat said)"
score bare_out
grep -q 'the CT shows no line there' table || fail "judged: $(cat table)"
! grep -Eq '^(Puncture|Direction|Blood|Artery|Pleura).* [1-5]  ' table || fail "judged: $(cat table)"
after other 11 --line right
got=0
"$TREPHINE" outcome library/chest --series other/dicom --out other_out >said 2>why || got=$?
if [[ $got != 80 ]]; then
  [[ $got == 0 ]] && grep -q '^registration *doubtful' said || fail "taken for the patient's ($got): $(cat said why)"
  score other_out
  ! grep -Eq '^(Puncture|Direction|Blood|Artery|Pleura).* [1-5]  ' table || fail "judged: $(cat table)"
fi
