#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Faces that a recipe says are none. A CT whose face was taken off before, and a second scan of the same head that has it still: one
# more anatomy of that scan, `shows_face: false`, is its skin. And a skin that a scene without a word of the face shows.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/scans_common.sh"
T=("$TREPHINE")
"${T[@]}" import head/dicom --output ct.nrrd --quiet
"${T[@]}" segment ct.nrrd --lower-hu -475 --open-mm 3 --components largest --fill cavities --fill-close-mm 6 --output skin.nrrd --quiet
python3 - >marks.yaml <<'PY'
import json
marks = json.load(open("head/truth/truth.json"))["landmarks_mm"]
three = {name: marks[name] for name in ("nasion", "tragus_left", "tragus_right")}
print("landmarks:", json.dumps(three))
json.dump({"midsagittal": {"point_mm": three["nasion"], "normal": [1, 0, 0], "confidence": 1},
           "landmarks": [{"name": n, "position_mm": p, "confidence": 1, "source": "found"} for n, p in three.items()]},
          open("marks.json", "w"))
PY
"${T[@]}" deface ct.nrrd --skin skin.nrrd --landmarks marks.json --depth-mm 40 --side-depth-mm 40 \
  --output defaced.nrrd --quiet

cp head/second/truth.tfm root/configs/
box=$(python3 -c 'import json; x, y, z = json.load(open("head/truth/truth.json"))["landmarks_mm"]["nasion"]
print(f"roi_min_mm: [{x - 45}, {y - 60}, {z - 85}], roi_max_mm: [{x + 45}, {y + 12}, {z - 2}]")')
more="more: {shows_face: false, stages: [segment: {scan: mr, lower_hu: 150, components: largest, $box}, contour, decimate, normals]}"
deep='deep: {shows_face: false, stages: [segment: {lower_hu: 226, min_component_ml: 1}, contour, decimate, normals]}'
sed "s/^anatomies:/&\n  $more\n  $deep/" root/pipelines/head_ct_mr.yaml >root/pipelines/more.yaml
printf 'trephine: 1\nanatomies:\n  %s\n  %s\n' "$more" "$deep" >root/pipelines/bare.yaml  # it knows of no face
face() {  # face ANATOMY PIPELINE FACE_POLICY: the configuration face.yaml
  printf 'trephine: 1\nanatomies: {%s: {}}\n%s\n' "$1" "$3" >root/configs/face_scene.yaml
  {
    printf 'trephine: 1\ncase: face\npipeline: ../pipelines/%s.yaml\nscene: face_scene.yaml\n' "$2"
    printf 'import: {volume_values: hu}\nscans:\n  mr: {modality: mr, register: {given: truth.tfm, largest_given_mm: 3}}\n'
    [[ $2 == bare ]] || cat marks.yaml
  } >root/configs/face.yaml
}
run=("${T[@]}" run root/configs/face.yaml --series defaced.nrrd --scan mr=head/second/scan.nrrd --out out --quiet --no-page)
given='face: {policy: deface, believe: given, believe_reason: the face was taken off before}'

# The second scan's face, which lies outside of what is left of the first one's.
face more more "$given"
refuses 81 'more: shows the patient.s face: 0 mm from the skin that the scan mr shows' "${run[@]}"
[[ ! -e out/face ]] || fail "a face was published"
[[ $(ls out/face.refused) == message.txt ]] || fail "more than the message: $(ls out/face.refused)"

# The skin of a head, of a scene that says nothing of the face.
face more bare ''
refuses 81 'more: shows [0-9]* cm2 of the skin of a head, as the scan mr has it; the scene must say face' "${run[@]}"
[[ ! -e out/face ]] || fail "a face was published"

# The bone of the same scans passes both; without a word of the face there is no picture of the scan.
face deep more "$given"
"${run[@]}" >said 2>&1 || fail "bone with the face taken off: $(cat said)"
[[ -e out/face/report/sagittal.png ]] || fail "no picture of a scan without a face"
face deep bare ''
"${run[@]}" >said 2>&1 || fail "bone: $(cat said)"
grep -q 'no pictures of the scan' said || fail "not said: $(cat said)"
[[ -e out/face/report/cut.png && ! -e out/face/report/sagittal.png && ! -e out/face/report/landmarks.png ]] ||
  fail "pictures: $(ls out/face/report)"
