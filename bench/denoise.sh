#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What a filter of noise does for brain and ventricles: denoise.sh TREPHINE FOLDER [NAME...] makes three synthetic heads
# (n: normal, y: hydrocephalic, s: small) at 12, 20, 40 and 60 HU once, and prints a line for each filter: Dice of brain and
# ventricles, seconds and peak memory (MB) of the filter on the box about the skull. VOXEL_MM (1.2) is the side of the
# voxels in the slice; slices are 1.5 mm apart.
set -eu
[ $# -ge 2 ] || { sed -n '3,7s/^# //p' "$0" >&2; exit 64; }
trephine=$1 folder=$2
shift 2
wanted=" $* "
voxel=${VOXEL_MM:-1.2}

figure() { sed -n "s/^ *\"$2\": *\([-0-9.e+]*\),*$/\1/p" "$1" | head -n 1; }

echo "head noise filter            brain Dice  ventr. Dice  seconds  MB"
for head in "n normal 101" "y hydrocephalic 105" "s small 111"; do
  # shellcheck disable=SC2086
  set -- $head
  case "$wanted" in "  " | *" $1 "*) ;; *) continue ;; esac
  columns=$(awk "BEGIN { print int(240 / $voxel) }")
  for noise in 12 20 40 60; do
    at=$folder/$1$noise
    if [ ! -f "$at/skull.nrrd" ]; then
      "$trephine" phantom "$at" --level clinical --variant "$2" --seed "$3" --noise-hu $noise --columns-count "$columns" \
        --rows-count "$columns" --field-of-view-mm 240 --slice-step-mm 1.5 --slice-thickness-mm 1.5 --slices-count 128 \
        --mesh-step-mm 0 --no-labels --quiet
      "$trephine" import "$at/dicom" --output "$at/volume.nrrd" --quiet
      "$trephine" body "$at/volume.nrrd" --output "$at/body.nrrd" --quiet
      "$trephine" head-region "$at/body.nrrd" --output "$at/head.nrrd" --quiet
      "$trephine" segment "$at/head.nrrd" --lower-hu 226 --seed-lower-hu 400 --edge half_maximum --min-component-ml 1 \
        --fill cavities --fill-close-mm 2 --fill-max-ml 100 --output "$at/skull.nrrd" --quiet
      rm -rf "$at/dicom"
    fi
    edge=$((2 * noise))
    while read -r filter options; do
      rm -f "$at/brain.nrrd" "$at/ventricles.nrrd" "$at"/*.json "$at/calm.nrrd"
      cp "$at/head.nrrd" "$at/calm.nrrd"
      spent="- -"
      # shellcheck disable=SC2086
      [ "$filter" = none ] ||
        spent=$(/usr/bin/env time -f '%e %M' "$trephine" denoise "$at/head.nrrd" --method "$filter" $options \
          --edge-hu $edge --within "$at/skull.nrrd" --output "$at/calm.nrrd" --quiet 2>&1 >/dev/null | tail -n 1)
      {
        "$trephine" brain "$at/calm.nrrd" --skull "$at/skull.nrrd" --output "$at/brain.nrrd" --quiet &&
          "$trephine" ventricles "$at/calm.nrrd" --brain "$at/brain.nrrd" --output "$at/ventricles.nrrd" --quiet
      } 2>/dev/null || true
      dice=
      for anatomy in brain ventricles; do
        if [ -f "$at/$anatomy.nrrd" ] && "$trephine" measure "$at/$anatomy.nrrd" --truth "$at/truth/truth.json" \
          --anatomy $anatomy --sample-count 2000 --report "$at/$anatomy.json" --quiet 2>/dev/null; then
          dice="$dice $(figure "$at/$anatomy.json" dice_ratio)"
        else
          dice="$dice refused"
        fi
      done
      # shellcheck disable=SC2086
      printf '%-4s %5s %-17s %11.7s %12.7s %8s %6s\n' "$1" "$noise" "$filter" $dice $spent |
        awk '{ if ($NF ~ /^[0-9]+$/) $NF = int($NF / 1024); print }'
    done <<FILTERS
none
curvature --sigma-mm 0.8
median --sigma-mm 1.2
gaussian --sigma-mm 0.8
bilateral --sigma-mm 1
non_local_means --search-mm 3.6 --patch-mm 1.2
FILTERS
  done
done
