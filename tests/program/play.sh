#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A real window on a screen of Xvfb, worked by real events of mouse and keyboard, and by the remote's lines.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/window.sh"
"$WRITE_CASE" "$work/sample" play
# A busy machine may stand still for a second, which else ends all force.
window=(--window-width 480 --window-height 360 --no-realtime --no-panels --max-step-s 3600)

# begin ARGUMENTS...: opens a window on the sample.
begin() { open_window "$TREPHINE" play "$work/sample" "${window[@]}" "$@"; }
until_state() { until_is state "$1"; }

begin --head-port 0 --record "$work/play.servo" --shots "$work/shots" --incision-radius-mm 12
until_state 'time [1-9]|time 0\.[1-9]'
before=$(field tip)

# The mouse moves the tool; G puts it to the surface under the cursor; M incises; W and the space bar drill.
xdotool mousemove 240 180 mousemove 260 180
end=$((SECONDS + longest_s))
while ask state && [[ $(field tip) == "$before" ]]; do
  ((SECONDS < end)) || fail "the mouse does not move the tool"
  sleep 0.1
done
xdotool mousemove 240 150
moves xdotool key g
xdotool key m
until_state 'incisions 1'
ok 'place 1 -20 338'
xdotool keydown space keydown w
until_state 'touching skull'
# Two seconds of the drill's own time.
began=$(field time) end=$((SECONDS + longest_s))
while ask state && awk -v a="$began" -v b="$(field time)" 'BEGIN { exit b - a >= 2 }'; do
  ((SECONDS < end)) || fail "time stands still: $answer"
done
xdotool keyup w keyup space
# Turn, shift, come nearer, cut away and back, a picture, another tool.
xdotool mousemove 240 180 mousedown 3 mousemove 300 200 mouseup 3 mousedown 2 mousemove 280 190 mouseup 2
xdotool keydown ctrl click 4 click 4 keyup ctrl key x key bracketright key x key F7 key F1 key c key c key k key F12
until_file "$work/shots/picture-001.png"
# A picture that cannot be written is told, and nothing else happens.
rm -r "$work/shots"
ok shot
until_is 'notes en' 'a file could not be written: .*shots'
# Other burrs by keys, and only where a burr is in the hand.
until_state 'burr_mm 5$'
xdotool key b
until_state 'tool burr .* burr_mm 6$'
ok 'burr smaller'; ok 'burr smaller'
until_state 'burr_mm 4$'
ok 'burr kind'
until_state 'tool ball .* burr_mm 4$'
ask 'burr bigger'
[[ $answer == 'error: burr: must be smaller, larger or kind' ]] || fail "another word: $answer"
xdotool key 3
until_state 'tool catheter'
ask 'burr larger'
[[ $answer == error:* ]] || fail "a catheter is made a larger burr"
# What became of the burr is a note, in either language.
until_is notes '[0-9]:[0-9][0-9] burr: [0-9]+ ticks'
until_is 'notes de' '[0-9]:[0-9][0-9] burr hat entfernt: .*skull .* \| [0-9]:[0-9][0-9] burr: [0-9]+ Takte'
ok 'view left'; ok 'opacity scalp 0.3'; ok 'hide brain'; ok 'show brain'; ok 'cut coronal'; ok 'move_cut 2'; ok 'cut none'
ok 'orbit 10 -5'; ok 'zoom 0.9'; ok 'pedal on'; ok 'pedal off'; ok 'aim'; ok 'trace on'; ok 'slices on'; ok 'places off'; ok 'insets on'; ok 'head 20 -10 30'
for wrong in 'tool hammer' 'view inside' 'opacity hair 1' 'opacity scalp 2' 'opacity scalp' 'cut along' 'move 1 2' 'pedal maybe' 'zoom 0' 'notes fr' nonsense; do
  ask "$wrong"
  [[ $answer == error:* ]] || fail "$wrong: $answer"
done
xdotool key Escape
finish 0
grep -q '^burr removed .*skull' "$work/said" || { cat "$work/said"; fail "nothing was drilled"; }
"$TREPHINE" replay "$work/sample" "$work/play.servo" >"$work/text" || { cat "$work/text"; fail "what was played is not replayed"; }
grep -q '^replayed bit for bit$' "$work/text" || fail "not bit for bit"
expect 65 'begins_sha256: it began with' "$TREPHINE" replay "$work/sample" "$work/play-2.servo"
expect 65 'begins_sha256: the recordings given before' "$TREPHINE" replay "$work/sample" "$work/play-2.servo" --before "$work/play-2.servo"
"$TREPHINE" replay "$work/sample" "$work/play-2.servo" --before "$work/play.servo" >"$work/text" || { cat "$work/text"; fail "the second tool is not replayed"; }
grep -q '^replayed bit for bit$' "$work/text" || fail "the second tool: not bit for bit"

# The recording is shown, forwards and backwards.
begin --playback "$work/play.servo" --ghost "$work/play-2.servo"
ok 'pause on'; ok 'go_to 0'
until_state 'time 0\.0'
ok 'go_to 1000'
until_state 'incisions 1'
last=$(field time)
ok 'go_to 1'
until_state 'time [01]\.'  # the last tick before that, which a busy machine has had long before
[[ $last != "$(field time)" ]] || fail "it does not go back"
ask 'tool burr'
[[ $answer == error:* ]] || fail "a tool in a recording"
ok quit
finish 0

# Ctrl-C ends a session and keeps its recording.
begin --record "$work/short.servo" --device hand --tool ball --device-damping-n-s-per-mm 0.002
until_state 'time [0-9.]*[1-9]'
kill -INT $sim
finish 130
"$TREPHINE" replay "$work/sample" "$work/short.servo" >/dev/null || fail "the recording of an ended session"

# A device that nobody connects keeps the window neither from Ctrl-C nor from being closed.
begin --device udp --port 0 --tool ball
kill -INT $sim
finish 130
begin --device udp --port 0 --tool ball
ok quit
finish 0
grep -q '^waiting for a device on' "$work/said" || { cat "$work/said"; fail "nobody is told what it waits for"; }

MESA_GL_VERSION_OVERRIDE=3.3 expect 74 'OpenGL: .*4\.3' "$TREPHINE" play "$work/sample" "${window[@]}"
DISPLAY=:999 expect 74 'display: no window' "$TREPHINE" play "$work/sample"
expect 64 'is shown or made' "$TREPHINE" play "$work/sample" --playback "$work/play.servo" --record "$work/z.servo"
