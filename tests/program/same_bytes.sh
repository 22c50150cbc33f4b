#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# case.json and all that it names are the same bytes with 1 and 2 threads, in another folder, time zone and locale, and the
# chain of single tools in docs/how-to/single-tools.md gives the surfaces of `run`, bit for bit. LONG=1: on the scan's own voxels.
. "$(dirname "$0")/common.sh"
config=$SOURCE/configs/sample_drilled.yaml
felt_mm=$( ((LONG)) && echo 1.6,1.6,1.6 || echo 2,2,2)
coarse+=(--set "haptic.spacing_mm=[$felt_mm]")
((LONG)) || coarse+=(--no-pictures --no-page)  # case.json names neither

"$TREPHINE" run "$config" --out "$work/one" --threads 1 --no-use-cache --quiet --keep "$work/kept" "${coarse[@]}"
mkdir -p "$work/a folder/ünder"
TZ=Asia/Kathmandu LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 \
  "$TREPHINE" run "$config" --out "$work/a folder/ünder" --threads 2 --no-use-cache --quiet "${coarse[@]}"
[[ $(case_digest "$work/one/sample-drilled") == "$(case_digest "$work/a folder/ünder/sample-drilled")" ]] || fail "the bytes differ"
find "$work" -name '.trephine-tmp-*' | grep . && fail "temporary files are left"
grep -aiE "$(hostname)|$work|TREPHINE\^PHANTOM" "$work/one/sample-drilled/case.json" && fail "case.json holds a host, a path or a name"

cd "$work"
"$TREPHINE" import "$SOURCE/sample_dicom" --output volume.nrrd --quiet
cmp volume.nrrd kept/import.nrrd || fail "the imported volume differs"
if ((LONG == 0)); then
  "$TREPHINE" resample volume.nrrd --spacing-mm 2.5,2.5,2.5 --output coarse.nrrd --quiet
  cmp coarse.nrrd kept/resample.nrrd || fail "the resampled volume differs"
fi
sed -n '/<!-- chain -->/,/<!-- end -->/p' "$SOURCE/docs/how-to/single-tools.md" | sed -n '/^```sh/,/^```$/p' | sed '/^```/d' >chain.sh
grep -q 'trephine normals' chain.sh || fail "docs/how-to/single-tools.md holds no chain of single tools"
if ((LONG == 0)); then
  mv coarse.nrrd volume.nrrd
  sed -i '/^trephine import /d' chain.sh
fi
PATH=$(dirname "$TREPHINE"):$PATH bash -euo pipefail chain.sh
cmp skull.vtp kept/skull.normals.vtp || fail "the chain's skull differs from run's"
cmp drilled.vtp kept/skull.boolean.vtp || fail "the chain's drilled skull differs from run's"
shapes=()
for a in ventricles skull dura brain skin; do shapes+=(--shape "$a=kept/$a.contour.vtp"); done
"$TREPHINE" voxelize head.nrrd "${shapes[@]}" --shapes skin:clear_of=brain,clear_mm=5 --shapes dura:shell_mm=1.6 --region-of brain --margin-mm 25 --spacing-mm $felt_mm \
  --cutters hole.json --drill skull --drill skin:widen_mm=6 --output felt.nrrd --quiet
cmp felt.nrrd kept/haptic.voxelize.nrrd || fail "voxelize alone gives another haptic volume than run"
"$TREPHINE" boolean felt.nrrd --cutters hole.json --shape skull --output twice.nrrd --quiet
cmp felt.nrrd twice.nrrd || fail "a hole drilled twice removes more the second time"
echo ok
