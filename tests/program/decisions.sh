#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What a lesson asks: the time-out before the cut, what to do after a critical error, and the end, answered rightly, wrongly, late and
# not at all. What is signed names the rubric.
. "$(dirname "$0")/common.sh"
: "${OFFLINE:?}" "${WRITE_CASE:?}"
"$WRITE_CASE" "$work/chest" chest
for rubric in subclavian spine_needle; do "$OFFLINE" rubric "$SOURCE/configs/rubrics/$rubric.yaml" --output "$work/$rubric.json" >/dev/null; done

# done_as NAME STEPS: the lesson with these steps, and its report. `B` are the right answers of the time-out.
cat >"$work/script.py" <<'PY'
import json, sys
B = [{"answer": {"question": q}} for q in ("patient", "side", "indication", "checked")]
good = {"puncture": {"from": {"at": "vein_right", "offset_mm": [-30, 0, -6], "on_skin": True},
                     "toward": {"at": "vein_right"}, "short_of_mm": -6}}
pleura = {"puncture": {"from": {"at": "vein_right", "offset_mm": [-30, 0, -6], "on_skin": True},
                       "toward": {"at": "vein_right", "offset_mm": [-14, 29, -22]}, "short_of_mm": -6}}
def says(question, choice=""):
    return {"answer": {"question": question, "choice": choice}}
json.dump({"module": "subclavian", "steps": eval(sys.argv[2])}, open(sys.argv[1], "w"))
PY
record() { # NAME STEPS ARGUMENTS...
  python3 "$work/script.py" "$work/$1.script.json" "$2"
  "$TREPHINE" lesson "$work/chest" --script "$work/$1.script.json" --record "$work/$1.lesson" --participant r-01 "${@:3}" >"$work/text" ||
    { cat "$work/text"; fail "no lesson $1"; }
}
done_as() {
  record "$1" "$2" --rubric "$work/subclavian.json"
  "$TREPHINE" score "$work/$1.lesson" --case "$work/chest" --rubric "$work/subclavian.json" --json "$work/$1.json" --page "$work/$1.html" \
    --language de --log "$work/log.csv" >"$work/$1.text" || { cat "$work/$1.text"; fail "no score of $1"; }
}
end='[says("proof"), "finish"]'
done_as right "B + [good, 'aspirate'] + $end"
done_as wrong "[says('patient'), says('side', 'left'), says('indication'), says('checked'), good, 'aspirate'] + $end"
done_as misjudged "[says('patient'), says('side'), says('indication', 'routine'), says('checked'), good, 'aspirate'] + $end"
done_as other_patient "[says('patient', '$(python3 - "$work/right.lesson" <<'PY'
import json, sys
b = open(sys.argv[1], "rb").read()
print(next(c for c in json.loads(b[16:8208])["lesson"]["asked"][0]["choices"].split() if c != "chest"))
PY
)')] + B[1:] + [good, 'aspirate'] + $end"
done_as corrected "[says('side', 'left')] + B + [good, 'aspirate'] + $end"
done_as late "B[:3] + [good, says('checked'), 'aspirate'] + $end"
done_as left_out "[says('side'), good, 'aspirate'] + $end"
done_as no_end "B + [good, 'aspirate', 'finish']"
done_as idle "B + [good, 'aspirate', says('after_pleura', 'go_on')] + $end"
done_as harm_right "B + [pleura, says('after_pleura')] + $end"
done_as harm_wrong "B + [pleura, says('after_pleura', 'other_side')] + $end"
done_as harm_none "B + [pleura] + $end"
done_as harm_early "B + [says('after_pleura'), pleura] + $end"
python3 - "$work" <<'PY' || fail "the decisions"
import csv, json, sys
def of(name):
    j = json.load(open(f"{sys.argv[1]}/{name}.json"))
    rows = {r["name"]: r["score"] for r in j["rows"]}
    return j, rows, {d["question"]: d["state"] for d in j["decisions"]}
j, rows, states = of("right")
assert j["points"] == j["most_points"] == 35 and j["outcome"] == "completed" and rows["decisions"] == 5, (j["points"], rows)
assert states == {q: "right" for q in ("patient", "side", "indication", "checked", "proof")}, states
for name, row, outcome, time, others in (
        ("wrong", 1, "not completed", 1, {"side": "wrong"}), ("corrected", 1, "not completed", 1, {"side": "wrong"}),
        ("other_patient", 1, "not completed", 1, {"patient": "wrong"}), ("misjudged", 4, "completed", 5, {"indication": "wrong"}),
        ("harm_early", 4, "failed", None, {"after_pleura": "not answered"}),
        ("late", 1, "not completed", 1, {"checked": "after the cut"}),
        ("left_out", 1, "not completed", 1, {q: "not answered" for q in ("patient", "indication", "checked")}),
        ("no_end", 4, "completed", 5, {"proof": "not answered"}), ("idle", 5, "completed", 5, {}),
        ("harm_right", 5, "failed", None, {"after_pleura": "right"}), ("harm_wrong", 4, "failed", None, {"after_pleura": "wrong"}),
        ("harm_none", 4, "failed", None, {"after_pleura": "not answered"})):
    j, rows, states = of(name)
    assert (rows["decisions"], j["outcome"]) == (row, outcome), (name, rows, j["outcome"], j["reason"])
    assert time is None or rows["time"] == time, (name, rows)
    assert {q: s for q, s in states.items() if q in others} == others, (name, states)
    assert all(s == "right" for q, s in states.items() if q not in others), (name, states)
    assert ("after_pleura" in states) == name.startswith("harm"), states
assert of("late")[0]["reason"] == "the time-out was left out"
assert of("wrong")[0]["reason"] == "the time-out named another patient or task"
log = [r["decisions_score"] for r in csv.DictReader(open(sys.argv[1] + "/log.csv"))]
assert log == ["5", "1", "4", "1", "1", "1", "1", "4", "5", "5", "4", "4", "4"], log
PY
grep -q 'Luftblasen kommen in die Spritze' "$work/harm_wrong.html" && grep -q '<b>falsch</b>' "$work/harm_wrong.html" &&
  grep -q '<td>links<br>' "$work/wrong.html" || fail "the German page does not tell what was asked and answered"
grep -q '^FRAGE: Welche Seite ist verlangt? falsch; richtig ist: rechts$' "$work/wrong.text" || { cat "$work/wrong.text"; fail "the table does not"; }

# Whoever is asked nothing is not judged by it; what a script may answer comes from the rubric.
record plain '[good, "aspirate", "finish"]'
"$TREPHINE" score "$work/plain.lesson" --case "$work/chest" --rubric "$work/subclavian.json" >"$work/text"
grep -q '^30 of 30 points' "$work/text" && grep -q "^The rubric's questions were not asked" "$work/text" || { cat "$work/text"; fail "nothing was asked, and it is judged, or not said"; }
expect 64 '[-]-rubric: is needed where the script answers' "$TREPHINE" lesson "$work/chest" --script "$work/right.script.json" --record "$work/no.lesson"
expect 64 '[-]-rubric: is of spine_needle' "$TREPHINE" lesson "$work/chest" --script "$work/right.script.json" --record "$work/no.lesson" --rubric "$work/spine_needle.json"
for bad in 'says("blood_group")|question: blood_group: the rubric has patient, side' 'says("side", "up")|choice: up: the question offers'; do
  python3 "$work/script.py" "$work/bad.json" "[${bad%%|*}, 'finish']"
  expect 65 "bad.json: steps.0..answer: ${bad#*|}" "$TREPHINE" lesson "$work/chest" --script "$work/bad.json" --record "$work/no.lesson" --rubric "$work/subclavian.json"
done

# A question that is struck from a recording, with its seal made anew, is missed; so is a right answer put in the place of another.
cat >"$work/forge.py" <<'PY'
import hashlib, json, sys
way, source, target = sys.argv[1:]
b = bytearray(open(source, "rb").read())
length = int.from_bytes(b[12:16], "little")
h = json.loads(b[16:16 + length])
asked = h["lesson"]["asked"]
if way == "struck": del asked[1]
if way == "none": del h["lesson"]["asked"]
if way in ("renamed", "elsewhere"): asked[1]["choices"] = " ".join(reversed(asked[1]["choices"].split()))
if way == "elsewhere": h["lesson"]["rubric_sha256"] = "1" * 64
h["seal_sha256"] = "0" * 64
head = bytes(b[:16]) + json.dumps(h).encode().ljust(length - 1) + b"\n"
h["seal_sha256"] = hashlib.sha256(bytes(b[16 + length:]) + head).hexdigest()
open(target, "wb").write(bytes(b[:16]) + json.dumps(h).encode().ljust(length - 1) + b"\n" + bytes(b[16 + length:]))
PY
for way in struck renamed; do
  python3 "$work/forge.py" $way "$work/wrong.lesson" "$work/$way.lesson"
  expect 80 "$way.lesson: lesson.asked: are not the questions of the rubric" "$TREPHINE" score "$work/$way.lesson" --case "$work/chest" --rubric "$work/subclavian.json"
done
# With all of them struck nothing is judged by them, and answers remain that nobody asked for.
python3 "$work/forge.py" none "$work/wrong.lesson" "$work/none.lesson"
expect 80 "none.lesson: lesson.asked: " "$TREPHINE" score "$work/none.lesson" --case "$work/chest" --rubric "$work/subclavian.json"

# What names another rubric is not judged by what that one asked.
python3 "$work/forge.py" elsewhere "$work/wrong.lesson" "$work/elsewhere.lesson"
"$TREPHINE" score "$work/elsewhere.lesson" --case "$work/chest" --rubric "$work/subclavian.json" --log "$work/elsewhere.csv" >"$work/text"
python3 -c 'import csv, sys; assert [r["decisions_score"] for r in csv.DictReader(open(sys.argv[1]))] == [""]' "$work/elsewhere.csv" || fail "the log judges them"
grep -Eq '^Time-out and decisions +not judged  it was asked by another rubric' "$work/text" && grep -q '^The recording names another rubric' "$work/text" ||
  { cat "$work/text"; fail "answers to another rubric's questions are judged"; }

# Points are signed where the signed recording names the rubric by which they are given.
openssl genpkey -algorithm ed25519 -out "$work/teacher.pem" 2>/dev/null
openssl pkey -in "$work/teacher.pem" -pubout -out "$work/teacher.pub"
chmod 600 "$work/teacher.pem"
for name in right plain; do "$TREPHINE" sign "$work/$name.lesson" --key "$work/teacher.pem" >/dev/null; done
signed() { # RECORDING RUBRIC
  "$TREPHINE" score "$work/$1.lesson" --case "$work/chest" --rubric "$2" --signed-by "$work/teacher.pub" | grep -x 'signed\|not signed'
}
[[ $(signed right "$work/subclavian.json") == signed ]] || fail "what names its rubric is not signed"
[[ $(signed plain "$work/subclavian.json") == 'not signed' ]] || fail "what names no rubric is signed"
sed 's/ideal_s: {limit: 120/ideal_s: {limit: 119/' "$SOURCE/configs/rubrics/subclavian.yaml" >"$work/other.yaml"
"$OFFLINE" rubric "$work/other.yaml" --output "$work/other.json" >/dev/null
[[ $(signed right "$work/other.json") == 'not signed' ]] || fail "what names another rubric is signed"

# The largest rubric that is taken can be recorded, and a larger one is refused when it is compiled.
python3 - "$SOURCE/configs/rubrics/subclavian.yaml" "$work" <<'PY'
import sys
text = open(sys.argv[1]).read().split("questions:")[0]
def rubric(name, letters):
    out = text + "questions:\n"
    for q in range(16):
        out += f"  - {{question: q{q:02}, when: before, text: T, why: W, choices: ["
        out += ", ".join(f"{{choice: {'c' * letters}{c}, text: T{', right: true' if c == 0 else ''}}}" for c in range(8)) + "]}\n"
    open(f"{sys.argv[2]}/{name}.yaml", "w").write(out)
rubric("largest", 5)
rubric("larger", 6)
PY
"$OFFLINE" rubric "$work/largest.yaml" --output "$work/largest.json" >/dev/null || fail "the largest rubric"
python3 "$work/script.py" "$work/largest.script.json" '[says("q15"), good, "finish"]'
"$TREPHINE" lesson "$work/chest" --script "$work/largest.script.json" --record "$work/largest.lesson" --participant r-01 --rubric "$work/largest.json" >/dev/null ||
  fail "the questions of the largest rubric have no room"
expect 78 'the names of questions and choices up to here have [0-9]+ letters, at most 1000' "$OFFLINE" rubric "$work/larger.yaml" --output "$work/larger.json"

# Faults of the questions in a rubric are told by their place.
for bad in 's/when: artery$/when: sneeze/|when: sneeze is neither' 's/question: side/question: patient/|patient is listed twice' \
  '0,/, right: true/s/, right: true//|0 are right' 's/^wrong_answers_count:/time_count:/|time_count'; do
  sed "${bad%%|*}" "$SOURCE/configs/rubrics/subclavian.yaml" >"$work/bad.yaml"
  expect 78 "bad.yaml.*${bad##*|}" "$OFFLINE" rubric "$work/bad.yaml" --output "$work/bad.json"
done
