#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Random events of mouse, keyboard and remote: the window does not crash, its memory stays what it is, and what was recorded
# replays. PLAY_S says for how long (an hour in the long suites).
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/window.sh"
longest_s=60
: "${PLAY_S:=3600}" "${PLAY_SEED:=1}"
RANDOM=$PLAY_SEED
"$WRITE_CASE" "$work/sample" play
open_window "$TREPHINE" play "$work/sample" --window-width 480 --window-height 360 --no-realtime --shots "$work/shots"
keys=(g m x bracketleft bracketright t Home c k p equal minus h 1 2 3 4 5 6 7 F1 F2 F3 F4 F5 F6 F7 F8 Left Right Up Down w s space)
lines=('tool burr' 'tool ball' 'tool needle' 'tool craniotome' 'view top' 'view oblique' 'opacity scalp 0.3' 'opacity scalp 1'
  'opacity skull 0.5' 'opacity skull 1' 'hide brain' 'show brain' 'cut tool' 'cut axial' 'cut none' 'incise' 'pedal on' 'pedal off'
  'place 1 -20 345' 'place 20 -20 335 0.5 0 0.8' 'place 1 -20 330' 'move 3 0 -4' 'move -5 2 1' 'aim' 'orbit 30 20' 'orbit -50 -70'
  'zoom 0.7' 'zoom 1.4' 'view surgeon' 'slices on' 'slices off' 'trace on' 'trace off' 'insets on' 'insets off' 'nonsense' 'state')
# As many incisions as are drawn at once (48), for each takes some memory until then.
for n in {1..50}; do
  for line in "place $((RANDOM % 30 - 14)) $((RANDOM % 30 - 35)) 338" incise; do
    ask "$line"
    sleep 0.2
  done
done
memory() { awk '$1 == "VmRSS:" { print $2 }' /proc/$sim/status; }
end=$((SECONDS + PLAY_S)) first=0 half=$((SECONDS + PLAY_S / 2)) events=0
while ((SECONDS < end)); do
  case $((RANDOM % 6)) in
    0) xdotool key "${keys[RANDOM % ${#keys[@]}]}" ;;
    1) xdotool mousemove $((RANDOM % 480)) $((RANDOM % 360)) ;;
    2) xdotool click $((1 + RANDOM % 5)) ;;
    3) xdotool keydown w keydown space mousemove_relative -- $((RANDOM % 21 - 10)) $((RANDOM % 21 - 10)); sleep 0.3
       xdotool keyup w keyup space ;;
    4) xdotool mousedown 3 mousemove $((RANDOM % 480)) $((RANDOM % 360)) mouseup 3 ;;
    5) ask "${lines[RANDOM % ${#lines[@]}]}" ;;
  esac
  events=$((events + 1))
  kill -0 $sim 2>/dev/null || { tail -n 5 "$work/said" "$work/fault" >&2; fail "it ended after $events events"; }
  # Memory is compared from the half of the time on: until then caches of the driver fill.
  ((first > 0 || SECONDS < half)) || first=$(memory)
done
last=$(memory)
ask quit
ended
# A machine that stalls long enough is a fault of the session, which is told and no crash.
[[ $code == 0 || ($code == 74 && $(cat "$work/fault") == *"device: time step:"*) ]] || { cat "$work/fault" >&2; fail "exit code $code"; }
echo "$events events, $first kB of memory at half time, $last kB at the end"
((last <= first + first / 100 + 4000)) || fail "the memory grows"
