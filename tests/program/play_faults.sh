#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What a window does when something fails, or is not there: a device, the graphics driver, its buffers, time, memory.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/window.sh"
"$WRITE_CASE" "$work/sample" play
play=("$TREPHINE" play "$work/sample" --max-step-s 3600 --window-width 320 --window-height 240 --no-realtime --no-panels --tool ball)
replayed() { "$TREPHINE" replay "$work/sample" "$1" >"$work/text" 2>&1 && grep -q '^replayed bit for bit$' "$work/text" || { cat "$work/text"; fail "$1 does not replay"; }; }
ends_by_itself() { code=0; "$@" >"$work/said" 2>"$work/fault" || code=$?; }
# quit: the session is told to end; its exit code into `code`.
quit() { ask quit; ended; }

# The graphics driver loses its context: one line, and the recording is whole.
ends_by_itself env "LD_PRELOAD=$RESET_STUB" "${play[@]}" --seconds 600 --record "$work/reset.servo"
[[ $code == 74 ]] || { cat "$work/said" "$work/fault"; fail "a driver that was reset ends with $code"; }
[[ $(wc -l <"$work/fault") == 1 ]] && grep -q 'the graphics driver was reset' "$work/fault" || { cat "$work/fault"; fail "not its one line"; }
replayed "$work/reset.servo"

# The device is lost: it is said at once, the force is zero, the window lives on, and the exit code tells.
open_window "${play[@]}" --device adaptor --adaptor "$STUB" --adaptor-index 1 --record "$work/lost.servo"
until_said '^fault: device lost: the force is zero'
ask state
[[ $answer == *" force 0.000 "* && $answer == *" faults 8 "* ]] || fail "a lost device: $answer"
until_is 'notes de' 'Fehler: Gerät verloren: die Kraft ist ab jetzt null'
quit
[[ $code == 74 ]] || fail "a lost device ends with $code"
[[ $(wc -l <"$work/fault") == 1 ]] && grep -q 'device: device lost' "$work/fault" || { cat "$work/fault"; fail "not its one line"; }
replayed "$work/lost.servo"

# A gamepad moves the tool in the picture's plane, whatever the view: seen from the left, to the right is backwards.
mkfifo "$work/pipe"
cat >"$work/feed.py" <<'PY'
import struct, sys, time
def event(kind, code, value): sys.stdout.buffer.write(struct.pack("llHHi", 0, 0, kind, code, value))
event(3, 0, 32767); event(0, 0, 0); sys.stdout.buffer.flush()
time.sleep(900)  # it is ended before
PY
open_window env "LD_PRELOAD=$PAD_STUB" "${play[@]}" --device gamepad --gamepad "$work/pipe" --no-places --push-mm-per-s 10
ask 'view left'
ask state
read -r x0 y0 z0 <<<"$(triple tool_at)"
python3 "$work/feed.py" >"$work/pipe" & feeder=$!
moved=
end=$((SECONDS + longest_s))
while ((SECONDS < end)); do
  ask state
  read -r x y z <<<"$(triple tool_at)"
  moved=$(python3 -c "
d = [$x - $x0, $y - $y0, $z - $z0]
assert max(map(abs, (d[0], d[2]))) <= max(0.3 * d[1], 0.2), d
print('far' if d[1] > 3 else '')") || fail "the gamepad's way"
  [[ -z $moved ]] || break
  sleep 0.1
done
[[ -n $moved ]] || fail "the gamepad does not move the tool: $answer"
quit
[[ $code == 0 ]] || { cat "$work/fault"; fail "a gamepad ends with $code"; }
kill $feeder 2>/dev/null || true
feeder=

# Buffers for two eyes that the driver lacks; pictures that are to be quicker than they can be; too little memory.
open_window "${play[@]}" --stereo quad_buffer --target-ms 0.01
until_said '^stereo: the driver has no buffer for each eye, so the picture is side by side$'
until_said '^reduced: .*grain.*coarse surfaces.*no shadow of the tool, half the pixels$'
quit
[[ $code == 0 ]] || { cat "$work/fault"; fail "ends with $code"; }
expect 74 'graphics_budget_mb: 16 is too little: surfaces and pictures need' "${play[@]}" --graphics-budget-mb 16
expect 64 'quad_buffer is of a window' "$TREPHINE" render "$work/sample" --out "$work/x" --stereo quad_buffer
# A damaged case, by its one line.
cp -r "$work/sample" "$work/damaged"
printf x >>"$work"/damaged/meshes/scalp-*.glb
expect 65 'scalp' "$TREPHINE" play "$work/damaged"

# A device that is registered to the screen: where its window lies on the screen counts. The hand rests before the screen; the window
# is moved, so another point of the case lies there, twice as far for twice the way. A window that fills the screen needs no place.
cat >"$work/bench.json" <<'JSON'
{"trephine_screen": 1, "height_mm": 360, "scale": 1, "turn": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "offset_mm": [0, 0, 0],
 "rms_mm": 0, "worst_mm": 0, "marks_count": 5}
JSON
python3 -c 'for n in range(4000): print(n, 30, 20, 0, 0, 0, 1, 0)' >"$work/rests.txt"
on_screen=("${play[@]}" --device trajectory --trajectory "$work/rests.txt" --screen "$work/bench.json" --no-drill --jump-m-per-s 0)
open_window "${on_screen[@]}"
window=$(xdotool search --name trephine-sim | tail -1)
tool_rests() {  # its place, once it is another than $1 and rests
  local now= last=
  for try in {1..600}; do
    ask state
    now=$(triple tool_at)
    [[ $now != "${1:-}" && $now == "$last" ]] && break
    last=$now
    sleep 0.2
  done
  [[ $now != "${1:-}" ]] || fail "the tool does not go with the window"
  rests=$now
}
xdotool windowmove "$window" 20 20; sleep 1; tool_rests; first=$rests
xdotool windowmove "$window" 50 20; tool_rests "$first"; second=$rests
xdotool windowmove "$window" 80 20; tool_rests "$second"; third=$rests
python3 - $first $second $third <<'PY' || fail "another way than the window's: $first, $second, $third"
import math, sys
a, b, c = ([float(v) for v in sys.argv[n:n + 3]] for n in (1, 4, 7))
one, two = ([q - p for p, q in zip(a, other)] for other in (b, c))
assert math.hypot(*one) > 3 and math.dist([2 * v for v in one], two) < 0.02, (one, two)
PY
quit
open_window "${on_screen[@]}" --screen-number 1
window=$(xdotool search --name trephine-sim | tail -1)
xdotool getwindowgeometry "$window" | grep -q '480x360' || fail "it does not fill the screen"
quit
expect 64 'screen-number: screen 3 is not there; this display has 1' "$TREPHINE" play "$work/sample" --screen-number 3
