#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Devices that are pushed: a gamepad (a pipe, with a stub for what the kernel answers) and a 3D mouse (a stub for libspnav).
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/sample" drill
mkfifo "$work/pipe"
servo=("$TREPHINE" servo "$work/sample" --no-realtime --record "$work/way.servo")
feeder=
trap '[[ -z $feeder ]] || kill $feeder 2>/dev/null || true; rm -rf "$work"' EXIT
# feed SECONDS: pushes for half a second, lets go, and then holds the pipe open for so long.
feed() { python3 "$work/feed.py" "$1" >"$work/pipe" & feeder=$!; }
drop() { kill $feeder 2>/dev/null || true; wait $feeder 2>/dev/null || true; feeder=; }
cat >"$work/way.py" <<'PY'
import struct, sys
frames = list(struct.iter_unpack("<Q17dI4i3I", open(sys.argv[1], "rb").read()[16 + 8192:]))
tip = [(f[3], f[4], f[5]) for f in frames]
axis = [(f[6], f[7], f[8]) for f in frames]
buttons = [f[18] for f in frames]
way = [b - a for a, b in zip(tip[0], tip[-1])]
def near(value, wanted, room): assert abs(value - wanted) < room, (value, wanted, way, axis[-1])
def at_rest(): near(sum(abs(b - a) for a, b in zip(tip[-100], tip[-1])), 0, 0.02)
PY

# The left stick to the right and a little down for half a second, with button A; the right stick to the right; then let go.
cat >"$work/feed.py" <<'PY'
import struct, sys, time
def event(kind, code, value): sys.stdout.buffer.write(struct.pack("llHHi", 0, 0, kind, code, value))
def report():
    event(0, 0, 0)
    sys.stdout.buffer.flush()
time.sleep(0.3)
event(3, 0, 32767); event(3, 1, 16384); event(3, 3, 32767); event(1, 0x130, 1); report()
time.sleep(0.5)
event(3, 0, 0); event(3, 1, 0); event(3, 3, 0); event(1, 0x130, 0); report()
time.sleep(float(sys.argv[1]))
PY
pad=(env "LD_PRELOAD=$PAD_STUB" "${servo[@]}" --device gamepad --gamepad "$work/pipe")
feed 5
"${pad[@]}" --seconds 2 >"$work/text" 2>&1 || { cat "$work/text"; fail "no session with a gamepad"; }
drop
grep -q '^holding Stub Pad' "$work/text" || { cat "$work/text"; fail "does not say what it holds"; }
# 30 mm/s and 60 degrees/s at the end of the way; half of the way is a fifth of the speed. A slow machine sleeps longer.
(cd "$work" && python3 - way.servo <<'PY') || fail "the gamepad's way"
from way import *
near(way[0], 15, 6); near(way[2] / way[0], -0.5 * 0.1975 / 0.5, 0.05); near(way[1], 0, 0.1)
# Tilted to the right, about the picture's vertical axis: the tool points down here, so it keeps its direction.
near(axis[-1][2], 1, 1e-6)
open("begin", "w").write(repr(tip[0]))
assert 300 < buttons.count(1) < 900 and buttons[-1] == 0, buttons.count(1)
at_rest()
PY
"$TREPHINE" replay "$work/sample" "$work/way.servo" | grep -q '^replayed bit for bit$' || fail "its recording does not replay"
# Twice the workspace: twice the way. The clutch (button 1 here) rests the tool.
feed 5
"${pad[@]}" --seconds 2 --workspace-scale 2 >/dev/null
drop
(cd "$work" && python3 - way.servo <<'PY') || fail "the scaled way"
from way import *
near(way[0], 30, 12)
assert max(abs(a - b) for a, b in zip(tip[0], eval(open("begin").read()))) < 1e-6, "it begins elsewhere"
PY
feed 5
"${pad[@]}" --seconds 2 --clutch-button 1 >/dev/null
drop
(cd "$work" && python3 - way.servo <<'PY') || fail "the clutch"
from way import *
near(sum(map(abs, way)), 0, 1.5)
PY
# It is unplugged; what is no gamepad is refused; nobody has one.
feed 0
expect 74 'device lost' "${pad[@]}" --seconds 3
drop
expect 66 'is no gamepad' env TREPHINE_PAD=mouse "${pad[@]}" --seconds 1
expect 66 '[-]-gamepad: No such file' "${servo[@]}" --device gamepad --gamepad "$work/none" --seconds 1
[[ -e /dev/input ]] || expect 66 'no gamepad is there' "${servo[@]}" --device gamepad --seconds 1

# A 3D mouse: pushed away from the user and turned about the vertical axis, which moves the tool along -toward: away.
cat >"$work/feed.py" <<'PY'
import sys, time
def say(line): print(line, flush=True)
time.sleep(0.3)
say("b 1 1"); say("m 0 175 350 350 0 0")
time.sleep(0.5)
say("m 0 0 0 0 0 0"); say("b 1 0")
time.sleep(float(sys.argv[1]))
PY
mouse=(env "LD_LIBRARY_PATH=$(dirname "$SPNAV_STUB")" "TREPHINE_SPNAV=$work/pipe" "${servo[@]}" --device spacemouse)
feed 5
"${mouse[@]}" --seconds 2 >"$work/text" 2>&1 || { cat "$work/text"; fail "no session with a 3D mouse"; }
drop
(cd "$work" && python3 - way.servo <<'PY') || fail "the 3D mouse's way"
from way import *
import math
# The picture is seen from the front: away from the viewer is +y. Turned about the axis to the right, +x.
near(way[1], 15, 6); near(way[0], 0, 0.1); near(way[2] / way[1], 0.1975, 0.05)
angle = math.atan2(-axis[-1][1], axis[-1][2])
near(math.degrees(angle), 2 * way[1], 3)
assert buttons.count(2) > 300 and buttons[-1] == 0
at_rest()
PY
feed 0
expect 74 'device lost' "${mouse[@]}" --seconds 3
drop
expect 66 'spacenavd does not answer' env "LD_LIBRARY_PATH=$(dirname "$SPNAV_STUB")" "${servo[@]}" --device spacemouse --seconds 1
