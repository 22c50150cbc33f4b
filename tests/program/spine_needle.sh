#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The spine needle as its user does it: rubric, script, recording, score, page, log, exercise, and what is refused.
. "$(dirname "$0")/common.sh"
: "${OFFLINE:?}" "${WRITE_CASE:?}"
library=$work/library
mkdir "$library"
"$WRITE_CASE" "$library/spine" spine
"$WRITE_CASE" "$library/head-drilled" head_drilled
rubric=$work/rubric.json
"$OFFLINE" rubric "$SOURCE/configs/rubrics/spine_needle.yaml" --output "$rubric" >/dev/null
lesson=("$TREPHINE" lesson "$library/spine" --script "$SOURCE/examples/lessons/spine_needle.json")
"${lesson[@]}" --record "$work/one.lesson" --participant r-01 >"$work/text" || { cat "$work/text"; fail "no lesson"; }
score=("$TREPHINE" score "$work/one.lesson" --case "$library/spine" --rubric "$rubric")
"${score[@]}" --json "$work/one.json" --page "$work/one.html" --log "$work/log.csv" >"$work/text" || { cat "$work/text"; fail "no score"; }
grep -Eq '^35 of 35 points, completed; finished, needle passes: 1, exposure [0-9.]+ s in 6 shots, the needle lies in bone$' "$work/text" || {
  cat "$work/text"; fail "the example is not perfect"; }
"${score[@]}" --json "$work/two.json" --page "$work/two.html" >/dev/null
cmp "$work/one.json" "$work/two.json" && cmp "$work/one.html" "$work/two.html" || fail "scored again it is not the same"
! grep -Eqi '<script|javascript:|https?://' "$work/one.html" || fail "the page does more than show"
"$TREPHINE" replay "$library/spine" "$work/one.lesson" | grep -q '^replayed bit for bit$' || fail "replays otherwise"
python3 - "$work/one.json" "$work/log.csv" <<'PY'
import csv, json, sys
j = json.load(open(sys.argv[1]))
assert [r["name"] for r in j["rows"]] == ["entry", "target", "breach", "depth", "exposure", "passes", "time"], j["rows"]
assert all(l["from"] == "ours" and l["why"] for r in j["rows"] for l in r["limits"].values())
assert [s["view"] for s in j["facts"]["shots"]] == ["ap", "lateral", "lateral", "ap", "ap", "lateral"], j["facts"]["shots"]
row = next(csv.DictReader(open(sys.argv[2])))
assert row["module"] == "spine_needle" and row["breach_score"] == "5" and float(row["entry_off_mm"]) < 2, row
PY
# A German page gives the limits' reasons in German, and so does every shipped rubric.
"${score[@]}" --page "$work/german.html" --language de >/dev/null
for r in "$SOURCE"/configs/rubrics/*.yaml; do "$OFFLINE" rubric "$r" --output "$work/$(basename "$r" .yaml).shipped.json" >/dev/null; done
python3 - "$work" <<'PY'
import glob, json, re, sys
def reasons(j, at):
    if isinstance(j, dict):
        if "why" in j: yield at, j["why"], j["why_de"]
        for k, v in j.items(): yield from reasons(v, at + "." + k)
    elif isinstance(j, list):
        for n, v in enumerate(j): yield from reasons(v, f"{at}.{n}")
all_of = [r for f in glob.glob(sys.argv[1] + "/*.shipped.json") for r in reasons(json.load(open(f)), f)]
assert len(all_of) > 100, len(all_of)
assert all(german and german != english for _, english, german in all_of), [r for r in all_of if not r[2] or r[1] == r[2]]
english, german = (re.findall('title="([^"]*)"', open(f"{sys.argv[1]}/{page}.html").read()) for page in ("one", "german"))
assert len(english) == len(german) > 20 and not set(english) & set(german), set(english) & set(german)
PY
# A rubric, a log and a case of another lesson.
"$OFFLINE" rubric "$SOURCE/configs/rubrics/ventriculostomy.yaml" --output "$work/other.json" >/dev/null
expect 65 'lesson: spine_needle, but the rubric is of ventriculostomy' "$TREPHINE" score "$work/one.lesson" --case "$library/spine" --rubric "$work/other.json"
expect 65 'the lesson needs a pedicle' "$TREPHINE" lesson "$library/head-drilled" --script "$SOURCE/examples/lessons/spine_needle.json" --record "$work/x"
sed 's/module: spine_needle/module: spine/' "$SOURCE/configs/rubrics/spine_needle.yaml" >"$work/wrong.yaml"
expect 78 'module: spine, no such lesson; known are .*spine_needle, .*ventriculostomy' "$OFFLINE" rubric "$work/wrong.yaml" --output "$work/x"
[[ ! -e $work/x ]] || fail "something was written"
# A pedicle that the case hardly knows is said to be doubtful, not to serve.
cp -r "$library/spine" "$work/doubted"
python3 - "$work/doubted/case.json" <<'PY'
import hashlib, json, sys
text = open(sys.argv[1]).read()
case = json.loads(text)
for landmark in case["landmarks"]:
    if landmark["name"].startswith("pedicle_2_left"): landmark["confidence"] = 0.34
del case["checksum"]
body = json.dumps(case, indent=1)[:-2]
open(sys.argv[1], "w").write(body + ',\n "checksum": "' + hashlib.sha256(body.encode()).hexdigest() + '"\n}\n')
PY
"$TREPHINE" lessons "$work/doubted" >"$work/text"
grep -Eq '^spine_needle: serves: pedicle_1_left, .*; doubtful: pedicle_2_left \(the pedicle: confidence 0.34, below 0.5\)$' "$work/text" &&
  ! grep -q 'serves: .*pedicle_2_left,.*; doubtful' "$work/text" || { cat "$work/text"; fail "a doubtful pedicle serves"; }
# A curriculum needs no class of a spine, and does not speak of a head.
"$OFFLINE" library approve "$library/spine" --by prof-1 --accept 'ventriculostomy,subclavian=a spine' >/dev/null
"$OFFLINE" library approve "$library/head-drilled" --by prof-1 --accept 'pedicle_finder,pedicle_screw,spine_needle,subclavian=a head' >/dev/null
"$TREPHINE" exercise "$library" --module spine_needle --participant r-01 --out "$work/results" \
  --script "$SOURCE/examples/lessons/spine_needle.json" --rubric "$rubric" >"$work/text"
! grep -q 'head-drilled' "$work/text" || { cat "$work/text"; fail "a head is named, or exercised"; }
grep -qx 'a case beside is of other lessons' "$work/text" || { cat "$work/text"; fail "a head is not told of"; }
grep -Eq '^1 +spine +- +3 +pedicle_2_left +- +35 of 35 points: 5 5 5 5 5 5 5, completed$' "$work/text" || { cat "$work/text"; fail "the exercise is not done"; }
[[ $(wc -l <"$work/results/attempts-spine_needle.csv") == 2 ]] || fail "no attempt is logged"
# The finder alone, as group B did, by its own rubric: the five errors of the screw that would follow.
"$OFFLINE" rubric "$SOURCE/configs/rubrics/pedicle_finder.yaml" --output "$work/finder.json" >/dev/null
"$TREPHINE" lesson "$library/spine" --script "$SOURCE/examples/lessons/pedicle_finder.json" --record "$work/finder.lesson" --participant b-01 >/dev/null
"$TREPHINE" score "$work/finder.lesson" --case "$library/spine" --rubric "$work/finder.json" --page "$work/finder.html" --log "$work/finder.csv" >"$work/text"
grep -q '^45 of 45 points (30 of 30 by the table), completed; finished, passes: 1, errors: 0, acceptable, grade A$' "$work/text" || { cat "$work/text"; fail "no perfect finder"; }
python3 - "$work/finder.csv" <<'PY'
import csv, sys
row = next(csv.DictReader(open(sys.argv[1])))
assert (row["module"], row["errors_count"], row["acceptable"], row["gertzbein_grade"]) == ("pedicle_finder", "0", "1", "0"), row
assert not any(name.startswith("screw") for name in row), list(row)
PY
sed 's/"needle": {"pedicle": "pedicle_2_left", "short_of_mm": 25}/"needle": {"pedicle": "pedicle_2_left", "short_of_mm": 25, "entry_aside_mm": 5, "target_aside_mm": 5}/' \
  "$SOURCE/examples/lessons/pedicle_finder.json" >"$work/aside.json"
"$TREPHINE" lesson "$library/spine" --script "$work/aside.json" --record "$work/aside.lesson" >/dev/null
"$TREPHINE" score "$work/aside.lesson" --case "$library/spine" --rubric "$work/finder.json" >"$work/text"
grep -q 'errors: 0,' "$work/text" && { cat "$work/text"; fail "a finder 5 mm aside has no error"; }
expect 65 'lesson: pedicle_finder, but the rubric is of spine_needle' "$TREPHINE" score "$work/finder.lesson" --case "$library/spine" --rubric "$rubric"
# The open exercise, by its own rubric.
"$OFFLINE" rubric "$SOURCE/configs/rubrics/pedicle_screw.yaml" --output "$work/screw.json" >/dev/null
"$TREPHINE" lesson "$library/spine" --script "$SOURCE/examples/lessons/pedicle_screw.json" --record "$work/screw.lesson" >/dev/null
"$TREPHINE" score "$work/screw.lesson" --case "$library/spine" --rubric "$work/screw.json" --page "$work/screw.html" >"$work/text"
grep -q '^50 of 50 points (30 of 30 by the table), completed; finished, passes: 2, errors: 0, acceptable, grade A$' "$work/text" || { cat "$work/text"; fail "no perfect screw"; }
