#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# trephine diff: two versions of a case, cases of other anatomies, limits, and cases that are damaged; and the reader in
# Python (examples/python_reader), which must find what case.json says.
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/a"
"$WRITE_CASE" "$work/drill" drill
cp -r "$work/a" "$work/same"

"$TREPHINE" diff --quiet "$work/a" "$work/same" --max-deviation-mm 0.001 --max-point-mm 0.001 >"$work/said"
[[ ! -s $work/said ]] || fail "--quiet is not quiet"
"$TREPHINE" diff "$work/a" "$work/same" 2>/dev/null | grep -q 'are the same' || fail "equal cases are not said to be equal"

"$TREPHINE" diff "$work/a" "$work/drill" --json "$work/1.json" --threads 1 >"$work/1.txt" 2>/dev/null
"$TREPHINE" diff "$work/a" "$work/drill" --json "$work/2.json" --threads 2 >"$work/2.txt" 2>/dev/null
cmp "$work/1.json" "$work/2.json" && cmp "$work/1.txt" "$work/2.txt" || fail "two comparisons differ"
grep -Eq '^skull .*is not in the old case$' "$work/1.txt" || fail "an anatomy of the new case alone is not said"
grep -Eq '^kocher_right +landmark +- ' "$work/1.txt" || fail "a landmark of the new case alone is not said"
python3 - "$work/1.json" <<'PY'
import json, sys
said = json.load(open(sys.argv[1]))
assert [(a["name"], a["in"]) for a in said["anatomies"]] == [
    ("outer", "only_old"), ("inner", "only_old"), ("skull", "only_new"), ("brain", "only_new")], said["anatomies"]
assert {p["name"]: p["moved_mm"] for p in said["points"]} == {
    "nasion": 0, "kocher_right": None, "middle": 0, "entry": 0}, said["points"]
assert said["parameters"] == [] and not said["identical"]
PY

expect 80 'diff: .*drill: outer is not in the new case \(and 3 more\)' \
  "$TREPHINE" diff --quiet "$work/a" "$work/drill" --max-deviation-mm 0.5
expect 80 'kocher_right is not in the old case' "$TREPHINE" diff --quiet "$work/a" "$work/drill" --max-point-mm 5

# Two libraries: a line for each case; one that is damaged does not stop the others.
mkdir -p "$work/old" "$work/new"
cp -r "$work/a" "$work/old/sample"
cp -r "$work/a" "$work/old/gone"
cp -r "$work/a" "$work/old/torn"
cp -r "$work/drill" "$work/new/sample"
cp -r "$work/a" "$work/new/torn"
"$TREPHINE" diff "$work/old" "$work/old" --max-deviation-mm 0.001 2>/dev/null | grep -c ' the same$' | grep -qx 3 || fail "equal libraries"
expect 80 'gone: is not in the new library \(and 4 more\)' "$TREPHINE" diff --quiet "$work/old" "$work/new" --max-deviation-mm 1
truncate -s -1 "$work/new/torn/$(cd "$work/new/torn" && ls meshes/inner*.glb)"
got=0
"$TREPHINE" diff "$work/old" "$work/new" --json "$work/libraries.json" >"$work/said" 2>"$work/stderr" || got=$?
[[ $got == 65 ]] && grep -Eq '^gone .*only in the old library$' "$work/said" && grep -Eq '^torn .*meshes/inner' "$work/said" &&
  grep -Eq '^sample .*skull is not in the old case' "$work/said" || { cat "$work/said" "$work/stderr"; fail "two libraries ($got)"; }
python3 - "$work/libraries.json" <<'PY'
import json, sys
cases = json.load(open(sys.argv[1]))["cases"]
assert [c["case"] for c in cases] == ["gone", "sample", "torn"], cases
assert cases[0]["in"] == "only_old" and "meshes/inner" in cases[2]["fault"]
assert cases[1]["comparison"]["anatomies"][0]["name"] == "outer"
PY

expect 66 'nowhere' "$TREPHINE" diff --quiet "$work/a" "$work/nowhere"
printf 'x' | dd of="$work/same/$(cd "$work/same" && ls meshes/outer*.glb)" bs=1 seek=700 conv=notrunc status=none
expect 65 'meshes/outer' "$TREPHINE" diff --quiet "$work/a" "$work/same"

# The reader in Python.
python=/usr/bin/python3
"$python" -c 'import numpy' 2>/dev/null || skip "no numpy"
reader=$SOURCE/examples/python_reader/read_case.py
"$python" "$reader" "$work/a" >"$work/said"
grep -q '^outer: 168 triangles, ' "$work/said" || fail "the reader in Python does not list the surfaces"
"$python" - "$SOURCE" "$work/a" "$work/drill" <<'PY'
import sys
sys.path.insert(0, sys.argv[1] + "/examples/python_reader")
sys.dont_write_bytecode = True
import numpy as np
import read_case
for folder in sys.argv[2:]:
    case = read_case.load(folder)
    m = case.manifest
    assert len(case.surfaces) == len(m["anatomies"]) == 2
    for a in m["anatomies"]:
        s = case.surfaces[a["name"]]
        assert len(s.triangles) == a["triangles"] and len(s.points) == a["points"]
        assert abs(s.volume_ml() / a["volume_ml"] - 1) < 1e-5 and abs(s.area_cm2() / a["area_cm2"] - 1) < 1e-5
        assert np.abs(s.points.mean(axis=0) - m["center_mm"]).max() < 10
    v = case.haptic
    assert list(v.voxels.shape[::-1]) == m["haptic"]["size"] and v.voxels.dtype == np.int16
    assert np.allclose(np.linalg.norm(v.axes, axis=1), m["haptic"]["spacing_mm"])
    assert case.hardness.voxels.shape == v.voxels.shape and case.ct is None
    # The middle of the volume lies in the innermost shape, whose voxels have its middle as their mean.
    n = np.array(v.voxels.shape[::-1])
    assert np.abs(v.position(*((n - 1) / 2)) - m["center_mm"]).max() < 1e-9
    inner = np.argwhere(case.shape(m["haptic"]["shapes"][-1]["name"]))[:, ::-1]
    assert np.abs(v.origin + inner.mean(axis=0) @ v.axes - m["center_mm"]).max() < 1.1 * np.linalg.norm(v.axes[0])
PY
got=0
"$python" "$reader" "$work/same" >/dev/null 2>"$work/stderr" || got=$?
[[ $got == 65 ]] && grep -q 'outer.*is not what case.json says' "$work/stderr" || fail "the reader in Python takes a damaged surface"
sed -i 's/"nasion"/"nasioN"/' "$work/drill/case.json"
got=0
"$python" "$reader" "$work/drill" >/dev/null 2>"$work/stderr" || got=$?
[[ $got == 65 ]] && grep -q 'checksum' "$work/stderr" || fail "the reader in Python takes an edited case.json"
