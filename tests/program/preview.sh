#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# trephine preview: any stage of a configuration, and the files of single tools, as a picture of three slices and a surface.
. "$(dirname "$0")/common.sh"
config=$SOURCE/configs/sample.yaml
preview() { "$TREPHINE" preview "$@" --quiet 2>"$work/stderr" || { cat "$work/stderr"; fail "preview $*"; }; }
size_of() { python3 -c 'import struct, sys; d = open(sys.argv[1], "rb").read(); assert d[:8] == b"\x89PNG\r\n\x1a\n"; print(*struct.unpack(">2I", d[16:24]))' "$1"; }

# Two slices by two; beside each slice stands the legend, as wide as its names.
preview "$config" --stage skull.segment --cache "$work/cache" --output "$work/skull.png"
[[ $(size_of "$work/skull.png") == "1210 972" ]] || fail "the picture is $(size_of "$work/skull.png")"
# Only what it needs was computed: nothing of the brain.
ls "$work/cache" | grep -c '\.index$' >"$work/count"
(($(cat "$work/count") <= 7)) || fail "$(cat "$work/count") stages were computed"
preview "$config" --stage skull.segment --output "$work/again.png" --threads 1
cmp "$work/skull.png" "$work/again.png" || fail "the same preview is another picture"
preview "$config" --stage skull.segment --set skull.segment.lower_hu=900 --cache "$work/cache" --output "$work/other.png"
! cmp -s "$work/skull.png" "$work/other.png" || fail "another threshold is the same picture"

for stage in import head_region skin.contour skull.normals ventricles.ventricles haptic.voxelize landmarks; do
  preview "$config" --stage $stage --cell-mm 3 --size-px 200 --cache "$work/cache" --output "$work/$stage.png"
  [[ $(size_of "$work/$stage.png") == *" 412" ]] || fail "$stage: $(size_of "$work/$stage.png")"
done
expect 64 'skul\.segment: .*did you mean skull\.segment' "$TREPHINE" preview "$config" --stage skul.segment --output "$work/x.png" --quiet
expect 64 'gives a report, of which there is no picture' "$TREPHINE" preview "$config" --stage scan --cell-mm 3 --cache "$work/cache" --output "$work/x.png" --quiet
expect 81 'before the face is taken away' "$TREPHINE" preview "$SOURCE/configs/ct_head_defaced.yaml" --series "$SOURCE/sample_dicom" \
  --stage original.skin.segment --output "$work/x.png" --quiet
expect 64 '--stage: is needed' "$TREPHINE" preview "$config" --output "$work/x.png" --quiet
[[ ! -e $work/x.png ]] || fail "a refused preview left a picture"

# Files of single tools.
"$TREPHINE" import "$SOURCE/sample_dicom" --output "$work/volume.nrrd" --quiet 2>/dev/null
"$TREPHINE" segment "$work/volume.nrrd" --lower-hu 300 --output "$work/bone.nrrd" --quiet 2>/dev/null
"$TREPHINE" contour "$work/bone.nrrd" --output "$work/bone.vtp" --quiet 2>/dev/null
"$TREPHINE" export --format seg.nrrd --labels "bone=$work/bone.nrrd" --out "$work" --quiet
for file in volume.nrrd bone.nrrd bone.vtp labels.seg.nrrd; do
  preview "$work/$file" --volume "$work/volume.nrrd" --size-px 200 --output "$work/$file.png"
  [[ $(size_of "$work/$file.png") == *" 412" ]] || fail "$file: $(size_of "$work/$file.png")"
done
preview "$work/bone.vtp" --size-px 200 --output "$work/alone.png"
[[ $(size_of "$work/alone.png") == "208 208" ]] || fail "a surface without a volume: $(size_of "$work/alone.png")"
expect 64 '--stage: is for a configuration' "$TREPHINE" preview "$work/bone.vtp" --stage skull.segment --output "$work/x.png" --quiet
