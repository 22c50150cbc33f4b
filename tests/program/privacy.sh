#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Canaries in names, IDs, dates, UIDs, comments, private tags and in the folder's name: none of them is in anything that
# import, its list and run write or say, neither as it is, nor as UTF-16, in base64, or inside gzip (acceptance P1, P2).
# LONG=1: on the scan's own voxels.
. "$(dirname "$0")/common.sh"
series=$work/CANARYFOLDER
canaries=$SOURCE/tests/program/canaries.py
python3 "$canaries" put "$SOURCE/sample_dicom" "$series"
cd "$work"
mkdir said made
"$TREPHINE" import "$series" --list --json made/list.json >said/list.out 2>said/list.err
grep -q usable said/list.out || { cat said/list.*; fail "the series with canaries is not usable"; }
"$TREPHINE" import "$series" --output made/volume.nrrd --report made/import.json >said/import.out 2>said/import.err
"$TREPHINE" run "$SOURCE/configs/ct_head.yaml" --series "$series" --out made/library --case p1 --keep made/kept --json made/run.json \
  "${coarsest[@]}" >said/run.out 2>said/run.err
"$TREPHINE" export made/library/p1 --format stl,ply,obj,vtp,vtk,wrl,x3d,glb --out made/exported >said/export.out 2>said/export.err
python3 "$canaries" seek "$series" said made
# What a volume's file says besides its voxels: an allow-list.
head -c 4096 made/volume.nrrd | sed '/^$/q' | grep -avE '^(NRRD000[0-9]|#.*|type: .*|dimension: 3|space: .*|sizes: .*|space directions: .*|kinds: .*|endian: .*|encoding: .*|space origin: .*|space units: .*|content:=HU|trephine-(spacing|direction):=.*|)$' |
  grep -a . && fail "a volume's header holds more than the allow-list"
echo ok
