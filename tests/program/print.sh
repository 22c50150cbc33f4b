#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A case as parts to be printed: what other programs say of each of them, that a slicer slices them as they are, and what is
# refused. admesh and prusa-slicer are in packages-long.txt.
. "$(dirname "$0")/common.sh"
cd "$work"
"$TREPHINE" run "$SOURCE/configs/sample.yaml" --root "$SOURCE" --out library --no-page --quiet 2>warnings ||
  fail "the case: $(cat warnings)"
"$TREPHINE" export library/sample --format print --out printed --report report.json >said
parts=(skull insert-right insert-left ventricles base lid)
for part in "${parts[@]}"; do [[ -s printed/sample-$part.stl ]] || fail "no $part: $(ls printed)"; done
grep -q '^skull, base ' said && grep -q '^base, lid ' said || fail "gaps are not printed: $(cat said)"
python3 - report.json printed/sample-print.json library/sample/case.json <<'PY'
import hashlib, json, sys
report, record = (json.load(open(f)) for f in sys.argv[1:3])
assert record["case_sha256"] == hashlib.sha256(open(sys.argv[3], "rb").read()).hexdigest()
assert record["smallest_wall_mm"] >= record["wall_mm"] == 2, record["smallest_wall_mm"]
assert 0.15 < record["smallest_gap_mm"] < 0.5, record["smallest_gap_mm"]
assert report["smallest_wall_mm"] == record["smallest_wall_mm"]
assert len(record["marks"]) >= 5 and record["targets"], record
rows = record["case_to_print"]
for m in record["marks"]:
    at = [sum(rows[4 * a + k] * m["case_mm"][k] for k in range(3)) + rows[4 * a + 3] for a in range(3)]
    assert max(abs(x - y) for x, y in zip(at, m["at_mm"])) < 1e-6, m
PY
if grep -rlE 'PHANTOM|TREPHINE\^|1\.2\.826|/(tmp|work|home)/' printed/sample-print.json; then fail "something of the patient or the place"; fi

for tool in admesh prusa-slicer; do command -v $tool >/dev/null || skip "no $tool"; done
for part in "${parts[@]}"; do
  admesh printed/sample-$part.stl >mended 2>&1 || fail "admesh: $part"
  for what in 'Degenerate facets' 'Edges fixed' 'Facets removed' 'Facets added' 'Facets reversed' 'Backwards edges'; do
    grep -Eq "^$what +: +0$" mended || fail "admesh mends $part: $(grep "^$what" mended)"
  done
  prusa-slicer --info printed/sample-$part.stl >info 2>/dev/null || fail "prusa-slicer: $part"
  grep -q '^manifold = yes' info && grep -q '^number_of_parts = *1$' info || fail "prusa-slicer of $part: $(cat info)"
  ! grep -Eq 'repaired|open_edges|facets_reversed|degenerate' info || fail "prusa-slicer mends $part: $(cat info)"
done
prusa-slicer --info printed/sample-print.3mf >info 2>/dev/null || fail "prusa-slicer: 3mf"
[[ $(grep -c '^manifold = yes' info) == "${#parts[@]}" ]] || fail "parts of the 3MF: $(cat info)"
for part in skull insert-right base; do
  prusa-slicer --export-gcode --layer-height 0.3 --support-material --bed-shape 0x0,400x0,400x400,0x400 --max-print-height 300 \
    --center 200,200 printed/sample-$part.stl --output $part.gcode >sliced 2>&1 || fail "not sliced: $part: $(tail -3 sliced)"
  [[ $(grep -c '^;LAYER_CHANGE' $part.gcode) -gt 20 ]] || fail "$part has no layers"
done

# Nothing is half written, and what cannot be made is said.
expect 64 'voxel_mm' "$TREPHINE" export library/sample --format print --out none --voxel-mm 1 --quiet
expect 64 'INPUT' "$TREPHINE" export printed/sample-lid.stl --format print --out none --quiet
expect 80 'insert' "$TREPHINE" export library/sample --format print --out none --cut-above-mm 55 --insert-mm 60 --quiet
[[ ! -e none ]] || fail "something was written"
