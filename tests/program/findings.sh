#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What of a head a person should look at is told by a run, drawn, and kept in the case: of a head with blood beside its brain and a
# shunt, and of a healthy one, which has nothing. What concerns the ventricles makes the class uncertain.
. "$(dirname "$0")/common.sh"
cd "$work"
"$TREPHINE" phantom hurt --level hard --variant normal --seed 5 --blood subdural --shunt --noise-hu 8 --slice-step-mm 2 \
  --slice-thickness-mm 2 --slices-count 92 --mesh-step-mm 0 --columns-count 128 --rows-count 128 --field-of-view-mm 240 \
  --subvoxel-mm 1.5 --no-labels --quiet
run() {
  "$TREPHINE" run "$SOURCE/configs/$1.yaml" --series "$2" --out lib --case "$3" --no-page --quiet --set "haptic.spacing_mm=[3,3,3]" \
    "${@:4}" >"said.$3" 2>&1 || { cat "said.$3" >&2; fail "$3 was not made"; }
}
run ct_head hurt/dicom hurt
grep -Eq 'findings: to be looked at: [0-9]+ ml as dense as fresh blood .* beside the brain' said.hurt || {
  cat said.hurt >&2; fail "the blood is not told"; }
python3 - lib/hurt hurt/truth/truth.json <<'PY'
import json, math, os, sys
case = json.load(open(sys.argv[1] + "/case.json"))
sure = {f["kind"]: f for f in case["findings"] if f["confidence"] >= 0.5}
assert {"dense_tissue", "tube"} <= set(sure), sure
assert 20 < sure["dense_tissue"]["figures"]["volume_ml"] < 60 and sure["dense_tissue"]["concerns"] == ["brain"], sure
assert sure["tube"]["concerns"] == ["ventricles"] and case["figures"]["class"] == "uncertain", (sure, case["figures"]["class"])
verdict = case["figures"]["verdict"]
doubtful = [p for p in verdict.split("; ") if p.endswith(": doubtful")]
assert verdict.startswith("to be looked at first: ") and "; to be looked at: " in verdict, verdict
assert len(doubtful) == 1 and {"brain", "ventricles"} <= set(doubtful[0].split(":")[0].split(", ")), verdict
assert os.path.getsize(sys.argv[1] + "/report/findings.png") > 10000
PY
"$TREPHINE" library verify lib >said.verify 2>&1 || { cat said.verify >&2; fail "the case is not sound"; }

# A healthy head, once more with the finding's limits below it: then the same case has something to be looked at.
run sample "$SOURCE/sample_dicom" sound "${coarse[@]}"
[[ ! -e lib/sound/report/findings.png ]] && ! grep -q 'to be looked at' said.sound lib/sound/case.json || {
  cat said.sound >&2; fail "a healthy head has findings"; }
run sample "$SOURCE/sample_dicom" sound "${coarse[@]}" --set findings.wide_evans_ratio=0.1
grep -q '"kind": *"wide_ventricles"' lib/sound/case.json && [[ -e lib/sound/report/findings.png ]] || fail "wide ventricles are not told"
