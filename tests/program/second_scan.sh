#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A second scan of the patient as its user registers it: transform, picture, refusals.
. "$(dirname "$0")/common.sh"
cd "$work"
[[ -n ${HEAD:-} ]] || bash "$SOURCE/tests/program/head_with_mr.sh" "${HEAD:=$work/head}"
[[ $HEAD == "$work/head" ]] || cp -r "$HEAD" head
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
head -c 400 mr.nrrd | grep -aq 'sizes: 120 120 90' || fail "not on the CT's voxels: $(head -c 400 mr.nrrd)"

# Doubtful: 80, the figure, the picture and nothing else.
rm -f mr.nrrd found.tfm check.png
expect 80 'doubtful: .*largest_inverse_mm' "$TREPHINE" register ct.nrrd head/second/scan.nrrd "${quick[@]}" \
  --largest-inverse-mm 0.01 --transform found.tfm --picture check.png --output mr.nrrd
[[ -e check.png && ! -e mr.nrrd && ! -e found.tfm ]] || fail "what a doubtful registration leaves: $(ls)"

# A transform of another program to begin with, and one that is none.
"$TREPHINE" register ct.nrrd head/second/scan.nrrd "${quick[@]}" --initial head/second/truth.tfm --output mr.nrrd
"$TREPHINE" register ct.nrrd head/second/scan.nrrd "${quick[@]}" --given head/second/truth.tfm --transform again.h5 --output mr1.nrrd 2>said
"$TREPHINE" register ct.nrrd head/second/scan.nrrd "${quick[@]}" --given again.h5 --transform again.tfm --output mr2.nrrd 2>said
cmp -s mr1.nrrd mr2.nrrd && cmp -s again.tfm head/second/truth.tfm || fail "HDF5 holds another transform: $(cat again.tfm)"

# A given transform that is 2 mm off in plane is found by the images; what the message says to do works.
python3 - head/second/truth.tfm >moved.tfm <<'PY'
import sys
lines = open(sys.argv[1]).read().splitlines()
values = [float(w) for w in lines[3].split()[1:]]
values[9] += 2 * 0.6
values[10] += 2 * 0.8
lines[3] = "Parameters: " + " ".join(map(repr, values))
print("\n".join(lines))
PY
expect 80 'leads up to [12].[0-9]* mm away .*largest_given_mm' "$TREPHINE" register ct.nrrd head/second/scan.nrrd "${quick[@]}" \
  --given moved.tfm --output moved.nrrd
[[ ! -e moved.nrrd ]] || fail "a transform that is 2 mm off was taken"
"$TREPHINE" register ct.nrrd head/second/scan.nrrd "${quick[@]}" --given moved.tfm --largest-given-mm 3 --output moved.nrrd 2>said
"$TREPHINE" register ct.nrrd head/second/scan.nrrd --given head/second/truth.tfm --output right.nrrd 2>said
grep -q 'the transform was given; the images agree' said || fail "not said: $(cat said)"

# The CT in other programs' formats comes back to the last bit, also out of a scene of 3D Slicer.
for ending in nii.gz mha gipl vtk mnc; do
  "$TREPHINE" convert ct.nrrd --output ct.$ending --quiet
  "$TREPHINE" import ct.$ending --volume-values hu --output back.nrrd --quiet 2>said
  cmp -s ct.nrrd back.nrrd || fail "$ending: $(cat said)"
done
cat >scene.mrml <<'XML'
<MRML version="Slicer4.4.0"><Volume id="v1" name="a" references="storage:s1;"></Volume>
<VolumeArchetypeStorage id="s1" fileName="ct.mha"></VolumeArchetypeStorage></MRML>
XML
"$TREPHINE" import scene.mrml --volume-values hu --output back.nrrd --quiet 2>said
cmp -s ct.nrrd back.nrrd || fail "scene: $(cat said)"
expect 64 'must end in one of' "$TREPHINE" convert ct.nrrd --output ct.img

# Labels go out and come back in each of the formats.
"$TREPHINE" segment ct.nrrd --lower-hu 226 --output bone.nrrd --quiet
"$TREPHINE" export --labels bone=bone.nrrd --format seg.nrrd,nii.gz,mha,gipl,mnc --out paint --quiet
for ending in seg.nrrd nii.gz mha gipl mnc; do
  "$TREPHINE" labels ct.nrrd --file paint/labels.$ending --label 1 --output label.nrrd --quiet
  [[ $ending != seg.nrrd ]] || cp label.nrrd first.nrrd
  cmp -s label.nrrd first.nrrd || fail "labels of $ending"
done
[[ -e paint/labels.labels.txt ]] || fail "no names beside the labels"
expect 65 'nothing of the label is different' "$TREPHINE" correction paint/labels.seg.nrrd paint/labels.mha --label 1 --output none.nrrd

printf '#Insight Transform File V1.0\nTransform: BSplineTransform_double_3_3\nParameters: 1\nFixedParameters: 0 0 0\n' >b.tfm
expect 65 'b.tfm: Transform: is no affine' "$TREPHINE" register ct.nrrd head/second/scan.nrrd --initial b.tfm --output n.nrrd

# Without the program that holds ITK there is a line that says so.
mkdir alone && cp "$TREPHINE" alone/trephine
expect 70 'trephine-itk: is missing' alone/trephine register ct.nrrd head/second/scan.nrrd "${quick[@]}" --output n.nrrd
