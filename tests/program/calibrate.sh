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
