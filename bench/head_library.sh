#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A library of 15 synthetic heads at clinical level (n01 to n15) and 15 hard ones (h01 to h15), and what one recipe finds
# in them: head_library.sh TREPHINE FOLDER [NAME...] makes the phantoms once (minutes), segments each with the values of
# pipelines/ventriculostomy.yaml and prints a line for each: Dice and mean distance (mm, both directions) of brain and
# ventricles, how much too thick the skull is (mm), the volumes' errors (%), seconds of all four anatomies, the class
# asked for and found, and the landmarks: how many of eight were found, their median and largest error (mm) and which
# that is. Of a hard one also the skin's mean distance (mm) and how much apparatus is in skin and skull (ml); or which
# stage refused it, and why.
set -eu
[ $# -ge 2 ] || { sed -n '3,10s/^# //p' "$0" >&2; exit 64; }
trephine=$1 folder=$2
shift 2
wanted=" $* "

figure() { sed -n "s/^ *\"$2\": *\([-0-9.e+]*\),*$/\1/p" "$1" | head -n 1; }

echo "head   brain Dice  vol %   ventr. Dice  dist mm  vol %   skull width mm  vol %   seconds   class asked / found            landmarks median  worst"
# name variant seed noise_hu slice_mm slices tilt_deg [options of its own]
while read -r name variant seed noise slice slices tilt more; do
  case "$wanted" in "  " | *" $name "*) ;; *) continue ;; esac
  at=$folder/$name
  if [ ! -f "$at/volume.nrrd" ]; then
    case $name in h*) level=hard ;; *) level=clinical ;; esac
    case $more in *--slice-thickness-mm*) ;; *) more="$more --slice-thickness-mm $slice" ;; esac
    # shellcheck disable=SC2086
    "$trephine" phantom "$at" --level $level --variant "$variant" --seed "$seed" --noise-hu "$noise" \
      --slice-step-mm "$slice" --slices-count "$slices" --tilt-deg "$tilt" --mesh-step-mm 0 --no-labels --quiet $more
    "$trephine" import "$at/dicom" --series s1 --output "$at/volume.nrrd" --quiet
  fi
  start=$(date +%s)
  rm -f "$at"/*.json "$at"/skin.nrrd "$at"/skull.nrrd "$at"/brain.nrrd "$at"/ventricles.nrrd
  segment() {
    output=$1
    shift
    "$trephine" segment "$at/head.nrrd" "$@" --output "$at/$output.nrrd" --quiet
  }
  make_anatomies() {
    "$trephine" body "$at/volume.nrrd" --output "$at/body.nrrd" --quiet &&
      "$trephine" head-region "$at/body.nrrd" --output "$at/head.nrrd" --quiet &&
      segment skin --lower-hu -475 --open-mm 3 --components largest --fill cavities_and_cut --fill-close-mm 6 \
      --fill-max-ml 1000 &&
      segment skull --lower-hu 226 --seed-lower-hu 400 --edge half_maximum --min-component-ml 1 --fill cavities \
        --fill-close-mm 2 --fill-max-ml 100 --within "$at/skin.nrrd" &&
      "$trephine" brain "$at/head.nrrd" --skull "$at/skull.nrrd" --output "$at/brain.nrrd" --quiet &&
      "$trephine" ventricles "$at/head.nrrd" --brain "$at/brain.nrrd" --output "$at/ventricles.nrrd" --quiet
  }
  made=yes
  make_anatomies 2>"$at/errors.txt" || made=no
  seconds=$(($(date +%s) - start))
  for anatomy in skin skull brain ventricles; do
    case $name-$anatomy in n*-skin) continue ;; esac
    [ -f "$at/$anatomy.nrrd" ] || continue
    "$trephine" measure "$at/$anatomy.nrrd" --truth "$at/truth/truth.json" --anatomy $anatomy --sample-count 5000 \
      --report "$at/$anatomy.json" --quiet
  done
  of_skin=
  case $name in
    h*) [ -f "$at/skin.json" ] && of_skin=$(printf '  skin %.2f mm, apparatus %.1f ml, in the skull %.1f ml' \
      "$(figure "$at/skin.json" deviation_mean_mm)" "$(figure "$at/skin.json" apparatus_ml)" \
      "$( ([ -f "$at/skull.json" ] && figure "$at/skull.json" apparatus_ml) || echo 0)") ;;
  esac
  if [ $made = no ]; then
    echo "$name refused after $seconds s: $(grep -v '^warning' "$at/errors.txt" | tail -n 1)$of_skin"
    continue
  fi
  "$trephine" landmarks "$at/head.nrrd" --skin "$at/skin.nrrd" --skull "$at/skull.nrrd" --brain "$at/brain.nrrd" \
    --ventricles "$at/ventricles.nrrd" --output "$at/landmarks.json" --quiet 2>/dev/null || {
    echo "$name no landmarks after $seconds s$of_skin"
    continue
  }
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
  printf '%-6s %10.4f %6s   %11.4f  %7.3f %6s   %14.3f %6s   %7d   %-13s / %-13s  %s%s\n' "$name" \
    "$(figure "$at/brain.json" dice_ratio)" "$(percent brain)" "$(figure "$at/ventricles.json" dice_ratio)" \
    "$(figure "$at/ventricles.json" deviation_mean_mm)" "$(percent ventricles)" \
    "$(figure "$at/skull.json" width_bias_mm)" "$(percent skull)" "$seconds" "$variant" \
    "${class:-refused}" "$landmarks" "$of_skin"
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
h01 normal 201 8 1 174 0 --mask --couch --clamps --burr-hole --field-of-view-mm 250 --centre-mm 0,20,42
h02 normal 202 5 3 90 0 --mask --couch --clamps --shoulders --field-of-view-mm 500 --centre-mm 0,40,-10
h03 hydrocephalic 203 20 1.5 128 0 --shunt --asymmetry-ratio 0.3 --fillings-count 3
h04 slit 204 10 1 192 0 --shunt --burr-hole --plexus
h05 small 205 25 2 96 0 --second-kernel-mm 0.6 --asymmetry-ratio 0.2
h06 normal 206 14 1 192 0 --kernel-mm 0.6 --sharpen-ratio 2 --plexus
h07 shifted 207 12 2 96 0 --blood subdural --couch --burr-hole
h08 normal 208 16 1.5 128 0 --blood intracerebral --contrast --motion-mm 2
h09 hydrocephalic 209 6 5 40 0 --blood intraventricular --couch --plexus
h10 shifted 210 15 1.5 128 0 --craniectomy --plexus --shunt
h11 normal 211 16 1 192 0 --field-of-view-mm 160 --round-field --asymmetry-ratio 0.35
h12 small 212 10 2 96 0 --clip --fillings-count 6 --streak-hu 400 --couch
h13 normal 213 12 2 96 0 --motion-mm 4 --mask --clamps --couch --field-of-view-mm 280
h14 hydrocephalic 214 60 1 192 0 --asymmetry-ratio 0.5 --slice-thickness-mm 2
h15 small 215 35 2.5 110 12 --shoulders --contrast --plexus --mask --field-of-view-mm 400 --centre-mm 0,20,0
LIBRARY
