#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# head_with_mr.sh FOLDER: the synthetic head, as a CT and as an MR that lies elsewhere, in which second_scan.sh, several_scans.sh and
# given_scans.sh work. CTest makes it once for all; a script that is run by itself makes its own.
set -euo pipefail
: "${TREPHINE:?}"
rm -rf "$1"
"$TREPHINE" phantom "$1" --level clinical --seed 5 --columns-count 120 --rows-count 120 --field-of-view-mm 240 --slices-count 90 \
  --slice-step-mm 2 --slice-thickness-mm 2 --mesh-step-mm 0 --subvoxel-mm 1 --no-labels --encoding none --second-scan mr --second-voxel-mm 2 \
  --second-turn-deg=12,-8,15 --second-shift-mm=20,-12,18 --second-noise-ratio 0.04 --quiet
