#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Lessons done in the window: one that begins with a hole, with the catheter passed, finished by its key, judged and reviewed. With
# LONG=1 also a whole one by mouse, keys and pedal (marked, erased, incised, drilled through), one that is left and one that is
# cancelled. The recording is judged the same by `score`.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/window.sh"
lesson=ventriculostomy
. "$(dirname "$0")/lesson_window.sh"
[[ $LONG == 0 ]] || "$WRITE_CASE" "$work/head" head
"$WRITE_CASE" "$work/head_drilled" head_drilled

# catheter MM: from where it was put, W and then steps lead it to the foramen of the right until it is that near.
catheter() {
  press_on w
  for try in {1..400}; do
    step 0.56 0.28 -1.48
    read -r x y z <<<"$(triple tip)"
    awk -v x="$x" -v y="$y" -v z="$z" -v m="$1" 'BEGIN { exit (x + 3) ^ 2 + (y + 5) ^ 2 + (z - 22) ^ 2 > m * m }' && return
  done
  fail "the catheter never comes there: $answer"
}

# A case with a hole begins at the catheter. Nothing is shown before the end that a surgeon would not see.
# It is asked who lies there, and what for; a wrong answer is taken as one, and not told.
questions=
begin head_drilled --out "$work/out" --advance-mm-per-s 12
until_lesson 'tool catheter step 1 passes_count 0 .*question patient .*head-drilled'
ask 'answer somebody'
[[ $answer == 'error: somebody: the question has no such answer' ]] || fail "an answer that is none: $answer"
ok 'answer head-drilled'
until_lesson 'question side '
ok 'answer left'
until_lesson 'question indication '
ok 'answer csf_pressure'
until_lesson 'question imaging '
# By its digit, which takes no tool while something is asked.
read -ra offered <<<"${answer##*question imaging }"
for n in "${!offered[@]}"; do [[ ${offered[n]} == this_ct ]] && xdotool key $((n + 1)); done
until_lesson 'tool catheter .*end none$'
ask 'answer this_ct'
[[ $answer == 'error: nothing is asked now' ]] || fail "an answer to nothing: $answer"
for barred in 'hide skin' 'opacity skin 0.3' aim 'cut tool' 'places on' 'slices on' 'insets on'; do
  ask "$barred"
  [[ $answer == 'error: not before the lesson'* ]] || fail "$barred: $answer"
done
ask state
[[ $answer == *' in hidden touching hidden '*' depth hidden '* ]] || fail "the remote tells where the tip is: $answer"
ask incise
[[ $answer == 'error: the marker has not touched yet' ]] || fail "an incision without a mark: $answer"
moves ok 'place -28.8 -18.2 89.7 -0.351 -0.179 0.920'
catheter 4
xdotool key Return
sleep 0.3
ask lesson
[[ $answer == *'end none' ]] || fail "one key ends the lesson: $answer"
# What comes after the procedure is asked before its end, which may be called again.
xdotool key Return key Return
until_lesson 'question outlet '
ok 'answer cm_15'
until_lesson 'question proof '
xdotool key Return key Return
until_lesson 'end finished points [0-9]+ of 30'
ask 'tool burr'
[[ $answer == error:* ]] || fail "a tool after the end"
until_is state ' in [a-z]+ touching [a-z]+ .* depth [0-9]'
[[ $answer != *hidden* ]] || fail "the review hides where the tip was: $answer"
# The review: back and forth, cut away, with what the case says of places.
ok 'cut coronal'; ok 'opacity skin 0.2'; ok 'places on'; ok 'go_to 1'
xdotool key Escape
finish 0
one=$work/out/r-01-ventriculostomy-01-head-drilled
judged $one.lesson "$work/head_drilled"
python3 - $one.json <<'PY'
import json, sys
j = json.load(open(sys.argv[1]))
rows = {r["name"]: r["score"] for r in j["rows"]}
assert j["participant"] == "r-01" and j["facts"]["end"] == "finished", j["facts"]
states = {d["question"]: d["state"] for d in j["decisions"]}
assert states == {"patient": "right", "side": "wrong", "indication": "right", "imaging": "right", "outlet": "right", "proof": "not answered"}, states
assert rows["decisions"] == 1 and j["outcome"] == "not completed", (rows, j["outcome"])
assert rows["trajectory"] == 5 and rows["tip"] >= 4 and rows["depth"] >= 3, rows
PY
[[ $(wc -l <"$work/out/attempts-ventriculostomy.csv") == 2 ]] || fail "no line in the log"

play=("$TREPHINE" play "$work/head_drilled" --lesson ventriculostomy)
expect 64 '[-]-rubric: is needed' "${play[@]}" --out "$work/out"
expect 64 '[-]-out: or --record is needed' "${play[@]}" --rubric "$work/ventriculostomy.json"
expect 64 '[-]-participant: must be' "${play[@]}" --rubric "$work/ventriculostomy.json" --out "$work/out" --participant "Jane Doe"
expect 64 'is of a --lesson' "$TREPHINE" play "$work/head_drilled" --participant r-01
# A case that is another than the one that was found approved: no lesson begins.
expect 80 'head_drilled: case.json: was exchanged while the lesson ran' "${play[@]}" --rubric "$work/ventriculostomy.json" --out "$work/exchanged" --approved-sha256 "$(printf '0%.0s' {1..64})"
[[ -z $(ls "$work/exchanged" 2>/dev/null) ]] || fail "a refused lesson leaves $(ls "$work/exchanged")"
"$WRITE_CASE" "$work/sample" play
expect 65 'case.json: haptic.shapes: the lesson needs' "$TREPHINE" play "$work/sample" --lesson ventriculostomy --rubric "$work/ventriculostomy.json" --out "$work/out"
[[ $LONG == 1 ]] || exit 0

# The whole lesson.
questions=--no-questions
begin head --view top --record "$work/whole.lesson" --advance-mm-per-s 12
xdotool mousemove 240 230 mousedown 1
for at in 225 220 215 210 205 200 195 190; do xdotool mousemove 240 $at; sleep 0.2; done
until_lesson 'trace_mm [1-9][0-9]* traces_count [1-9]'
xdotool mouseup 1
ok 'place -27.1 -17.5 90'
ok 'pedal on'; ok 'move 0 0 -5'
until_lesson 'traces_count [2-9]'
ok 'pedal off'
xdotool key e key m
until_lesson 'incisions_count 1'
xdotool key n  # the burr
until_lesson 'tool burr step 4'
xdotool key BackSpace
until_lesson 'tool marker step 1'
xdotool key 2
until_lesson 'tool burr'
moves ok 'place -26.2 -17 83.4 -0.2945 -0.1905 0.9365'
xdotool keydown space keydown w
until_lesson 'hole through'
xdotool keyup w keyup space key p
sleep 0.5
ask lesson
[[ $answer != *paused* ]] || fail "a pause while the burr is in the bone"
ok 'place -60 -40 180'
xdotool key p
until_lesson paused
xdotool key p key 3
until_lesson 'tool catheter step 5'
[[ $answer != *paused* ]] || fail "it does not go on"
moves ok 'place -28.8 -18.2 89.7 -0.351 -0.179 0.920'
catheter 4
ok finish
until_lesson 'end finished points [0-9]+ of 35'
ok quit
finish 0
judged "$work/whole.lesson" "$work/head"
python3 - "$work/whole.json" <<'PY'
import json, sys
j = json.load(open(sys.argv[1]))
rows = {r["name"]: r["score"] for r in j["rows"]}
assert j["participant"] == "r-01" and j["facts"]["end"] == "finished", j["facts"]
assert rows["burr_hole"] >= 4 and rows["trajectory"] >= 4 and rows["tip"] >= 4 and rows["depth"] >= 3, rows
assert j["facts"]["pauses"] == 1 and len(j["facts"]["incisions"]) == 1 and all(t["erased"] for t in j["facts"]["traces"]), j["facts"]
PY
grep -q '^ventriculostomy removed .*skull' "$work/said" || { cat "$work/said"; fail "nothing was drilled"; }
[[ $(wc -l <"$work/attempts-ventriculostomy.csv") == 2 ]] || fail "no line in the log"
"$TREPHINE" replay "$work/head" "$work/whole.lesson" | grep -q '^replayed bit for bit$' || fail "not bit for bit"

# A window that is closed leaves a lesson that nobody finished.
begin head_drilled --out "$work/out" --advance-mm-per-s 12
moves ok 'place -28.8 -18.2 89.7 -0.351 -0.179 0.920'
catheter 17
xdotool key Escape
finish 0
judged "$work/out/r-01-ventriculostomy-02-head-drilled.lesson" "$work/head_drilled"
grep -q 'not finished, catheter passes: 1' "$work/said" || { cat "$work/said"; fail "the end is not said"; }
begin head_drilled --out "$work/out"
until_lesson 'time [0-9.]*[1-9]'
kill -INT $sim
finish 130
[[ -s $work/out/r-01-ventriculostomy-03-head-drilled.lesson && ! -e $work/out/r-01-ventriculostomy-03-head-drilled.json ]] ||
  fail "what was cancelled is kept, and not judged"
