#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Brain and ventricles of a T1-weighted MR on the library of synthetic heads (n01 to n15 of head_library.sh):
# second_scan_library.sh TREPHINE SOURCE FOLDER [NAME...] makes each head with an MR of 1 mm voxels, 4 % noise and 25 %
# bias, turned by up to 20 degrees and shifted by up to 30 mm, runs a case of configs/head_ct_mr.yaml's recipe, and prints
# Dice against the truth on the CT's voxels. SOURCE is the folder that holds pipelines/ and configs/.
set -eu
[ $# -ge 3 ] || { sed -n '3,7s/^# //p' "$0" >&2; exit 64; }
trephine=$1 source=$2 folder=$3
shift 3
wanted=" $* "

figure() { sed -n "s/^ *\"$2\": *\([-0-9.e+]*\),*$/\1/p" "$1" | head -n 1; }

mkdir -p "$folder/root/configs"
touch "$folder/root/trephine.root"
cp -r "$source/pipelines" "$folder/root/"
cat >"$folder/root/configs/scene.yaml" <<'YAML'
trephine: 1
anatomies: {ventricles: {}}  # the brain is computed for them, but its surface need not be
YAML
echo "head   brain Dice  ventr. Dice  seconds of the run"
while read -r name variant seed noise slice slices tilt turn shift; do
  case "$wanted" in "  " | *" $name "*) ;; *) continue ;; esac
  at=$folder/$name
  [ -f "$at/second/scan.nrrd" ] || "$trephine" phantom "$at" --level clinical --variant "$variant" --seed "$seed" \
    --noise-hu "$noise" --slice-step-mm "$slice" --slice-thickness-mm "$slice" --slices-count "$slices" \
    --tilt-deg="$tilt" --mesh-step-mm 0 --no-labels --second-scan mr --second-voxel-mm 1 --second-noise-ratio 0.04 \
    --second-turn-deg="$turn" --second-shift-mm="$shift" --quiet
  cat >"$folder/root/configs/$name.yaml" <<YAML
trephine: 1
case: $name
pipeline: ../pipelines/head_ct_mr.yaml
scene: scene.yaml
scans:
  mr: {modality: mr}
YAML
  start=$(date +%s)
  "$trephine" run "$folder/root/configs/$name.yaml" --series "$at/dicom" --scan mr="$at/second/scan.nrrd" \
    --out "$folder/out" --keep "$at/keep" --quiet --no-pictures --no-page 2>"$at/said" || {
    echo "$name refused: $(grep -v '^warning' "$at/said" | tail -n 1)"
    continue
  }
  seconds=$(($(date +%s) - start))
  for anatomy in brain ventricles; do
    "$trephine" measure "$at/keep/$anatomy.$anatomy.nrrd" --truth "$at/truth/truth.json" --anatomy $anatomy \
      --sample-count 2000 --report "$at/$anatomy.json" --quiet
  done
  printf '%-6s %10.4f  %11.4f  %d\n' "$name" "$(figure "$at/brain.json" dice_ratio)" \
    "$(figure "$at/ventricles.json" dice_ratio)" "$seconds"
done <<LIBRARY
n01 normal 101 12 1 192 0 12,-8,15 20,-12,18
n02 normal 102 8 2 96 0 -10,5,-14 -15,20,10
n03 normal 103 20 3 64 0 8,14,-6 10,15,-20
n04 normal 104 16 1.5 128 0 -14,-9,8 22,8,-12
n05 hydrocephalic 105 12 1 192 0 5,-15,10 -8,-22,15
n06 hydrocephalic 106 20 2 96 0 15,8,-5 12,-18,-16
n07 hydrocephalic 107 8 3 64 0 -6,12,13 -20,14,8
n08 shifted 108 20 1 192 0 10,10,-12 16,-16,16
n09 shifted 109 16 2 96 0 -12,-6,-14 -24,6,12
n10 shifted 110 8 3 64 0 14,-12,6 8,24,-10
n11 small 111 12 2 96 0 -8,10,15 18,18,14
n12 small 112 20 1.5 128 0 6,-14,-10 -16,-20,10
n13 small 113 8 3 64 0 -15,7,9 14,-10,22
n14 normal 114 12 2 112 14 9,9,-13 -12,22,-14
n15 shifted 115 16 1.5 150 -12 -11,13,8 20,-14,-12
LIBRARY
