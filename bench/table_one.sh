#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Table I of [Rizzi, chapter 2] made again: its reductions of brain, ventricles, skin and skull, on the
# contours that `trephine run configs/ct_head.yaml ... --keep KEEP` leaves in KEEP, and what each costs in mm.
# bench/table_one.sh TREPHINE KEEP
set -euo pipefail
[ $# -eq 2 ] || { echo "table_one.sh TREPHINE KEEP" >&2; exit 64; }
trephine=$1 keep=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
figure() { sed -n "s/^ *\"$2\": \"\{0,1\}\([^\",]*\)\"\{0,1\},\{0,1\}$/\1/p" "$1"; }
echo "| model | dissertation: before, after, reduction | ours: before | after | reduction % | max mm | p99 mm | RMS mm | volume % | genus | valid |"
echo "|---|---|---|---|---|---|---|---|---|---|---|"
for row in "brain 495364 22742" "ventricles 93528 23176" "skin 916608 83346" "skull 1495636 79810"; do
  read -r model before after <<< "$row"
  [ -f "$keep/$model.contour.vtp" ] || continue
  ratio=$(awk "BEGIN { printf \"%.6f\", $after / $before }")
  "$trephine" decimate "$keep/$model.contour.vtp" --keep-ratio "$ratio" --target-triangles-count 0 \
    --max-deviation-mm 0 --output "$work/$model.vtp" --report "$work/d.json" --quiet
  "$trephine" measure "$work/$model.vtp" --reference "$keep/$model.contour.vtp" --report "$work/m.json" --quiet
  printf '| %s | %s, %s, %.1f %% | %s | %s | %.1f | %.3f | %.3f | %.3f | %.3f | %s | %s |\n' "$model" "$before" "$after" \
    "$(awk "BEGIN { print 100 * (1 - $after / $before) }")" "$(figure "$work/d.json" triangles_before_count)" \
    "$(figure "$work/d.json" triangles_count)" "$(figure "$work/d.json" reduction_percent)" \
    "$(figure "$work/m.json" deviation_max_mm)" "$(figure "$work/m.json" deviation_p99_mm)" \
    "$(figure "$work/m.json" deviation_rms_mm)" "$(figure "$work/d.json" volume_change_percent)" \
    "$(figure "$work/m.json" genus_count)" "$(figure "$work/m.json" valid)"
done
