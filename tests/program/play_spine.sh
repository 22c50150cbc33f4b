#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The spine needle in the window: the C-arm's keys and pedal, the needle in the picture at once, exposure and shots, and the score.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/window.sh"
: "${OFFLINE:?}"
for lesson in spine_needle pedicle_screw; do
  "$OFFLINE" rubric "$SOURCE/configs/rubrics/$lesson.yaml" --output "$work/$lesson.json" >/dev/null
done
"$WRITE_CASE" "$work/spine" spine
"$WRITE_CASE" "$work/chest" chest

# begin LESSON: opens a window on it.
begin() {
  open_window "$TREPHINE" play "$work/spine" --lesson "$1" --rubric "$work/$1.json" --participant r-01 --task pedicle_2_left --out "$work/out" \
    --no-realtime --no-questions --max-step-s 3600 --window-width 480 --window-height 360 --no-panels --shots "$work/shots" --advance-mm-per-s 20
}
# in_picture FILE: the needle's tip is where the window says, bright beside what is beyond it.
in_picture() {
  ask xray
  read -r x y <<<"$(sed -E 's/.* tip_px ([^ ]+) ([^ ]+).*/\1 \2/' <<<"$answer")"
  python3 - "$1" "$x" "$y" <<'PY'
import struct, sys, zlib
b, at, size, data = open(sys.argv[1], "rb").read(), 8, 0, b""
while at < len(b):
    n, kind = struct.unpack(">I4s", b[at:at + 8])
    if kind == b"IHDR": size = struct.unpack(">I", b[at + 8:at + 12])[0]
    if kind == b"IDAT": data += b[at + 8:at + 8 + n]
    at += 12 + n
rows = zlib.decompress(data)
grey = lambda x, y: rows[y * (size + 1) + 1 + x]
x, y = (int(float(v)) for v in sys.argv[2:4])
assert size == 512, size
near = max(grey(i, j) for i in range(x - 6, x + 7) for j in range(y - 6, y + 7))
assert near == 255, (x, y, near)
# In front of the tip there is none: on one side of it at least.
around = [max(grey(x + a + i, y + b + j) for i in range(-2, 3) for j in range(-2, 3)) for a, b in ((14, 0), (-14, 0), (0, 14), (0, -14))]
assert min(around) < 230, around
PY
}

# The point of the ideal axis of a pedicle that lies so far before its entry, and the tool's axis, from the tip to its end.
read -r point axis target along <<<"$(python3 - "$work/spine/case.json" <<'PY'
import json, sys
at = {l["name"]: l["position_mm"] for l in json.load(open(sys.argv[1]))["landmarks"]}
e, t = at["pedicle_2_left_entry"], at["pedicle_2_left_target"]
n = sum((a - b) ** 2 for a, b in zip(e, t)) ** 0.5
axis = [(a - b) / n for a, b in zip(e, t)]
text = lambda v: ",".join("%.3f" % x for x in v)
print(text([a + 60 * b for a, b in zip(e, axis)]), text(axis), text(t), " ".join("%.3f" % (-2 * x) for x in axis))
PY
)"

# next_picture: the needle, which has moved, is seen so.
next_picture() {
  local end=$((SECONDS + longest_s))
  while ask xray && (($(field pictures) <= last)); do
    ((SECONDS < end)) || fail "the needle is not seen to move: $answer"
    sleep 0.05
  done
  last=$(field pictures)
}

begin spine_needle
# No picture before the pedal; the arm goes where its keys say, and X-rays count only while the pedal is down.
until_is xray '^off view ap orbit_deg 0 tilt_deg 0 exposure_s 0.000 shots_count 0 pictures 0$'
xdotool key l
until_is xray 'view lateral orbit_deg 90 tilt_deg 0 exposure_s 0.000'
xdotool key o
until_is xray 'view oblique orbit_deg 45'
xdotool key period
until_is xray 'view free orbit_deg 50'
xdotool key Prior
until_is xray 'view free orbit_deg 50 tilt_deg 5'
xdotool key f
until_is xray 'view ap orbit_deg 0 tilt_deg 0'
moves ok "place ${point//,/ } ${axis//,/ }"
xdotool keydown space
until_is xray '^on .* size_px 512 .* tip_px '
xdotool keyup space
until_is xray '^off .* exposure_s [0-9.]*[1-9][0-9]* shots_count 1 '
before=$answer counted="$(field exposure_s) $(field shots_count)" pictures=$(field pictures)
sleep 0.5
ask xray
[[ "$(field exposure_s) $(field shots_count)" == "$counted" ]] || fail "X-rays count while they are off: $before, $answer"
# The picture that was being made when the pedal came up is finished; no other is made.
(($(field pictures) <= pictures + 1)) || fail "pictures while X-rays are off: $before, $answer"
ok shot
until_file "$work/shots/picture-001-xray.png"
in_picture "$work/shots/picture-001-xray.png"
# The surgeon stands behind the patient: the picture is flipped, and as the detector has it by a key.
until_is xray 'tip_px .* flipped$'
ask xray
shown=$(sed -E 's/.* tip_px ([0-9.]+) .*/\1/' <<<"$answer")
xdotool key q
until_is xray 'tip_px [0-9.]+ [0-9.]+$'
awk -v a="$shown" -v b="$(sed -E 's/.* tip_px ([0-9.]+) .*/\1/' <<<"$answer")" 'BEGIN { d = a + b - 512; exit d * d > 0.01 }' ||
  fail "it is not the mirror image: $shown, $answer"
ok shot
until_file "$work/shots/picture-002-xray.png"
in_picture "$work/shots/picture-002-xray.png"
ok 'flip on'
# The needle is pushed under lateral X-rays, and seen to move while they are on.
xdotool key l
until_is xray 'view lateral'
xdotool keydown space
until_is xray '^on .* shots_count 2 .* size_px 512 .* tip_px '
press_on w
ask xray
last=$(field pictures)
for try in {1..400}; do
  step $along
  read -r x y z <<<"$(triple tip)"
  awk -v a="$x,$y,$z" -v b="$target" 'BEGIN { split(a, p, ","); split(b, t, ","); exit (p[1]-t[1])^2 + (p[2]-t[2])^2 + (p[3]-t[3])^2 > 9 }' && break
  ((try % 20)) || next_picture
done
((try < 400)) || fail "the needle never comes to the target: $answer"
next_picture
until_is xray '^on .* size_px 512 '
xdotool keyup space
until_is xray '^off '
xdotool key F12
until_file "$work/shots/picture-003-xray.png"
in_picture "$work/shots/picture-003-xray.png"
until_is lesson 'passes_count 1 shots_count 2 exposure_s '
ok finish
until_is lesson 'end finished points [0-9]+ of 35'
ask 'arm lateral'
[[ $answer == error:* ]] || fail "the arm moves after the end"
# The review shows what X-rays had shown last at the moment that is looked at, and no X-rays before the first.
until_is xray '^review shot 2 of 2 .* view lateral .* size_px 512 tip_px '
second_s=$(sed -E 's/.* begin_s ([^ ]+) .*/\1/' <<<"$answer")
ok shot
until_file "$work/shots/picture-004-xray.png"
in_picture "$work/shots/picture-004-xray.png"
ok "go_to $(awk -v s="$second_s" 'BEGIN { print s - 0.05 }')"
until_is xray '^review shot 1 of 2 .* view ap .* size_px 512 tip_px '
ok shot
until_file "$work/shots/picture-005-xray.png"
in_picture "$work/shots/picture-005-xray.png"
cmp -s "$work/shots/picture-004-xray.png" "$work/shots/picture-005-xray.png" && fail "both moments show one picture"
ok 'go_to 0'
until_is xray '^review shot 0 of 2$'
ok quit
finish 0
one=$work/out/r-01-spine_needle-01-spine
"$TREPHINE" score $one.lesson --case "$work/spine" --rubric "$work/spine_needle.json" --json "$work/again.json" >"$work/text"
cmp "$work/again.json" $one.json || fail "judged again it is not the same"
grep -qF "$(tail -1 "$work/text")" "$work/said" || { cat "$work/said" "$work/text"; fail "the window says otherwise"; }
python3 - $one.json <<'PY'
import json, sys
j = json.load(open(sys.argv[1]))
rows = {r["name"]: r["score"] for r in j["rows"]}
assert rows["entry"] == 5 and rows["target"] == 5 and rows["breach"] == 5 and rows["depth"] >= 4 and rows["passes"] == 5, rows
assert [s["view"] for s in j["facts"]["shots"]] == ["ap", "lateral"] and j["facts"]["exposure_s"] > 0.1, j["facts"]
PY
[[ $(wc -l <"$work/out/attempts-spine_needle.csv") == 2 ]] || fail "no line in the log"

# The open exercise: finder, then screw.
begin pedicle_screw
until_is lesson 'tool finder'
# Whoever stands behind the patient comes back there with F1: the picture's right is the patient's right, where x falls.
ok 'view left'
xdotool key F1
ask state
x=$(triple tool_at | cut -d' ' -f1)
moves xdotool key --delay 30 shift+Right shift+Right shift+Right
awk -v a="$x" -v b="$(triple tool_at | cut -d' ' -f1)" 'BEGIN { exit !(b < a - 0.1) }' || fail "F1 does not show the back: $x, then $answer"
until_is 'tool screw_5.5x40' '^ok$'  # once its device is there
until_is lesson 'tool screw_5.5x40'
xdotool keydown space
until_is xray '^on .* tip_px '
xdotool keyup space
ok 'arm oblique'
until_is xray 'view oblique'
for wrong in 'arm up' 'arm'; do ask "$wrong"; [[ $answer == error:*'the arm goes to'* ]] || fail "$wrong: $answer"; done
ok quit
finish 0

# What the window cannot show is refused at once.
play=("$TREPHINE" play "$work/spine" --lesson spine_needle --rubric "$work/spine_needle.json" --out "$work/out")
expect 64 '[-]-stereo: hides the fluoroscopic pictures' "${play[@]}" --stereo side_by_side
"$WRITE_CASE" "$work/bare" spine_without_ct
expect 65 'case.json: ct: the case has no CT' "$TREPHINE" play "$work/bare" --lesson spine_needle --rubric "$work/spine_needle.json" --out "$work/out"
