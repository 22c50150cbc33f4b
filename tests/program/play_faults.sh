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
