#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Every command that the README and the pages that it begins with show works as it stands there (the chain of single tools
# is same_bytes.sh's, the package deb.sh's).
. "$(dirname "$0")/common.sh"
PATH=$(dirname "$TREPHINE"):$PATH
cp -r "$SOURCE/configs" "$SOURCE/pipelines" "$SOURCE/sample_dicom" "$SOURCE/trephine.root" "$work"
# LONG=1: on the scan's own voxels, with all that the scene has. Here without the zones of a lesson, each of which has six pictures.
if ((LONG == 0)); then
  sed -i -E '/^  (dura|midline|sagittal_sinus|third_ventricle|brainstem): \{max/d; /^    dura: /d' "$work/configs/scenes/ventriculostomy.yaml"
  sed -i 's/^set: {/&resample.spacing_mm: [3.5, 3.5, 3.5], haptic.spacing_mm: [2, 2, 2], /' "$work/configs/ct_head.yaml"
  grep -q '^set: {resample.spacing_mm' "$work/configs/ct_head.yaml" || fail "ct_head.yaml has no line of settings"
fi
mkdir -p "$work/build/release"
ln -s "$(dirname "$TREPHINE")" "$work/build/release/bin"
cd "$work"

pages=("$SOURCE/README.md")
for page in how-to/own-scan reference/configurations how-to/single-tools how-to/install; do pages+=("$SOURCE/docs/$page.md"); done

# Blocks: one a line, FOLDER and LIBRARY filled in.
sed -E '/<!-- (chain|package|own) -->/,/<!-- end -->/d' "${pages[@]}" "$SOURCE/docs/how-to/library.md" | sed -n '/^```sh$/,/^```$/p' | sed '/^```/d' |
  sed 's,FOLDER,sample_dicom,; s,LIBRARY,library,g' >blocks.sh
grep -q 'trephine run' blocks.sh || fail "the pages show no run"
grep -q 'library build' blocks.sh || fail "the pages show no library"
printf 'trephine: 1\nconfig: configs/ct_head.yaml\ncases: [{case: head-01, series: sample_dicom}]\n' >library.yaml
bash -euo pipefail blocks.sh >/dev/null
case_digest library/head-01 >/dev/null

# A library of one's own, in a home where Trephine lies in ~/trephine; outside of $work, whose trephine.root would allow all.
home=$(mktemp -d)
trap 'rm -rf "$work" "$home"' EXIT
ln -s "$work" "$home/trephine"
sed -n '/<!-- own -->/,/<!-- end -->/p' "$SOURCE/docs/tutorials/own-library.md" | sed -n '/^```sh$/,/^```$/p' | sed '/^```/d' >own.sh
HOME=$home bash -euo pipefail own.sh >own.said 2>&1 || { cat own.said; fail "the library of one's own"; }
[[ -s $home/patients/library/index.html ]] && grep -q 'scene.anatomies.skin.max_triangles: 20000, was 90000' own.said &&
  grep -q '^1 of 1 cases would be built' own.said || { cat own.said; fail "what is stale is not said"; }
expect 78 'root' "$TREPHINE" library build "$home/patients/LIBRARY.yaml" --out "$home/other"

# Commands within the text. A small head: that the command works is what counts here.
sed '/^```sh$/,/^```$/d' "${pages[@]}" | tr '\n' ' ' | grep -oE '`[^`]*trephine [a-zA-Z][^`]*`' | tr -d '`' |
  sort -u >inline.txt
small=(--columns-count 64 --rows-count 64 --slices-count 40 --pixel-mm 4 --slice-step-mm 5 --subvoxel-mm 2 --mesh-step-mm 3)
seen=0
while read -r line; do
  case $line in
    'trephine phantom head') eval "$line ${small[*]} --quiet" ;;
    'trephine measure skull.vtp --truth '*) ;;  # after the loop: it needs the phantom
    'trephine import --list FOLDER') trephine import --list sample_dicom --quiet | grep -q usable ;;
    'trephine export LIBRARY/head-01 --format dicom-'*) ;;  # dicom_objects.sh runs it: it needs the case's scan
    'trephine drilled LIBRARY/head-01 PICTURES '*) ;;  # ambf_stack.sh runs it: it needs pictures that were drilled
    'trephine export LIBRARY/head-01 --format tetra-'*) ;;  # solids.sh runs it, where tetrahedra are built
    'trephine export LIBRARY/head-01 --format print '*) ;;  # print.sh runs it
    'trephine export LIBRARY/head-01 --format ambf '*)
      eval "${line/LIBRARY/library} --quiet" && [[ -s volumetric_drilling/ADF/head-01.ambf/launch.yaml ]] ;;
    'trephine export LIBRARY/head-01 --format slicer-mrb '*)
      eval "${line/LIBRARY/library} --quiet" && [[ -s exported/head-01.mrb ]] ;;
    'trephine export LIBRARY/head-01 --format mrk.json '*)
      eval "${line/LIBRARY/library} --quiet" && [[ -s exported/landmarks.mrk.json ]] ;;
    'trephine diff OLD'*)
      said=${line//OLD/library}
      eval "${said//NEW/library}" 2>/dev/null | grep -q 'same' ;;
    'trephine export LIBRARY/head-01 '*)
      mkdir -p exported
      eval "${line/LIBRARY/library} --quiet" && [[ -s exported/brain.stl && -s exported/skin.x3d ]] ;;
    'trephine diff OLD NEW' | 'trephine diff OLD/head-01 NEW/head-01') trephine diff library/head-01 library/head-01 >/dev/null ;;
    'trephine pictures out/CASE') trephine pictures library/head-01 --output sides --quiet && [[ -s sides/skin_sides.png ]] ;;
    'trephine schema '*) eval "$line" | tee schema.said >/dev/null && [[ -s schema.said || -s configuration.schema.json ]] ;;
    'trephine denoise') trephine denoise --help >/dev/null ;;
    'trephine import head.nii.gz '* | 'trephine register '*) ;;  # second_scan.sh runs them: they need other scans
    'trephine export LIBRARY/head-01 --format mrk.json'*) eval "${line/LIBRARY/library} --quiet" && [[ -n $(ls exported/*.mrk.json) ]] ;;
    'eval "$(trephine completion bash)"') (eval "$line" && complete -p trephine) >/dev/null ;;
    'trephine STAGE --help') for s in import segment contour decimate smooth normals; do trephine "$s" --help >/dev/null; done ;;
    *) fail "the pages show a command that this test does not know: $line" ;;
  esac
  seen=$((seen + 1))
done <inline.txt
[[ $seen == 22 ]] || { cat inline.txt; fail "$seen commands in the text of the pages"; }
cp head/truth/skull.vtp skull.vtp
eval "$(grep '^trephine measure' inline.txt) --quiet"
echo ok
