#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A second run takes everything from the cache and gives the same case; a damaged cache is as good as none; Ctrl-C and
# kill -9 leave the old case and no temporary file after the next run; one parameter recomputes only what depends on it.
. "$(dirname "$0")/common.sh"
# LONG=1: all of the sample head; else its skin and skull on very coarse voxels, for it is made ten times.
config=$SOURCE/configs/sample_drilled.yaml
coarse=(--set "haptic.spacing_mm=[1.6,1.6,1.6]")
seen=(skin.segment skull.decimate brain.decimate skull.measure burr_hole_1 skull.boolean haptic.voxelize haptic.mismatch)
changed=ventricles
if ((LONG == 0)); then
  config=$work/c.yaml
  coarse=(--set "haptic.spacing_mm=[3,3,3]")
  cp -r "$SOURCE/sample_dicom" "$SOURCE/configs/materials.yaml" "$SOURCE/pipelines/ventriculostomy.yaml" "$work"
  cat >"$config" <<Y
trephine: 1
case: sample-drilled
series: sample_dicom
pipeline: ventriculostomy.yaml
scene: s.yaml
burr_holes: [{at: position, position_mm: [-25, -38, 116]}]
set: {resample.spacing_mm: [4, 4, 4]}
Y
  cat >"$work/s.yaml" <<Y
trephine: 1
anatomies: {skin: , skull: }
burr_holes: {skull: }
face: {policy: keep, reason: synthetic}
materials: materials.yaml
haptic: {shapes: {skull: {material: bone}, skin: {material: skin}}}
Y
  seen=(skin.segment skull.decimate skull.measure burr_hole_1 skull.boolean haptic.voxelize haptic.mismatch)
  changed=skin
fi
out=$work/out

"$TREPHINE" run "$config" "${coarse[@]}" --out "$out" --quiet --json "$work/first.json"
first=$(case_digest "$out/sample-drilled")
"$TREPHINE" run "$config" "${coarse[@]}" --out "$out" --quiet --json "$work/second.json"
[[ $first == "$(case_digest "$out/sample-drilled")" ]] || fail "a rerun changed the case"
# What is computed again is only what the cache did not keep: what took no longer than reading it would, which is the machine's affair.
python3 - "$work/first.json" "$work/second.json" "${seen[@]}" <<'PY'
import json, sys
first, second = (json.load(open(f))["stages"] for f in sys.argv[1:3])
for name in sys.argv[3:]:
    assert first[name]["state"] == "computed", name
    assert second[name]["report"] == first[name]["report"], name
assert any(first[name]["kept"] for name in sys.argv[3:])
again = [n for n, s in second.items() if s["state"] == "computed"]
assert not any(first[n]["kept"] for n in again), again
PY

# A parameter of one anatomy.
"$TREPHINE" run "$config" "${coarse[@]}" --out "$out" --quiet --json "$work/third.json" --set $changed.smooth.iterations_count=5
[[ $first != "$(case_digest "$out/sample-drilled")" ]] || fail "a changed parameter changed nothing"
python3 - "$work/first.json" "$work/second.json" "$work/third.json" "$changed" <<'PY'
import json, sys
changed = sys.argv[4]
first, second, third = (json.load(open(f))["stages"] for f in sys.argv[1:4])
kept = {n for n in first if (second if second[n]["state"] == "computed" else first)[n]["kept"]}
computed = {n for n, s in third.items() if s["state"] == "computed"}
assert f"{changed}.smooth" in computed
others = {n for n in computed & kept if not n.startswith(changed + ".") and n != "haptic.mismatch"}
assert not others, others
PY

# Bytes of every cached file flipped.
for f in "$out"/.trephine-cache/*; do printf '\377' | dd of="$f" bs=1 seek=100 conv=notrunc status=none; done
"$TREPHINE" run "$config" "${coarse[@]}" --out "$out" --quiet
[[ $first == "$(case_digest "$out/sample-drilled")" ]] || fail "a damaged cache changed the case"

# Stopped at several moments, once by Ctrl-C and otherwise by kill -9: the old case is there, whole.
stopped=("$TREPHINE" run "$config" "${coarse[@]}" --out "$out" --quiet --no-use-cache --set skin.smooth.iterations_count=7)
interrupted "${stopped[@]}"
[[ $code == 130 ]] || fail "Ctrl-C ended with $code"
[[ $first == "$(case_digest "$out/sample-drilled")" ]] || fail "Ctrl-C tore the case"
find "$out" -name '.trephine-tmp-*' | grep . && fail "Ctrl-C left a temporary file"
delays=(0.3)
((LONG)) && delays=(0.1 0.3 1.5)
for delay in "${delays[@]}"; do
  "${stopped[@]}" 2>/dev/null &
  pid=$!
  sleep "$delay"
  kill -KILL "$pid" 2>/dev/null || true
  wait "$pid" || true
  # On a fast machine the run may have been done.
  now=$(case_digest "$out/sample-drilled") || fail "kill -KILL after $delay s tore the case"
  [[ $first == "$now" ]] || "$TREPHINE" run "$config" "${coarse[@]}" --out "$out" --quiet
  [[ $first == "$(case_digest "$out/sample-drilled")" ]] || fail "kill -KILL after $delay s: another case"
done
"$TREPHINE" run "$config" "${coarse[@]}" --out "$out" --quiet
find "$out" -name '.trephine-tmp-*' | grep . && fail "temporary files are left"

# A first run that is stopped leaves no folder that looks like a case.
interrupted "$TREPHINE" run "$config" "${coarse[@]}" --out "$work/new" --quiet --no-use-cache
[[ $code == 130 && ! -e $work/new/sample-drilled ]] || fail "Ctrl-C ($code) left a case's folder"

# Two at once: one works, the other is told so.
"$TREPHINE" run "$config" "${coarse[@]}" --out "$out" --quiet --no-use-cache &
pid=$!
for _ in {1..3000}; do
  [[ $(readlink /proc/$pid/fd/* 2>/dev/null) != *"/.lock"* ]] || break
  sleep 0.01
done
kill -STOP $pid  # so that it is not done before the other one asks
expect 75 'trephine run: sample-drilled: .*another run' "$TREPHINE" run "$config" "${coarse[@]}" --out "$out" --quiet --no-use-cache
kill -CONT $pid
wait $pid
[[ $first == "$(case_digest "$out/sample-drilled")" ]] || fail "two at once tore the case"
echo ok
