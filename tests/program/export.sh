#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A case in the formats of other programs: every file is there and says the case's own triangles, the same bytes whatever
# the threads, and what cannot be done is refused with its exit code and leaves nothing. LONG=1: on the scan's own voxels.
. "$(dirname "$0")/common.sh"
export_() { "$TREPHINE" export --quiet "$@"; }
# Three anatomies, each in every format; on the scan's own voxels all that the sample has.
config=$SOURCE/configs/sample.yaml
if ((LONG == 0)); then
  printf 'trephine: 1\nanatomies: {skin: {}, brain: {}, ventricles: {}}\nface: {policy: keep, reason: a phantom}\n' >"$work/scene.yaml"
  sed "s,^scene: .*,scene: scene.yaml,; s,: \.\./,: $SOURCE/," "$config" >"$work/small.yaml"
  config=$work/small.yaml coarse=("${coarsest[@]:0:2}")  # without a haptic volume
fi
"$TREPHINE" run --quiet "$config" --root "$SOURCE" --out "$work/library" "${coarse[@]}" --no-pictures --no-page >"$work/run.log" 2>&1 ||
  { cat "$work/run.log" >&2; fail "no case to export"; }
case=$work/library/sample

export_ "$case" --format stl,ply,obj,vtp,vtk,wrl --format x3d,glb,3mf --texture-coordinates skin --out "$work/a" \
  --report "$work/report.json"
TZ=Asia/Tokyo LC_ALL=C.UTF-8 export_ "$case" --format stl,ply,obj,vtp,vtk,wrl,x3d,glb,3mf --texture-coordinates skin \
  --out "$work/b" --threads 1
diff -r "$work/a" "$work/b" || fail "two exports differ"
python3 - "$case" "$work" <<'PY'
import json, pathlib, struct, sys, zipfile
case, work = map(pathlib.Path, sys.argv[1:])
manifest = json.loads((case / "case.json").read_bytes())
report = json.loads((work / "report.json").read_bytes())
names = [a["name"] for a in manifest["anatomies"] if a.get("file")]
assert names
for a in manifest["anatomies"]:
    if not a.get("file"):
        continue
    name, count = a["name"], a["triangles"]
    stl = (work / "a" / f"{name}.stl").read_bytes()
    assert struct.unpack_from("<I", stl, 80)[0] == count and len(stl) == 84 + 50 * count and b"SPACE=LPS" in stl[:80]
    assert f"element face {count}\n".encode() in (work / "a" / f"{name}.ply").read_bytes()[:2000]
    obj = (work / "a" / f"{name}.obj").read_text().splitlines()
    assert sum(line.startswith("f ") for line in obj) == count
    kd = [line for line in (work / "a" / f"{name}.mtl").read_text().splitlines() if line.startswith("Kd")][0].split()[1:]
    assert all(abs(float(k) - c) < 1e-5 for k, c in zip(kd, a["colour_rgb"]))
    # The case's own GLB again, but for the last bit of some normals.
    ours, theirs = (work / "a" / f"{name}.glb").read_bytes(), (case / a["file"]).read_bytes()
    assert len(ours) == len(theirs) and sum(x != y for x, y in zip(ours, theirs)) < 0.01 * len(ours)
    assert any(line.startswith("vt ") for line in obj) == (name == "skin")
    model = zipfile.ZipFile(work / "a" / f"{name}.3mf").read("3D/3dmodel.model").decode()
    assert 'unit="millimeter"' in model and "SPACE=LPS UNIT=mm" in model and f'name="{name}"' in model
    assert 'displaycolor="#%02X%02X%02X' % tuple(round(255 * c) for c in a["colour_rgb"]) in model
    assert model.count("<triangle ") == count
    for f in "stl ply obj vtp vtk wrl x3d glb 3mf".split():
        assert report[f"{name}.{f}.triangles_count"] == count
        assert report[f"{name}.{f}.reread_difference_mm"] < 1e-3
assert len(list((work / "a").iterdir())) == 10 * len(names)
PY

export_ "$case" --format x3d,obj --together --out "$work/one"
[[ $(ls "$work/one") == $'sample.mtl\nsample.obj\nsample.x3d' ]] || fail "--together wrote $(ls "$work/one")"
export_ "$work/a/skin.stl" --format vtp --name face --colour-rgb 1,0,0 --out "$work/back"
[[ -s $work/back/face.vtp ]] || fail "a surface file was not exported"

# Labels, from the fields of the tools.
"$TREPHINE" import --quiet "$SOURCE/sample_dicom" --output "$work/volume.nrrd" 2>/dev/null
for level in -475 300; do
  "$TREPHINE" segment --quiet "$work/volume.nrrd" --lower-hu $level --output "$work/f$level.nrrd" 2>/dev/null
done
export_ --format seg.nrrd --labels "skin=$work/f-475.nrrd,skull=$work/f300.nrrd" --out "$work/labels" --name head
head -c 2000 "$work/labels/head.seg.nrrd" | grep -aq '^Segment1_Name:=skull$' || fail "no key of the second segment"

export_ --format nii.gz --labels "skin=$work/f-475.nrrd,skull=$work/f300.nrrd" --out "$work/labels" --name head
[[ $(tail -n 1 "$work/labels/head.labels.txt") == *'"skull"' ]] || fail "no name of the second label"
# The same voxels, whichever the format: a label of each as a field again.
for format in seg.nrrd nii.gz; do
  "$TREPHINE" labels --quiet "$work/volume.nrrd" --file "$work/labels/head.$format" --label 2 \
    --output "$work/back.$format.nrrd" 2>/dev/null
done
cmp "$work/back.seg.nrrd.nrrd" "$work/back.nii.gz.nrrd" || fail "the labels of seg.nrrd and nii.gz differ"

# Points as markups of 3D Slicer: given to a run again they stay where they are, and so does the case.
export_ "$case" --format mrk.json --out "$work/points"
"$TREPHINE" run --quiet "$config" --root "$SOURCE" --landmarks "$work/points/landmarks.mrk.json" --out "$work/again" \
  "${coarse[@]}" --no-pictures --no-page --cache "$work/library/.trephine-cache" >"$work/run.log" 2>&1 || { cat "$work/run.log" >&2; fail "no case of given landmarks"; }
"$TREPHINE" diff --quiet "$case" "$work/again/sample" --max-point-mm 1e-6 --max-deviation-mm 1e-6 --json "$work/diff.json"
python3 - "$case" "$work/points" "$work/diff.json" <<'PY'
import json, pathlib, sys
case, points = map(pathlib.Path, sys.argv[1:3])
manifest = json.loads((case / "case.json").read_bytes())
for name in ("landmarks", "targets"):
    if not manifest[name]:
        assert not (points / f"{name}.mrk.json").exists()
        continue
    markup = json.loads((points / f"{name}.mrk.json").read_bytes())["markups"]
    assert len(markup) == 1 and markup[0]["coordinateSystem"] == "LPS" and markup[0]["type"] == "Fiducial"
    assert {p["label"]: p["position"] for p in markup[0]["controlPoints"]} == {
        p["name"]: p["position_mm"] for p in manifest[name]}
for hole in manifest["burr_holes"]:
    markup = json.loads((points / f"trajectory-{hole['name']}.mrk.json").read_bytes())["markups"][0]
    a, b = (p["position"] for p in markup["controlPoints"])
    length = sum((y - x) ** 2 for x, y in zip(a, b)) ** 0.5
    assert markup["type"] == "Line" and a == hole["position_mm"] and 1 < length < 200
    assert all(abs((y - x) / length - d) < 1e-9 for x, y, d in zip(a, b, hole["direction"]))
assert manifest["landmarks"]
said = json.load(open(sys.argv[3]))
assert all(a["same_bytes"] for a in said["anatomies"]), said["anatomies"]
assert all(p["name"].startswith("given_landmarks.") for p in said["parameters"]), said["parameters"]
PY

refused() { expect "$@" --out "$work/no"; }
refused 64 '--format: .*did you mean' "$TREPHINE" export --quiet "$case" --format stll
refused 64 '--anatomy: brian: did you mean brain' "$TREPHINE" export --quiet "$case" --format stl --anatomy brian
refused 64 'stl holds one surface' "$TREPHINE" export --quiet "$case" --format stl --together
refused 64 'INPUT' "$TREPHINE" export --quiet --format stl
refused 64 'INPUT: must be a case' "$TREPHINE" export --quiet "$work/a/skin.stl" --format mrk.json
refused 64 'seg.nrrd' "$TREPHINE" export --quiet "$case" --format seg.nrrd
refused 66 'none.stl' "$TREPHINE" export --quiet "$work/none.stl" --format ply
head -c 5000 "$work/a/skin.stl" >"$work/cut.stl"
refused 65 'cut.stl: ' "$TREPHINE" export --quiet "$work/cut.stl" --format ply
python3 - "$work/a/skin.stl" "$work/open.stl" <<'PY'
import struct, sys
b = open(sys.argv[1], "rb").read()
open(sys.argv[2], "wb").write(b[:80] + struct.pack("<I", struct.unpack_from("<I", b, 80)[0] - 1) + b[84:-50])
PY
refused 80 'open: not a valid surface' "$TREPHINE" export --quiet "$work/open.stl" --format ply
printf 'x' | dd of="$case/$(cd "$case" && ls meshes/skin*.glb)" bs=1 seek=3000 conv=notrunc status=none
refused 65 'skin' "$TREPHINE" export --quiet "$case" --format stl
[[ ! -e $work/no ]] || fail "a refused export left a folder"
