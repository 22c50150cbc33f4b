#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A hand drills a hole into a case: what is said of it, the replay to the bit and to the volume's hash, and the case as it
# is afterwards.
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/sample" drill
servo=("$TREPHINE" servo "$work/sample" --no-paced)
hand=(--hole-diameter-mm 8 --approach-mm 4 --speed-mm-per-s 15 --tremor-mm 0)

"${servo[@]}" --tool ball --tool-diameter-mm 4 --drill "${hand[@]}" --seconds 40 --record "$work/hole.servo" \
  --json "$work/hole.json" >"$work/text" || { cat "$work/text"; fail "does not drill"; }
grep -Eq '^drilled for [0-9.]+ s, [0-9.]+ J, stalled ' "$work/text" || { cat "$work/text"; fail "does not say what it drilled"; }
grep -Eq '^through at [0-9.]+ s' "$work/text" || { cat "$work/text"; fail "it did not come through"; }
python3 - "$work/hole.json" "$work/hole.servo" <<'PY'
import json, math, sys
d = json.load(open(sys.argv[1]))["drilled"]
removed = d["removed_mm3"]
assert set(removed) == {"skull"}, removed
# A hole of 8 mm through 6 mm of bone, between that of the path and one with the ball's rounded floor.
assert 0.35 * math.pi * 16 * 6 < removed["skull"] < 1.6 * math.pi * 16 * 6, removed
assert d["breached"] and d["incisions"] == 1, d
# The inner table lies 8 mm from the middle, up to the balls' bumps of 4 %.
x, y, z = d["breach_mm"]
assert abs(math.dist((x, y, z), (1, -20, 300)) - 8 * 1.03) < 0.3 * 8 * 0.2 + 0.3, d["breach_mm"]
data = open(sys.argv[2], "rb").read()
header = json.loads(data[16:16 + 8192])
assert header["drilling"]["drill"] is True and header["outcome"]["volume_sha256"] == d["volume_sha256"], header
PY
"$TREPHINE" replay "$work/sample" "$work/hole.servo" >"$work/text" || { cat "$work/text"; fail "no replay"; }
grep -q '^the drilled volume is the same$' "$work/text" || fail "another volume"
grep -q '^replayed bit for bit$' "$work/text" || fail "not the same"

# A hand presses with what it says, and what it felt and how fast it went on is reported.
for press in 0.5 1; do
  "${servo[@]}" --tool ball --tool-diameter-mm 4 --drill "${hand[@]}" --seconds 10 --press-n $press --json "$work/$press.json" >"$work/text"
  grep -Eq '^while it cut: [0-9.]+ N felt, [0-9.]+ mm/s along its axis$' "$work/text" || { cat "$work/text"; fail "no feed"; }
  python3 -c '
import json, sys
press, d = float(sys.argv[1]), json.load(open(sys.argv[2]))["drilled"]
assert abs(d["force_felt_n"] / press - 1) < 0.25 and d["feed_mm_per_s"] > 1 and d["cutting_s"] > 0.1, d' $press "$work/$press.json" ||
    fail "pressed with another force than $press N"
done

# The case as it is at the end.
"$TREPHINE" check "$work/sample" --json >"$work/before.json"
"$TREPHINE" check "$work/sample" --after "$work/hole.servo" --out "$work/after" --json >"$work/after.json" || fail "no case"
python3 - "$work/before.json" "$work/after.json" "$work/after/case.json" <<'PY'
import json, sys
before, after, manifest = (json.load(open(f)) for f in sys.argv[1:])
assert after["case"] == "sample-drilled" and after["haptic"]["size"] == before["haptic"]["size"], after
assert "drilled.recording_sha256" in json.dumps(manifest), sorted(manifest)
# The hole is told of, so that a lesson does not score it.
(hole,) = [h for h in manifest["burr_holes"] if h["name"] == "drilled_1"]
assert hole["cut"] == ["skull"] and 7 < hole["diameter_mm"] < 10, hole
assert 3 < hole["figures"]["bone_thickness_mm"] < 9, hole
PY
"$TREPHINE" servo "$work/after" --seconds 0.2 --no-paced --approach-mm 1 --radius-mm 1 >/dev/null || fail "the drilled case is not felt"
expect 65 'case_sha256: the recording is of another' "$TREPHINE" replay "$work/after" "$work/hole.servo"
expect 64 'given together' "$TREPHINE" check "$work/sample" --after "$work/hole.servo"

# A recording whose volume is said to be another. Its seal is taken off, or the seal would be refused first.
python3 - "$work/hole.servo" "$work/other.servo" <<'PY'
import json, sys
data = open(sys.argv[1], "rb").read()
header = json.loads(data[16:16 + 8192])
header["outcome"]["volume_sha256"] = "0" * 64
assert len(header.pop("seal_sha256")) == 64
open(sys.argv[2], "wb").write(data[:16] + json.dumps(header).encode().ljust(8192) + data[16 + 8192:])
PY
expect 80 'volume_sha256: the volume differs' "$TREPHINE" replay "$work/sample" "$work/other.servo"

expect 64 '[-]-drill: needs --tool burr' "${servo[@]}" --tool needle --drill --seconds 1
expect 64 '[-]-site: nowhere: the case has no such place, but nasion, kocher_right' \
  "${servo[@]}" --tool ball --drill --site nowhere --seconds 1
expect 64 '[-]-hand-task: drill needs --drill' "${servo[@]}" --hand-task drill --seconds 1
[[ -z $(ls -A "$work" | grep trephine-tmp || true) ]] || fail "temporaries are left"
