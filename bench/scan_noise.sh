#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What `trephine scan` says of one synthetic head in more and more noise, through a soft kernel and a sharp one of the
# same scan, and what the recipe then finds: scan_noise.sh TREPHINE FOLDER [NOISE_HU...] prints a line for each: the noise
# that was put in (of the soft kernel; the sharp one has 2.5 times as much), the figures, the verdict, and Dice of brain
# and ventricles, or which stage refused it.
set -eu
[ $# -ge 2 ] || { sed -n '3,6s/^# //p' "$0" >&2; exit 64; }
trephine=$1 folder=$2
shift 2
[ $# -gt 0 ] || set -- 5 10 20 30 45 60

figure() { sed -n "s/^ *\"$2\": *\"\{0,1\}\([-0-9.a-z+]*\)\"\{0,1\},*$/\1/p" "$1" | head -n 1; }

echo "noise kernel  voxel HU  cube HU  neighbours  kernel mm  edge mm  artefacts  kernel    brain     ventricles  skull     brain Dice  ventr. Dice"
for noise; do
  at=$folder/noise$noise
  [ -d "$at/dicom" ] || "$trephine" phantom "$at" --level hard --seed 101 --noise-hu "$noise" --slice-step-mm 2 \
    --slice-thickness-mm 2 --slices-count 96 --mesh-step-mm 0 --no-labels --second-kernel-mm 0.6 --quiet
  for series in s1 s2; do
    "$trephine" import "$at/dicom" --series $series --output "$at/volume.nrrd" --quiet
    "$trephine" scan "$at/volume.nrrd" --report "$at/scan.json" --quiet 2>/dev/null
    rm -f "$at/skin.nrrd" "$at/skull.nrrd" "$at/brain.nrrd" "$at/ventricles.nrrd" "$at/errors.txt"
    {
      "$trephine" segment "$at/volume.nrrd" --lower-hu -475 --open-mm 3 --components largest --fill cavities_and_cut \
        --fill-close-mm 6 --fill-max-ml 1000 --output "$at/skin.nrrd" --quiet &&
        "$trephine" segment "$at/volume.nrrd" --lower-hu 226 --seed-lower-hu 400 --edge half_maximum \
          --min-component-ml 1 --fill cavities --fill-close-mm 2 --fill-max-ml 100 --within "$at/skin.nrrd" \
          --output "$at/skull.nrrd" --quiet &&
        "$trephine" brain "$at/volume.nrrd" --skull "$at/skull.nrrd" --output "$at/brain.nrrd" --quiet &&
        "$trephine" ventricles "$at/volume.nrrd" --brain "$at/brain.nrrd" --output "$at/ventricles.nrrd" --quiet
    } 2>"$at/errors.txt" || true
    found=
    for anatomy in brain ventricles; do
      if [ -f "$at/$anatomy.nrrd" ]; then
        "$trephine" measure "$at/$anatomy.nrrd" --truth "$at/truth/truth.json" --anatomy $anatomy --sample-count 1000 \
          --report "$at/measured.json" --quiet
        found="$found $(printf '%10.3f' "$(figure "$at/measured.json" dice_ratio)")"
      else
        found="$found refused: $(grep -v '^warning' "$at/errors.txt" | tail -n 1)"
        break
      fi
    done
    kernel=soft
    [ $series = s1 ] || kernel=sharp
    of() { figure "$at/scan.json" "$1"; }
    printf '%5s %-6s %9.1f %8.1f %11.2f %10.2f %8.2f %10.3f  %-9s %-9s %-11s %-9s %s\n' "$noise" $kernel \
      "$(of noise_hu)" "$(of cube_noise_hu)" "$(of neighbour_correlation_ratio)" "$(of kernel_mm)" "$(of edge_mm)" \
      "$(of artefact_ratio)" "$(of kernel)" "$(of brain)" "$(of ventricles)" "$(of skull)" "$found"
  done
done
