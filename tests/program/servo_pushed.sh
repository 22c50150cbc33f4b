#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Devices that are pushed: a gamepad (a pipe, with a stub for what the kernel answers) and a 3D mouse (a stub for libspnav).
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/sample" drill
mkfifo "$work/pipe"
# A busy machine may stand still for a second, which else ends all force.
servo=("$TREPHINE" servo "$work/sample" --no-realtime --max-step-s 3600 --record "$work/way.servo")
feeder= session=
trap 'for p in $feeder $session; do kill -KILL $p 2>/dev/null || true; done; rm -rf "$work"' EXIT
# feed [PID]: pushes for 500 ticks, which are counted in the recording that is being made, and lets go; then it ends that process
# and holds the pipe open, or without one it goes.
feed() { python3 "$work/feed.py" "$work" "$@" >"$work/pipe" & feeder=$!; }
drop() { kill $feeder 2>/dev/null || true; wait $feeder 2>/dev/null || true; feeder=; }
# pushed COMMAND...: a session that is fed, and ended by Ctrl-C afterwards.
pushed() {
  local code=0
  "$@" --seconds 600 >"$work/text" 2>&1 &
  session=$!
  feed $session
  wait $session || code=$?
  session=
  drop
  [[ $code == 130 ]] || { cat "$work/text"; fail "the session ended with $code: $*"; }
}
cat >"$work/ticks.py" <<'PY'
import glob, os, signal, sys, time
def ticks():
    sizes = [os.path.getsize(f) for f in glob.glob(sys.argv[1] + "/.trephine-tmp-*")]
    return max([0] + [(s - 16 - 8192) // 216 for s in sizes])
def after(count):
    until = ticks() + count
    while ticks() < until: time.sleep(0.01)
def end():
    if len(sys.argv) < 3: return
    os.kill(int(sys.argv[2]), signal.SIGINT)
    time.sleep(3600)
PY
cat >"$work/way.py" <<'PY'
import struct, sys
frames = list(struct.iter_unpack("<Q17dI4i3I40x", open(sys.argv[1], "rb").read()[16 + 8192:]))
tip = [(f[3], f[4], f[5]) for f in frames]
axis = [(f[6], f[7], f[8]) for f in frames]
buttons = [f[18] for f in frames]
way = [b - a for a, b in zip(tip[0], tip[-1])]
# How long it was pushed: a device that is not read for a while counts a tenth of a second of that.
def pushed_s(button): return sum(min(f[2], 0.1) for f in frames if f[18] == button)
def near(value, wanted, room): assert abs(value - wanted) < room, (value, wanted, way, axis[-1])
def at_rest(): near(sum(abs(b - a) for a, b in zip(tip[-100], tip[-1])), 0, 0.02)
PY

# The left stick to the right and a little down, with button A; the right stick to the right; then let go.
cat >"$work/feed.py" <<'PY'
import struct, sys
from ticks import *
def event(kind, code, value): sys.stdout.buffer.write(struct.pack("llHHi", 0, 0, kind, code, value))
def report():
    event(0, 0, 0)
    sys.stdout.buffer.flush()
after(300)
event(3, 0, 32767); event(3, 1, 16384); event(3, 3, 32767); event(1, 0x130, 1); report()
after(500)
event(3, 0, 0); event(3, 1, 0); event(3, 3, 0); event(1, 0x130, 0); report()
after(400)
end()
PY
pad=(env "LD_PRELOAD=$PAD_STUB" "${servo[@]}" --device gamepad --gamepad "$work/pipe")
pushed "${pad[@]}"
grep -q '^holding Stub Pad' "$work/text" || { cat "$work/text"; fail "does not say what it holds"; }
# 30 mm/s and 60 degrees/s at the end of the way; half of the way is a fifth of the speed.
(cd "$work" && python3 - way.servo <<'PY') || fail "the gamepad's way"
from way import *
near(way[0] / pushed_s(1), 30, 2); near(way[2] / way[0], -0.5 * 0.1975 / 0.5, 0.05); near(way[1], 0, 0.1)
# Tilted to the right, about the picture's vertical axis: the tool points down here, so it keeps its direction.
near(axis[-1][2], 1, 1e-6)
open("begin", "w").write(repr(tip[0]))
assert buttons.count(1) > 400 and buttons[-1] == 0, buttons.count(1)
at_rest()
PY
"$TREPHINE" replay "$work/sample" "$work/way.servo" | grep -q '^replayed bit for bit$' || fail "its recording does not replay"
# Twice the workspace: twice the way. The clutch (button 1 here) rests the tool.
pushed "${pad[@]}" --workspace-scale 2
(cd "$work" && python3 - way.servo <<'PY') || fail "the scaled way"
from way import *
near(way[0] / pushed_s(1), 60, 4)
assert max(abs(a - b) for a, b in zip(tip[0], eval(open("begin").read()))) < 1e-6, "it begins elsewhere"
PY
pushed "${pad[@]}" --clutch-button 1
(cd "$work" && python3 - way.servo <<'PY') || fail "the clutch"
from way import *
near(sum(map(abs, way)), 0, 1.5)
PY
# It is unplugged; what is no gamepad is refused; nobody has one.
feed
expect 74 'device lost' "${pad[@]}" --seconds 5
drop
expect 66 'is no gamepad' env TREPHINE_PAD=mouse "${pad[@]}"
expect 66 '[-]-gamepad: No such file' "${servo[@]}" --device gamepad --gamepad "$work/none"
[[ -e /dev/input ]] || expect 66 'no gamepad is there' "${servo[@]}" --device gamepad

# A 3D mouse: pushed away from the user and turned about the vertical axis, which moves the tool along -toward: away.
cat >"$work/feed.py" <<'PY'
from ticks import *
def say(line): print(line, flush=True)
after(300)
say("b 1 1"); say("m 0 175 350 350 0 0")
after(500)
say("m 0 0 0 0 0 0"); say("b 1 0")
after(400)
end()
PY
mouse=(env "LD_LIBRARY_PATH=$(dirname "$SPNAV_STUB")" "TREPHINE_SPNAV=$work/pipe" "${servo[@]}" --device spacemouse)
pushed "${mouse[@]}"
(cd "$work" && python3 - way.servo <<'PY') || fail "the 3D mouse's way"
from way import *
import math
# The picture is seen from the front: away from the viewer is +y. Turned about the axis to the right, +x.
near(way[1] / pushed_s(2), 30, 2); near(way[0], 0, 0.1); near(way[2] / way[1], 0.1975, 0.05)
angle = math.atan2(-axis[-1][1], axis[-1][2])
near(math.degrees(angle), 2 * way[1], 3)
assert buttons.count(2) > 400 and buttons[-1] == 0
at_rest()
PY
feed
expect 74 'device lost' "${mouse[@]}" --seconds 5
drop
expect 66 'spacenavd does not answer' env "LD_LIBRARY_PATH=$(dirname "$SPNAV_STUB")" "${servo[@]}" --device spacemouse
