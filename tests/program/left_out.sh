#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What a scene can do without is left out, of the stages or by the scene's limits: the run warns, case.json says why, and again from
# the cache it is the same case.
. "$(dirname "$0")/common.sh"
cd "$SOURCE"
library=$work/library
without=(--set sagittal_sinus.zone.sinus_depth_mm=1 --set sagittal_sinus.zone.sinus_half_width_mm=1
         --set scene.anatomies.dura.max_triangles=40 --set dura.decimate.max_deviation_mm=0.01)
for again in 1 2; do
  "$TREPHINE" run configs/sample.yaml --series sample_dicom --out "$library" --case c --quiet "${coarse[@]}" "${without[@]}" \
    --set "haptic.spacing_mm=[2,2,2]" --no-pictures --no-page \
    >/dev/null 2>"$work/said" || { cat "$work/said" >&2; fail "an anatomy that may be missing ended the run"; }
  for name in sagittal_sinus dura; do grep -q "$name: left out: " "$work/said" || { cat "$work/said" >&2; fail "no word of $name"; }; done
  sha256sum "$library/c/case.json" >>"$work/sums"
done
[[ $(sort -u "$work/sums" | wc -l) == 1 ]] || fail "from the cache it is another case"
"$TREPHINE" library show "$library" c >"$work/shown"
grep -Eq '^ +dura +is missing: ' "$work/shown" || { cat "$work/shown" >&2; fail "library show does not say it"; }
python3 - "$library/c/case.json" <<'PY'
import json, sys
case = json.load(open(sys.argv[1]))
assert [m["anatomy"] for m in case["missing"]] == ["sagittal_sinus", "dura"] and all(m["why"] for m in case["missing"]), case["missing"]
assert not {"sagittal_sinus", "dura"} & {a["name"] for a in case["anatomies"]}
assert "dura" not in [s["name"] for s in case["haptic"]["shapes"]] and "brainstem" in [a["name"] for a in case["anatomies"]]
PY
