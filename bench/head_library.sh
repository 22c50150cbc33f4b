#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A library of 15 synthetic heads at clinical level and what one recipe finds in them: head_library.sh TREPHINE FOLDER
# [NAME...] makes the phantoms once (minutes), segments each with the values of pipelines/ventriculostomy.yaml and prints
# a line for each: Dice and mean distance (mm, both directions) of brain and ventricles, how much too thick the skull is
# (mm), the volumes' errors (%), seconds of all four anatomies, the class asked for and found, and the landmarks: how
# many of eight were found, their median and largest error (mm) and which that is.
set -eu
[ $# -ge 2 ] || { sed -n '3,8s/^# //p' "$0" >&2; exit 64; }
trephine=$1 folder=$2
shift 2
wanted=" $* "

figure() { sed -n "s/^ *\"$2\": *\([-0-9.e+]*\),*$/\1/p" "$1" | head -n 1; }

echo "head   brain Dice  vol %   ventr. Dice  dist mm  vol %   skull width mm  vol %   seconds   class asked / found            landmarks median  worst"
# name variant seed noise_hu slice_mm slices tilt_deg
while read -r name variant seed noise slice slices tilt; do
  case "$wanted" in "  " | *" $name "*) ;; *) continue ;; esac
  at=$folder/$name
  if [ ! -f "$at/volume.nrrd" ]; then
    "$trephine" phantom "$at" --level clinical --variant "$variant" --seed "$seed" --noise-hu "$noise" \
      --slice-step-mm "$slice" --slice-thickness-mm "$slice" --slices-count "$slices" --tilt-deg "$tilt" \
      --mesh-step-mm 0 --no-labels --quiet
    "$trephine" import "$at/dicom" --output "$at/volume.nrrd" --quiet
  fi
  start=$(date +%s)
  segment() { output=$1; shift; "$trephine" segment "$at/volume.nrrd" "$@" --output "$at/$output.nrrd" --quiet; }
  segment skin --lower-hu -475 --open-mm 3 --components largest --fill cavities_and_cut --fill-close-mm 6 \
    --fill-max-ml 1000
  segment skull --lower-hu 226 --seed-lower-hu 400 --edge half_maximum --min-component-ml 1 --fill cavities \
    --fill-close-mm 2 --fill-max-ml 100 --within "$at/skin.nrrd"
  "$trephine" brain "$at/volume.nrrd" --skull "$at/skull.nrrd" --output "$at/brain.nrrd" --quiet
  "$trephine" ventricles "$at/volume.nrrd" --brain "$at/brain.nrrd" --output "$at/ventricles.nrrd" --quiet
  seconds=$(($(date +%s) - start))
  for anatomy in skull brain ventricles; do
    "$trephine" measure "$at/$anatomy.nrrd" --truth "$at/truth/truth.json" --anatomy $anatomy --sample-count 5000 \
      --report "$at/$anatomy.json" --quiet
  done
  "$trephine" landmarks "$at/volume.nrrd" --skin "$at/skin.nrrd" --skull "$at/skull.nrrd" --brain "$at/brain.nrrd" \
    --ventricles "$at/ventricles.nrrd" --lateral-mm 30 --output "$at/landmarks.json" --quiet 2>/dev/null
  "$trephine" anatomy --skin "$at/skin.nrrd" --skull "$at/skull.nrrd" --brain "$at/brain.nrrd" \
    --ventricles "$at/ventricles.nrrd" --landmarks "$at/landmarks.json" --report "$at/anatomy.json" --quiet || true
  landmarks=$(python3 - "$at" <<'PY'
import json, math, statistics, sys
truth = json.load(open(sys.argv[1] + "/truth/truth.json"))["landmarks_mm"]
found = {m["name"]: m["position_mm"] for m in json.load(open(sys.argv[1] + "/landmarks.json"))["landmarks"]}
off = {n: math.dist(p, found[n]) for n, p in truth.items() if n in found}
worst = max(off, key=off.get)
print(f"{len(off)} of {len(truth)}  {statistics.median(off.values()):6.2f} {off[worst]:6.2f} {worst}")
PY
)
  class=$(sed -n 's/^ *"class": "\([a-z]*\)".*/\1/p' "$at/anatomy.json" 2>/dev/null | head -n 1)
  percent() { awk "BEGIN { printf \"%+.1f\", 100 * $(figure "$at/$1.json" volume_difference_ratio) }"; }
  printf '%-6s %10.4f %6s   %11.4f  %7.3f %6s   %14.3f %6s   %7d   %-13s / %-13s  %s\n' "$name" \
    "$(figure "$at/brain.json" dice_ratio)" "$(percent brain)" "$(figure "$at/ventricles.json" dice_ratio)" \
    "$(figure "$at/ventricles.json" deviation_mean_mm)" "$(percent ventricles)" \
    "$(figure "$at/skull.json" width_bias_mm)" "$(percent skull)" "$seconds" "$variant" \
    "${class:-refused}" "$landmarks"
done <<LIBRARY
n01 normal 101 12 1 192 0
n02 normal 102 8 2 96 0
n03 normal 103 20 3 64 0
n04 normal 104 16 1.5 128 0
n05 hydrocephalic 105 12 1 192 0
n06 hydrocephalic 106 20 2 96 0
n07 hydrocephalic 107 8 3 64 0
n08 shifted 108 20 1 192 0
n09 shifted 109 16 2 96 0
n10 shifted 110 8 3 64 0
n11 small 111 12 2 96 0
n12 small 112 20 1.5 128 0
n13 small 113 8 3 64 0
n14 normal 114 12 2 112 14
n15 shifted 115 16 1.5 150 -12
LIBRARY
