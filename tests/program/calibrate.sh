#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The simulated hand is measured: what is known of it comes out, and the settings are those that play reads.
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/sample" play
still=(--no-in-real-time --workspace-s 2 --radius-mm 0 --tremor-mm 0 --arm-damping-n-s-per-mm 0.001)
stiffest() {  # stiffest DAMPING: the stiffest stable wall with a device of that damping
  "$TREPHINE" calibrate "$work/sample" "${still[@]}" --device-damping-n-s-per-mm "$1" --json "$work/$1.json" \
    --write-settings "$work/settings.json" >"$work/text" || { cat "$work/text"; fail "no calibration"; }
}
stiffest 0.001; stiffest 0.002
python3 - "$work" <<'PY'
import json, sys
one, two = (json.load(open(f"{sys.argv[1]}/{b}.json")) for b in ("0.001", "0.002"))
# A spring of k against damping b (the arm's 0.001 and the device's) and a period T is stable below 2 b / T: 4 and 6 N/mm.
for found, limit in ((one, 4), (two, 6)):
    assert found["stable_n_per_mm"] < 1.15 * limit and found["stable_n_per_mm"] > 0.7 * limit, found
    assert found["unstable_n_per_mm"] > found["stable_n_per_mm"], found
    assert found["poses_hz"] == 1000 and found["case_n_per_mm"] == 0.8, found
    assert 0 <= found["latency_ms"] < 3, found
settings = json.load(open(f"{sys.argv[1]}/settings.json"))
low, high = two["workspace_mm"]
for axis, centre in enumerate((1, -20, 300)):
    assert abs((low[axis] + high[axis]) / 2 + settings["workspace_offset_mm"][axis] - centre) < 1e-6, settings
PY
expect 64 'last_stiffness_n_per_mm' "$TREPHINE" calibrate "$work/sample" --first-stiffness-n-per-mm 3 --last-stiffness-n-per-mm 1

# A device is registered to a screen by marks that a recorded hand touches, and play refuses what is no registration.
python3 - "$work" <<'PY'
import math, sys
width, height = 520, 320
marks = [(-.4, .4, 0), (.4, .4, 0), (.4, -.4, 0), (-.4, -.4, 0), (0, 0, 0)]
places = [(x * width, y * height, z) for x, y, z in marks] + [(10, 0, 90)]
c, s = math.cos(1.9), math.sin(1.9)
def device(p, error=0):  # turned about y, and elsewhere
    return c * p[0] + s * p[2] + 300 + error, p[1] - 40, -s * p[0] + c * p[2] + 120
for name, error in (("touched", 0), ("beside", 14)):
    with open(f"{sys.argv[1]}/{name}.txt", "w") as out:
        t = 0
        for n, place in enumerate(places):
            for button in (0, 1):
                for _ in range(60):
                    print(f"{t:.3f}", *device(place, error if n == 1 else 0), "0 0 1", button, file=out)
                    t += 0.01
PY
touch_marks() { "$TREPHINE" register "$work/sample" --device trajectory --trajectory "$work/$1.txt" --no-in-real-time \
  --screen-width-mm 520 --screen-height-mm 320 --out "$work/$1.json"; }
touch_marks touched >"$work/text" || fail "no registration"
grep -q '5 marks, RMS 0.00 mm' "$work/text" || { cat "$work/text"; fail "another residual"; }
expect 80 'upper right' touch_marks beside
[ ! -e "$work/beside.json" ] || fail "a refused registration was written"
python3 - "$work/touched.json" <<'PY'
import json, math, sys
r = json.load(open(sys.argv[1]))
back = lambda d: [sum(r["turn"][k][a] * d[k] for k in range(3)) * r["scale"] + r["offset_mm"][a] for a in range(3)]
c, s = math.cos(1.9), math.sin(1.9)
p = (30, -50, 70)
at = back((c * p[0] + s * p[2] + 300, p[1] - 40, -s * p[0] + c * p[2] + 120))
assert max(abs(a - b) for a, b in zip(at, p)) < 1e-6 and r["height_mm"] == 320, (at, r)
PY
"$TREPHINE" register "$work/sample" --screen-width-mm 520 --screen-height-mm 320 --mirror up_down --sheet "$work/marks.html" \
  >"$work/text" || fail "no sheet"
grep -q 'scaleY(-1)' "$work/marks.html" || fail "the sheet is not mirrored"
expect 64 'screen-width-mm' "$TREPHINE" register "$work/sample" --out "$work/none.json"

# The registration alone says where the tool is: what else would move it is refused, from the settings file too, before a window opens.
for moved in 'workspace_scale 2' 'workspace_offset_mm 0,0,5' 'clutch_button 2'; do
  set -- $moved
  expect 64 "--screen, $1: do not go together" "$TREPHINE" play "$work/sample" --device hand --screen "$work/touched.json" \
    "--${1//_/-}" "${@:2}"
done
expect 64 '[-]-screen, workspace_offset_mm: do not go together' "$TREPHINE" play "$work/sample" --device hand \
  --screen "$work/touched.json" --settings "$work/settings.json"
