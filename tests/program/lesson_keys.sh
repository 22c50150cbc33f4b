#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A lesson with the keyboard alone, no mouse and no line that does anything (the remote is only asked how it stands): taps move the
# catheter over a hole, tilt it and push it to the ventricle, and the lesson is ended. A tap acts for 0.05 s, however slow pictures are.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/window.sh"
lesson=ventriculostomy
. "$(dirname "$0")/lesson_window.sh"
"$WRITE_CASE" "$work/head_drilled" head_drilled

pose() { echo "$(triple tool_at) $(triple axis)"; }
# rests: until the pose no longer changes.
rests() {
  local end=$((SECONDS + longest_s)) last= since=
  while ((SECONDS < end)); do
    ask state
    if [[ $(pose) != "$last" ]]; then
      last=$(pose) since=$(field time)
    elif awk -v a="$since" -v b="$(field time)" 'BEGIN { exit b - a < 0.3 }'; then
      return 0
    fi
    sleep 0.05
  done
  fail "it never rests: $answer"
}
value() { triple "$1" | cut -d' ' -f"$2"; }
# toward WHAT INDEX GOAL LIMIT STEP MORE LESS: taps the key of MORE or LESS, each of which is a step, until the figure is that near.
toward() {
  local end=$((SECONDS + longest_s)) taps key
  while rests && taps=$(awk -v a="$(value "$1" "$2")" -v b="$3" -v m="$4" -v s="$5" \
    'BEGIN { d = b - a; print (d * d <= m * m ? 0 : d > 0 ? int(d / s + 0.5) : -int(-d / s + 0.5)) }') && [[ $taps != 0 ]]; do
    ((SECONDS < end)) || fail "$1 $2 never comes to $3: $answer"
    key=$6
    if ((taps < 0)); then key=$7 taps=$((-taps)); fi
    local keys=()
    for ((n = 0; n < taps; ++n)); do keys+=("$key"); done
    xdotool key --delay 1 "${keys[@]}"
  done
}

# Seen from above, left in the picture is the patient's left, and up is forwards.
begin head_drilled --out "$work/out" --advance-mm-per-s 20 --move-mm-per-s 10 --turn-deg-per-s 20
until_lesson 'tool catheter step 1 passes_count 0'
xdotool key F6
for try in 1 2 3; do  # each axis moves the other a little
  toward axis 1 -0.351 0.012 0.0164 Left Right
  toward axis 2 -0.179 0.012 0.0164 Down Up
done
# Over the hole, on the line of the tool, as high as it is.
on_line() { awk -v z="$(value tool_at 3)" -v a="$1" -v b="$2" 'BEGIN { print a + b / 0.92 * (z - 89.7) }'; }
toward tool_at 1 "$(on_line -28.8 -0.351)" 0.4 0.5 shift+Left shift+Right
toward tool_at 2 "$(on_line -18.2 -0.179)" 0.4 0.5 shift+Down shift+Up
ask state
toward tip 3 25 2 0.92 s w
until_lesson 'passes_count 1'
xdotool key Return key Return
until_lesson 'end finished points [0-9]+ of 25'
xdotool key Escape
finish 0
one=$work/out/r-01-ventriculostomy-01-head-drilled
judged $one.lesson "$work/head_drilled"
python3 - $one.json <<'PY'
import json, sys
j = json.load(open(sys.argv[1]))
rows = {r["name"]: r["score"] for r in j["rows"]}
assert j["facts"]["end"] == "finished" and rows["tip"] >= 3 and rows["trajectory"] >= 3, (rows, j["outcome"])
PY
