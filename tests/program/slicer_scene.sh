#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# D26. A case as one scene of 3D Slicer: read by VTK and numpy, and compared with the case, by slicer_scene.py.
. "$(dirname "$0")/common.sh"
: "${WRITE_CASE:?}"
python=
for p in python3 /usr/bin/python3; do
  "$p" -c 'import numpy, pydicom, vtkmodules' 2>/dev/null && { python=$p; break; }
done
[[ -n $python ]] || skip "no python3-vtk9, python3-numpy and python3-pydicom"
cd "$work"
export_() { "$TREPHINE" export --quiet "$@" 2>>log || { cat log >&2; fail "export $*"; }; }

for kind in minimal play spine; do
  "$WRITE_CASE" "$kind" $kind
  export_ $kind --format slicer-mrb --out out
  name=$(basename out/*.mrb .mrb)
  "$python" "$SOURCE/tests/program/slicer_scene.py" $kind out/"$name".mrb "$SOURCE" || fail "the scene of $kind"
  "$python" "$SOURCE/examples/slicer_scene/list_scene.py" out/"$name".mrb >$kind.txt || fail "the example, of $kind"
  mv out/"$name".mrb $kind.mrb
done
grep -q '^model skull: colour 0.8 0.8 0.8, opacity 1, in LPS$' play.txt || { cat play.txt; fail "no model in the example"; }
grep -Eq '^segment skull: Skull \(SCT 89546000\), [0-9.]+ ml$' play.txt || { cat play.txt; fail "no code in the example"; }
grep -Eq '^volume ct: \([0-9, ]+\) voxels, HU' spine.txt || { cat spine.txt; fail "no CT in the example"; }
grep -q '^landmarks kocher_right: -1.00 20.00 340.50 mm RAS$' play.txt || { cat play.txt; fail "no landmark in the example"; }
[[ $(wc -l <"$SOURCE/examples/slicer_scene/list_scene.py") -lt 60 ]] || fail "the example is too long"

# The CT comes back by our own reader of such scenes.
"$TREPHINE" import spine.mrb --volume-values hu --output back.nrrd --quiet 2>>log || { cat log >&2; fail "import"; }
"$python" - "$SOURCE/examples/python_reader" <<'PY' || fail "another CT"
import sys
import numpy as np
sys.path.insert(0, sys.argv[1])
import read_case
header, voxels = open("back.nrrd", "rb").read().split(b"\n\n", 1)
ct = read_case.load("spine").ct
assert b"encoding: raw" in header and (np.frombuffer(voxels, "<i2").reshape(ct.voxels.shape) == ct.voxels).all()
origin = [l for l in header.decode().splitlines() if l.startswith("space origin")][0]
assert np.allclose([float(c) for c in origin.split("(")[1].rstrip(")").split(",")], ct.origin), origin
PY

# The same bytes again, wherever and with however many threads; names and anatomies as they are asked for.
TZ=Asia/Tokyo LC_ALL=C.UTF-8 export_ spine --format slicer-mrb --threads 1 --out again
cmp spine.mrb again/*.mrb || fail "two exports differ"
export_ play --format slicer-mrb,vtp --anatomy scalp,brain --name two --out some
[[ -s some/two.mrb && -s some/brain.vtp && $(unzip -l some/two.mrb | grep -c '\.vtp$') == 2 ]] || fail "two anatomies"

expect 64 '^.*--anatomy: skul: did you mean skull' "$TREPHINE" export --quiet play --format slicer-mrb --anatomy skul --out refused
expect 64 'INPUT: must be a case' "$TREPHINE" export --quiet some/brain.vtp --format slicer-mrb --out refused
expect 66 '' "$TREPHINE" export --quiet none --format slicer-mrb --out refused
[[ ! -e refused ]] || fail "something of a refused export is there"
