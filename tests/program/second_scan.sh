#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A second scan of the patient as its user registers it: transform, picture, refusals.
. "$(dirname "$0")/common.sh"
cd "$work"
"$TREPHINE" phantom head --level clinical --seed 5 --columns-count 80 --rows-count 80 --field-of-view-mm 240 --slices-count 60 \
  --slice-step-mm 3 --slice-thickness-mm 3 --mesh-step-mm 0 --no-labels --encoding none --second-scan mr --second-voxel-mm 2.5 \
  --second-turn-deg=12,-8,15 --second-shift-mm=20,-12,18 --quiet 2>said || fail "phantom: $(cat said)"
"$TREPHINE" import head/dicom --output ct.nrrd --quiet
quick=(--finest-mm 2.5 --samples-count 15000 --quiet)
"$TREPHINE" register ct.nrrd head/second/scan.nrrd "${quick[@]}" --transform found.tfm --picture check.png --report r.json \
  --output mr.nrrd
python3 - head/second/truth.tfm found.tfm <<'PY'
import sys
def read(name):
    lines = open(name).read().splitlines()
    assert lines[2] == "Transform: AffineTransform_double_3_3", lines
    v = [float(w) for w in lines[3].split()[1:]]
    return lambda p: [sum(v[3 * r + c] * p[c] for c in range(3)) + v[9 + r] for r in range(3)]
truth, found = read(sys.argv[1]), read(sys.argv[2])
for p in ([0, 0, 60], [25, -60, 110], [-25, 40, 30], [0, 40, 60]):
    error = sum((a - b) ** 2 for a, b in zip(truth(p), found(p))) ** 0.5
    assert error < 1, (p, error)
PY
[[ $(head -c 4 check.png | tail -c 3) == PNG ]] || fail "no picture"
grep -q '"inverse_mm"' r.json || fail "no figures: $(cat r.json)"
head -c 400 mr.nrrd | grep -aq 'sizes: 80 80 60' || fail "not on the CT's voxels: $(head -c 400 mr.nrrd)"

# Doubtful: 80, the figure, the picture and nothing else.
rm -f mr.nrrd found.tfm check.png
expect 80 'doubtful: .*largest_inverse_mm' "$TREPHINE" register ct.nrrd head/second/scan.nrrd "${quick[@]}" \
  --largest-inverse-mm 0.01 --transform found.tfm --picture check.png --output mr.nrrd
[[ -e check.png && ! -e mr.nrrd && ! -e found.tfm ]] || fail "what a doubtful registration leaves: $(ls)"

# A transform of another program to begin with, and one that is none.
"$TREPHINE" register ct.nrrd head/second/scan.nrrd "${quick[@]}" --initial head/second/truth.tfm --output mr.nrrd
printf '#Insight Transform File V1.0\nTransform: BSplineTransform_double_3_3\nParameters: 1\nFixedParameters: 0 0 0\n' >b.tfm
expect 65 'b.tfm: Transform: is no affine' "$TREPHINE" register ct.nrrd head/second/scan.nrrd --initial b.tfm --output n.nrrd

# Without the program that holds ITK there is a line that says so.
mkdir alone && cp "$TREPHINE" alone/trephine
expect 70 'trephine-itk: is missing' alone/trephine register ct.nrrd head/second/scan.nrrd "${quick[@]}" --output n.nrrd
