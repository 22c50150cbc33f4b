#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A lesson in the window with a catheter that a fake tracker sees: passed through the hole to the foramen, finished and judged. The
# report says how far the tool may have been off, and rows with a smaller limit are not judged.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/window.sh"
lesson=ventriculostomy
. "$(dirname "$0")/lesson_window.sh"
. "$(dirname "$0")/tracker.sh"
"$WRITE_CASE" "$work/head" head_drilled
"$SERVER" tracking "$work/t.json" "$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["case"])' "$work/head/case.json")" 1.5 \
  "$(sha256sum <"$work/head/case.json" | head -c 64)"
tracker 'at -40.7 -24.3 120.9'
begin head --out "$work/out" --device openigtlink --tracking "$work/t.json" "${link[@]}"
until_lesson 'tool catheter step 1 passes_count 0'
tracker 'go -3.6 -5.4 23.6 -0.351 -0.179 0.920'
until_is state 'tool_at -3\.[0-9]+ -5\.[0-9]+ 23\.[0-9]+'
until_lesson 'passes_count 1'
ok finish
until_lesson 'end finished points [0-9]+ of [0-9]+'
ok quit
finish 0
one=$work/out/r-01-ventriculostomy-01-head-drilled
judged $one.lesson "$work/head"
python3 - $one.json <<'PY'
import json, sys
j = json.load(open(sys.argv[1]))
rows = {r["name"]: r for r in j["rows"]}
assert 1.5 < j["place_error_mm"] < 1.6, j["place_error_mm"]
assert any("1.5 mm off" in note for note in j["provenance"]), j["provenance"]
assert rows["trajectory"]["score"] == "not judged" and "1.5 mm off" in rows["trajectory"]["why"], rows["trajectory"]
assert rows["tip"]["score"] == 5 and rows["depth"]["score"] >= 3, (rows["tip"], rows["depth"])
PY
grep -q 'tracker saw the tool.*1.5 mm off' $one.html || fail "the page does not say it"
grep -aq openigtlink "$one.lesson" || fail "the recording does not say which device"
echo quit >&"$tracker_in"
