# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the scripts of a second scan after common.sh: a head with a CT and an MR, and `both`, which makes a case of the two.
cd "$work"
mkdir root && touch root/trephine.root
cp -r "$SOURCE/pipelines" "$SOURCE/configs" root/
[[ -n ${HEAD:-} ]] || bash "$SOURCE/tests/program/head_with_mr.sh" "${HEAD:=$work/head}"
[[ $HEAD == "$work/head" ]] || cp -r "$HEAD" head
cat >root/configs/both.yaml <<'YAML'
trephine: 1
case: both
pipeline: ../pipelines/head_ct_mr.yaml
scene: scene.yaml
scans:
  mr: {modality: mr, register: {finest_mm: 2.5, samples_count: 15000}}
set: {skin.segment.fill: none, skin.segment.coarse_mm: 1.5}
YAML
cat >root/configs/scene.yaml <<'YAML'
trephine: 1
anatomies: {brain: {}, ventricles: {}}
face: {policy: keep, reason: a phantom whose coarse brain reaches within 5 mm of the skin behind the nasion}
YAML
both() { "$TREPHINE" run root/configs/both.yaml --series head/dicom --out out --quiet --no-pictures --no-page "$@"; }
