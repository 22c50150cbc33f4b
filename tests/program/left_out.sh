#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What a scene can do without is left out, of the stages or by the scene's limits, or something simple stands for it: the run warns
# and ends with a verdict, case.json says why, and again from the cache it is the same case.
. "$(dirname "$0")/common.sh"
cd "$SOURCE"
library=$work/library
without=(--set sagittal_sinus.zone.sinus_depth_mm=1 --set sagittal_sinus.zone.sinus_half_width_mm=1
         --set scene.anatomies.dura.max_triangles=40 --set dura.decimate.max_deviation_mm=0.01
         --set scene.anatomies.brain.max_triangles=20000 --set brain.decimate.max_deviation_mm=0.05)
for again in 1 2; do
  "$TREPHINE" run configs/sample.yaml --series sample_dicom --out "$library" --case c --quiet "${coarse[@]}" "${without[@]}" \
    --set "haptic.spacing_mm=[2,2,2]" --no-pictures --no-page \
    >/dev/null 2>"$work/said" || { cat "$work/said" >&2; fail "an anatomy that may be missing ended the run"; }
  for name in sagittal_sinus dura; do grep -q "$name: left out: " "$work/said" || { cat "$work/said" >&2; fail "no word of $name"; }; done
  # A brain with too many triangles within what a person set is reduced within what the scene allows, before a simple one stands for it.
  grep -q '^warning: c: brain: reduced within 1.4 mm, not 0.05, to have at most 20000 triangles$' "$work/said" &&
    ! grep -q 'simple_brain' "$work/said" || { cat "$work/said" >&2; fail "the brain is not reduced further"; }
  sha256sum "$library/c/case.json" >>"$work/sums"
done
[[ $(sort -u "$work/sums" | wc -l) == 1 ]] || fail "from the cache it is another case"
"$TREPHINE" library show "$library" c >"$work/shown"
grep -Eq '^ +dura +is missing: ' "$work/shown" || { cat "$work/shown" >&2; fail "library show does not say it"; }
python3 - "$library/c/case.json" <<'PY'
import json, sys
case = json.load(open(sys.argv[1]))
assert [m["anatomy"] for m in case["missing"]] == ["dura", "sagittal_sinus"] and all(m["why"] for m in case["missing"]), case["missing"]
assert not {"sagittal_sinus", "dura"} & {a["name"] for a in case["anatomies"]}
assert "dura" not in [s["name"] for s in case["haptic"]["shapes"]] and "brainstem" in [a["name"] for a in case["anatomies"]]
PY

# A scan that shows no brain beyond its noise, here one whose brain is asked for where there is none: a smooth one stands for it, and
# what is made of it goes. A check that finds fault with the ventricles leaves them out, in the second run as in the first.
run=("$TREPHINE" run configs/sample.yaml --series sample_dicom --out "$library" --case d "${coarse[@]}" --set "haptic.spacing_mm=[2,2,2]"
     --no-pictures --no-page)
no_brain=(--set brain.brain.lower_hu=3000) no_ventricles=(--set ventricles.ventricles.grow_mm=9)
"${run[@]}" "${no_brain[@]}" >"$work/said" 2>&1 || { cat "$work/said" >&2; fail "no brain ended the run"; }
grep -q '^skin, skull, .*: good; brain: simple; ventricles, third_ventricle: left out; on voxels of 2.5 x ' "$work/said" || {
  cat "$work/said" >&2; fail "no verdict"; }
"$TREPHINE" library show "$library" d >"$work/shown"
grep -Eq '^ +brain +is simple_brain: the mask is empty' "$work/shown" || { cat "$work/shown" >&2; fail "library show does not say it"; }
python3 - "$library/d/case.json" <<'PY'
import json, sys
case = json.load(open(sys.argv[1]))
assert [(s["anatomy"], s["by"]) for s in case["stand_ins"]] == [("brain", "simple_brain")], case["stand_ins"]
assert [m["anatomy"] for m in case["missing"]] == ["ventricles", "third_ventricle"], case["missing"]
(brain,) = [a for a in case["anatomies"] if a["name"] == "brain"]
(dura,) = [a for a in case["anatomies"] if a["name"] == "dura"]
assert 0.75 * dura["volume_ml"] < brain["volume_ml"] < 0.95 * dura["volume_ml"], (brain, dura)
felt = [s["name"] for s in case["haptic"]["shapes"]]
assert "brain" in felt and "ventricles" not in felt, felt
assert case["figures"]["class"] == "unknown" and "left out; on voxels" in case["figures"]["verdict"], case["figures"]
PY
if [[ ${SIM:-} ]]; then
  code=0; "$SIM" lesson "$library/d" --script examples/lessons/ventriculostomy.json --record "$work/l.lesson" >"$work/said" 2>&1 || code=$?
  [[ $code == 65 ]] && grep -q 'the lesson needs bone, brain and ventricles' "$work/said" || { cat "$work/said" >&2; fail "the lesson: $code"; }
fi

long_only

for again in 1 2; do
  "${run[@]}" "${no_ventricles[@]}" >"$work/said" 2>&1 || { cat "$work/said" >&2; fail "a check ended run $again"; }
  grep -q 'ventricles: left out: .* ml of the ventricles lie outside' "$work/said" || { cat "$work/said" >&2; fail "no word of it"; }
done
for what in no_brain no_ventricles; do
  declare -n set=$what
  code=0; "${run[@]}" "${set[@]}" --set scene.strict=true >"$work/said" 2>&1 || code=$?
  [[ $code == 80 ]] || { cat "$work/said" >&2; fail "strict: $code"; }
done
