#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The experiments of chapter 4 on a small case: tables, figures and a page; what is refused; the same forces twice.
. "$(dirname "$0")/common.sh"
: "${WRITE_CASE:?}" "${PEER_STUB:?}"
"$WRITE_CASE" "$work/case" play
small=("$TREPHINE" compare "$work/case" --triangles 5000,20000 --servo-ticks 300 --client-pictures 1 --repetitions 2
  --hand-seconds 3 --pokes 10 --radius-mm 4 --speed-mm-per-s 40)
"${small[@]}" --out "$work/out" --peer "$PEER_STUB" >"$work/text" || { cat "$work/text"; fail "it does not run"; }

# The tables, each with a row of every algorithm.
for table in servo forces client falls; do
  for algorithm in ours stepped scalar_surface god_object god_object_lifted ruspini depth_buffer feedback_buffer tangent_planes plane_stub; do
    grep -q "^$algorithm," "$work/out/$table.csv" || fail "$table.csv has no $algorithm"
  done
done
[ "$(wc -l <"$work/out/meshes.csv")" = 3 ] || fail "not two meshes: $(cat "$work/out/meshes.csv")"
[ "$(grep -c '^ruspini,' "$work/out/servo.csv")" = 2 ] || fail "not a servo time for each mesh"
head -1 "$work/out/forces.csv" | grep -q 'anomaly_ratio,zero_force_ratio,most_step_n,sigma_n_per_s,mean_lag_mm' ||
  fail "the coefficient stands alone"
grep -q '^ours,plate of 0.5 mm,1,10,0$' "$work/out/falls.csv" || fail "ours falls: $(grep ^ours "$work/out/falls.csv")"

# The page says what was measured, and what was not; and of each algorithm what speaks against it.
grep -q '^| Trephine | none observed |$' "$work/out/compare.md" || fail "issues of ours: $(grep '^| Trephine ' "$work/out/compare.md")"
grep -q '^| scalar surface (VHTK) | .*thin walls are poked through ([0-9]* of 60)' "$work/out/compare.md" || fail "no issues by algorithm"
grep -q 'The peers are historical: .* CHAI3D itself is not among them here' "$work/out/compare.md" || fail "the peers' age"
grep -q 'IR gives smooth forces in all cases.*too few hands to decide' "$work/out/compare.md" || fail "few hands settle what is rare"
grep -q 'CHAI3D takes more than 1 ms .*not measured' "$work/out/compare.md" || fail "CHAI3D is claimed"
grep -Eq '^(holds|does not hold): A step of at most' "$work/text" || fail "the verdicts are not printed"
python3 - "$work/out/compare.json" <<'PY' || fail "compare.json is wrong"
import json, sys
c = json.load(open(sys.argv[1]))
assert c["trephine_compare"] == 1 and len(c["algorithms"]) == 10 and len(c["meshes"]) == 2
assert {f["loop"] for f in c["forces"]} == {"open", "closed"}
ours = [f for f in c["forces"] if f["algorithm"] == "ours"]
# They begin half a second after the first contact, not with the approach.
assert all(500 < f["judged_frames"] < 2500 and f["falls"] == 0 for f in ours), ours
assert all(f["mean_force_n"] > 0.05 and f["sigma_n_per_s"] > 0 for f in ours), ours
PY
if command -v gnuplot >/dev/null; then
  for figure in servo_polygons servo_voxels anomalies client_haptics; do
    for ending in png svg; do [ -s "$work/out/$figure.$ending" ] || fail "$figure.$ending is missing"; done
    grep -q "($figure.png)" "$work/out/compare.md" || fail "the page does not show $figure"
  done
else
  [ -z "${TREPHINE_CHECK:-}" ] || fail "gnuplot is not installed"
fi
[ -z "$(find "$work/out" -name '.*' -type f)" ] || fail "something is left behind: $(ls -A "$work/out")"

# Forces, falls and meshes are the same at each run, whatever the threads; one algorithm alone gives the same.
"${small[@]}" --out "$work/again" --no-graphics --threads 1 --algorithm god_object >/dev/null
for table in forces falls; do
  cmp <(grep '^god_object,' "$work/out/$table.csv") <(grep '^god_object,' "$work/again/$table.csv") ||
    fail "$table.csv differs from run to run"
done
cmp "$work/out/meshes.csv" "$work/again/meshes.csv" || fail "the meshes differ from run to run"
! grep -q ruspini "$work/again/servo.csv" || fail "--algorithm is not heeded"
grep -q 'Nothing was drawn: --no-graphics' "$work/again/compare.md" || fail "what was not drawn is not said"

# Poses of a recording, in the open loop.
"$TREPHINE" servo "$work/case" --device hand --radius-mm 4 --no-paced --seconds 2 --record "$work/poses.servo" >/dev/null
"${small[@]}" --out "$work/recorded" --no-graphics --algorithm stepped --recording "$work/poses.servo" >/dev/null
grep -q '^ours,0,open,' "$work/recorded/forces.csv" || fail "the recording is not used"

expect 64 'must ascend' "$TREPHINE" compare "$work/case" --out "$work/x" --triangles 5000,400
expect 64 'there is no chai3d, but ours, ' "$TREPHINE" compare "$work/case" --out "$work/x" --algorithm chai3d
expect 65 'is no library that can be loaded' "$TREPHINE" compare "$work/case" --out "$work/x" --peer "$work/text"
expect 64 'has none of that name' "$TREPHINE" compare "$work/case" --out "$work/x" --shape nothing
[ ! -e "$work/x/compare.md" ] || fail "a refusal leaves a page"
