#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A plate that is touched as a mesh beside the haptic volume: pokes stop at it with the force of its spring, a burr is held and does not cut it,
# the session says so, and its recording replays bit for bit.
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/case" plate
servo=("$TREPHINE" servo "$work/case" --no-paced --max-step-s 3600 --ramp-s 0 --device trajectory)
"$TREPHINE" check "$work/case" >"$work/text" || { cat "$work/text"; fail "check"; }
grep -q 'plate is touched as a mesh, on both sides as material metal: .*stiffness_n_per_mm 1.5' "$work/text" || { cat "$work/text"; fail "check"; }

# The plate lies from z = 315 to 316 mm above the bone. A point pokes it at 400 mm/s, 50 mm/s and from below.
for path in '0 2 -19 330\n0.04 2 -19 314.5\n1 2 -19 314.5' '0 3 -20 317\n0.05 3 -20 314.5\n1 3 -20 314.5'; do
  printf "$path\n" >"$work/path.txt"
  "${servo[@]}" --trajectory "$work/path.txt" --seconds 1 --record "$work/poke.servo" --json "$work/poke.json" >"$work/text" || { cat "$work/text"; fail "poke"; }
  grep -q 'cut' "$work/text" && fail "speaks of cutting where nothing drills"
  python3 - "$work/poke.servo" <<'PY'
import json, math, struct, sys
data = open(sys.argv[1], "rb").read()
length = struct.unpack_from("<I", data, 12)[0]
frames = list(struct.iter_unpack("<Q17dI4i3I40x", data[16 + length:]))
assert len(frames) == 1000
assert min(f[11] for f in frames) > 315.999, min(f[11] for f in frames)  # the tool as it is shown never enters
last = frames[-1]
assert last[19] == 33 and last[20] == 1 and last[22] == 1, last[19:24]  # the first surface, its front, alone
force = math.dist(last[15:18], (0, 0, 0))
assert abs(force - 1.5 * 1.5) < 0.02 * 1.5 * 1.5 and last[17] > 0.999 * force, last[15:18]
PY
  "$TREPHINE" replay "$work/case" "$work/poke.servo" | grep -q '^replayed bit for bit$' || fail "no replay"
done

# A burr with its pedal down is held by the plate; beside it, it drills the bone.
drill() {  # X
  printf '0 %s -20 325 0 0 1 0\n0.3 %s -20 315 0 0 1 1\n2 %s -20 306 0 0 1 1\n2.2 %s -20 325 0 0 1 0\n' $1 $1 $1 $1 >"$work/path.txt"
  "${servo[@]}" --tool ball --tool-diameter-mm 4 --drill --trajectory "$work/path.txt" --seconds 2.2 --record "$work/burr.servo" \
    --json "$work/burr.json" >"$work/text" || { cat "$work/text"; fail "drill at $1"; }
  grep -q '^plate is touched as a surface beside the volume: a drill is held by it and does not cut it$' "$work/text" || { cat "$work/text"; fail "does not say that metal is not cut"; }
  "$TREPHINE" replay "$work/case" "$work/burr.servo" >"$work/text"
  grep -q '^replayed bit for bit$' "$work/text" && grep -q '^the drilled volume is the same$' "$work/text" || { cat "$work/text"; fail "no replay of the drill"; }
}
drill 1
python3 - "$work/burr.json" <<'PY'
import json, sys
d = json.load(open(sys.argv[1]))["drilled"]
assert d["removed_mm3"].get("skull", 0) == 0 and d["most_force_n"]["plate"] > 1, d
PY
drill 11.5
python3 - "$work/burr.json" <<'PY'
import json, sys
d = json.load(open(sys.argv[1]))["drilled"]
assert d["removed_mm3"]["skull"] > 1, d
PY

# It can be felt alone, and what is not there is named.
"${servo[@]}" --shape plate --trajectory "$work/path.txt" --seconds 1 >"$work/text" || fail "the plate alone"
expect 64 'shape: the case has none of that name, but skull, brain, plate' "${servo[@]}" --shape screw --trajectory "$work/path.txt" --seconds 1
expect 64 'plate is felt as a mesh, and the algorithms are compared in the haptic volume' "$TREPHINE" compare "$work/case" --shape plate --out "$work/compare"
echo ok
