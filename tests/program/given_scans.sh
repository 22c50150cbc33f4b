#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A second scan whose transform is given: what it is used for, what is refused of it (a transform that leads elsewhere, a face, another
# patient, a scan that is not what it is said to be), and where a fault is told.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/scans_common.sh"

# A transform that another program made takes the place of the registration. (What is made of the scan does not matter here:
# a recipe that takes no time.)
printf 'trephine: 1\nanatomies: {bone: {}}\nface: {policy: keep, reason: at 226 of an MR the bone is its skin}\n' >root/configs/bone_scene.yaml
printf 'trephine: 1\nanatomies: {bone: {shows_face: false, stages: [segment: {scan: mr}, contour, decimate, normals]}}\n' \
  >root/configs/bone_recipe.yaml
cp head/second/truth.tfm root/configs/
sed 's/register: .*/register: {given: truth.tfm}}/; s/case: .*/case: given/; s/scene: .*/scene: bone_scene.yaml/
  s/pipeline: .*/pipeline: bone_recipe.yaml/; /^set:/d' root/configs/both.yaml >root/configs/given.yaml
"$TREPHINE" run root/configs/given.yaml --series head/dicom --scan mr=head/second/scan.nrrd --out out --quiet --no-pictures --no-page \
  >said 2>&1 || fail "given: $(cat said)"
grep -q 'mr.register: the transform was given' said || fail "not said: $(cat said)"
grep -q '"mr.register.given": "sha256 ' out/given/case.json || fail "not recorded"
# One that leads out of the scan is refused.
sed 's/^Parameters: .*/Parameters: 1 0 0 0 1 0 0 0 1 0 0 400/' head/second/truth.tfm >root/configs/truth.tfm
refuses 80 'the registration is doubtful: 0.00 of the CT' "$TREPHINE" run root/configs/given.yaml --series head/dicom \
  --scan mr=head/second/scan.nrrd --out out2 --quiet --no-pictures --no-page

# The face of a further scan is not taken off, so its skin is not published.
sed 's/^anatomies:/&\n  mr_skin: {shows_face: false, stages: [segment: {scan: mr, lower_hu: 150, components: largest}, contour, decimate, normals]}/' \
  root/pipelines/head_ct_mr.yaml >root/pipelines/mr_skin.yaml
printf 'trephine: 1\nanatomies: {mr_skin: {}}\nface: {policy: deface, believe: given, believe_reason: truth}\n' >root/configs/mr_skin_scene.yaml
cp head/second/truth.tfm root/configs/
python3 - >root/configs/mr_skin.yaml <<'PY'
import json
marks = json.load(open("head/truth/truth.json"))["landmarks_mm"]
print("trephine: 1\ncase: mr-skin\npipeline: ../pipelines/mr_skin.yaml\nscene: mr_skin_scene.yaml")
print("scans:\n  mr: {modality: mr, register: {given: truth.tfm}}")
print("landmarks:", json.dumps({name: marks[name] for name in ("nasion", "tragus_left", "tragus_right")}))
PY
refuses 81 'mr_skin: shows the patient.s face' "$TREPHINE" run root/configs/mr_skin.yaml --series head/dicom \
  --scan mr=head/second/scan.nrrd --out out3 --quiet --no-pictures --no-page

# What is wrong is told where it stands.
expect 64 'scans.mr.series: is not set' both
expect 64 'scan: mri, the configuration has no such scan, did you mean mr' both --scan mri=head/second/scan.nrrd
sed 's/modality: mr,/modality: mr, import: {volume_values: any},/' root/configs/both.yaml >root/configs/twice.yaml
expect 78 'twice.yaml:.*scans.mr.*follow from the scan' "$TREPHINE" run root/configs/twice.yaml --series head/dicom --out out
sed 's/^  mr:/  t1:/' root/configs/both.yaml >root/configs/other.yaml
expect 78 'scan: mr, the case has no such scan' "$TREPHINE" run root/configs/other.yaml --series head/dicom \
  --scan t1=head/second/scan.nrrd --out out --quiet

# A CT is no MR with T1's contrast.
"$TREPHINE" import head/dicom --output ct.nrrd --quiet
"$TREPHINE" register ct.nrrd head/second/scan.nrrd --given head/second/truth.tfm --output mr.nrrd --quiet 2>said
expect 80 'the contrast is not that of T1|lies outside of the MR' "$TREPHINE" t1-contrast ct.nrrd --ct ct.nrrd --output t1.nrrd --quiet

# A CT series that is said to be an MR; before that its registration would have to pass, so the transform is given.
printf '#Insight Transform File V1.0\nTransform: AffineTransform_double_3_3\nParameters: 1 0 0 0 1 0 0 0 1 0 0 0\nFixedParameters: 0 0 0\n' \
  >root/configs/truth.tfm
refuses 65 'scans.mr.modality: is mr, and the series is CT' "$TREPHINE" run root/configs/given.yaml --series head/dicom \
  --scan mr=head/dicom --out out4 --quiet --no-pictures --no-page

# Another patient's scan: their PatientID differs, and it appears nowhere.
cp -r head/dicom other
python3 - other/* <<'PY'
import sys
for name in sys.argv[1:]:
    data = open(name, "rb").read()
    tag = b"\x10\x00\x20\x00LO\x08\x00"
    assert tag + b"PHANTOM " in data
    open(name, "wb").write(data.replace(tag + b"PHANTOM ", tag + b"SOMEONE "))
PY
sed 's/modality: mr,/modality: ct,/; s/case: .*/case: both/' root/configs/given.yaml >root/configs/patients.yaml
patients() { "$TREPHINE" run root/configs/patients.yaml --series head/dicom --scan mr=other --out out5 --quiet --no-pictures --no-page; }
refuses 65 'scans.mr: has another PatientID' patients
! grep -q SOMEONE said || fail "the PatientID is told: $(cat said)"
refuses 65 'scans.mr: has another PatientID' "$TREPHINE" preview root/configs/patients.yaml --series head/dicom --scan mr=other \
  --stage bone.segment --output p.png --quiet
printf 'trephine: 1\nfinest: {"*.decimate.target_triangles_count": 0}\nsweeps: {a: {values: {"*.decimate.max_deviation_mm": [0.3]}}}\n' \
  >root/configs/plan.yaml
sed 's/modality: ct,/modality: ct, series: ..\/..\/other,/' root/configs/patients.yaml >root/configs/patients2.yaml
refuses 65 'scans.mr: has another PatientID' "$TREPHINE" trade root/configs/patients2.yaml --root . --series head/dicom \
  --plan root/configs/plan.yaml --out swept --quiet
[[ ! -e p.png ]] || fail "a picture of two patients"
# With a reason it is used; the reason is recorded, and no ID.
sed -i 's/modality: ct,/modality: ct, same_patient_reason: the other is from a second hospital,/' root/configs/patients.yaml
ln -s nowhere other/link
patients 2>said || fail "with a reason: $(cat said)"
grep -q 'mr.import: 1 symbolic link was not read' said || fail "what else lies in the second scan's folder is not told: $(cat said)"
grep -q 'used for the reason given' said && grep -q 'from a second hospital' out5/both/case.json || fail "not recorded"
! grep -rq SOMEONE out5 said || fail "the PatientID is in the case"
