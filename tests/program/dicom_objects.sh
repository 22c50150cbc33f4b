#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# D23 to D25. A case as DICOM objects, on tilted and uneven slices: read by pydicom and dcmtk, checked by dicom3tools, and compared with the
# surfaces by this script's own arithmetic. LONG=1: also on upright slices, with a correction that is painted on them, and
# through an archive (Orthanc).
. "$(dirname "$0")/common.sh"
for tool in dciodvfy dcmdump dcmj2pnm dcmdjpls; do command -v "$tool" >/dev/null || skip "no $tool (packages dcmtk and dicom3tools)"; done
python=
for p in python3 /usr/bin/python3; do
  "$p" -c 'import numpy, pydicom' 2>/dev/null && { python=$p; break; }
done
[[ -n $python ]] || skip "no python3-pydicom"
coarsest=(--set "resample.spacing_mm=[3.5,3.5,3.5]")  # in the long suite too, but for the upright case
export_() { "$TREPHINE" export --quiet "$@" 2>>"$work/log" || { cat "$work/log" >&2; fail "export $*"; }; }

# The sample's slices as a tilted gantry places them; of the lower half every second one, of the upper every third.
mkdir -p "$work/tilted"
for f in "$SOURCE"/sample_dicom/*.dcm; do dcmdjpls "$f" "$work/tilted/$(basename "$f")"; done
"$python" - "$work/tilted" <<'PY'
import math, pathlib, pydicom, sys
files = sorted(pathlib.Path(sys.argv[1]).iterdir(), key=lambda f: float(pydicom.dcmread(f).ImagePositionPatient[2]))
for n, f in enumerate(files):
    d = pydicom.dcmread(f)
    x, y, z = map(float, d.ImagePositionPatient)
    d.SeriesInstanceUID += ".1"
    d.SOPInstanceUID += ".1"
    d.ImagePositionPatient = [x, round(y + math.tan(math.radians(12)) * (z - 40), 4), z]
    d.save_as(f)
    if n % (2 if n < len(files) / 2 else 3):
        f.unlink()
PY

# case_of NAME SCENE SERIES: a case of the series.
case_of() {
  printf 'trephine: 1\nanatomies: {skin: {}, brain: {}}\n%sface: {policy: keep, reason: a phantom}\n' "$2" >"$work/scene.yaml"
  sed "s,^scene: .*,scene: scene.yaml,; s,: \.\./,: $SOURCE/,; s,^series: .*,series: $3," "$SOURCE/configs/sample.yaml" >"$work/config.yaml"
  "$TREPHINE" run --quiet "$work/config.yaml" --root / --out "$work/library" --case "$1" --no-pictures --no-page \
    "${coarsest[@]}" >"$work/run.log" 2>&1 || { cat "$work/run.log" >&2; fail "no case to export"; }
}
# With canaries in names, IDs, dates and UIDs: what is written and printed must have none of them.
canaries=$SOURCE/tests/program/canaries.py scan=$work/CANARYSCAN^ERIKA
python3 "$canaries" put "$work/tilted" "$scan"
case_of tilted $'ct: {}\n' "$scan"
case=$work/library/tilted
all=dicom-seg,dicom-stl,dicom-ct,dicom-rtss

export_ "$case" --format $all --series "$scan" --out "$work/a"
TZ=Asia/Tokyo LC_ALL=C.UTF-8 export_ "$case" --format $all --series "$scan" --out "$work/b" --threads 1
diff -r "$work/a" "$work/b" || fail "two exports differ"
for f in "$work"/a/*.dcm "$work/a/dicom-ct/ct_0020.dcm"; do
  dciodvfy "$f" >"$work/said" 2>&1 || true
  ! grep -a '^Error' "$work/said" || fail "dciodvfy finds fault with $(basename "$f")"
  dcmdump "$f" >"$work/dump" 2>"$work/said" || fail "dcmdump does not read $(basename "$f")"
  [[ ! -s $work/said ]] || { cat "$work/said" >&2; fail "dcmdump warns of $(basename "$f")"; }
done
dcmj2pnm --write-png --set-window 40 400 "$work/a/dicom-ct/ct_0020.dcm" "$work/ct.png" && [[ -s $work/ct.png ]] ||
  fail "dcmj2pnm draws no CT"
dcmj2pnm --frame 30 "$work/a/tilted.seg.dcm" "$work/seg.pgm" && [[ -s $work/seg.pgm ]] || fail "dcmj2pnm draws no SEG"
export_ "$case" --format stl --out "$work/stl"
cat >"$work/check.py" <<'PY'
import json, pathlib, sys, zlib
import numpy as np, pydicom
from pydicom.sr._concepts_dict import concepts
case, objects, scan, stl = map(pathlib.Path, sys.argv[1:5])
manifest = json.loads((case / "case.json").read_bytes())
name = manifest["case"]
ct_file = manifest["ct"]["file"]
read = pydicom.dcmread
source = sorted((read(f) for f in scan.iterdir()), key=lambda d: float(d.ImagePositionPatient[2]))
images = [read(f) for f in sorted((objects / "dicom-ct").iterdir())]
seg, rtss = read(objects / f"{name}.seg.dcm"), read(objects / f"{name}.rtss.dcm")
models = {f.name.split(".")[0]: read(f) for f in objects.glob("*.stl.dcm")}

# One patient, study and frame of reference, none of them the source's; nothing of the source's identity.
made = [*images, seg, rtss, *models.values()]
assert len({(d.PatientID, d.PatientName, d.StudyInstanceUID, d.FrameOfReferenceUID) for d in made}) == 1
assert made[0].PatientID == name and len({d.SOPInstanceUID for d in made}) == len(made)
secret = {str(v) for d in source for v in (d.SOPInstanceUID, d.SeriesInstanceUID, d.StudyInstanceUID, d.FrameOfReferenceUID,
                                           d.PatientName, d.PatientID)}
for f in objects.rglob("*.dcm"):
    text = f.read_bytes()
    assert not [s for s in secret if s.encode() in text], f

# The images lie on the scan's own slices and show the case's CT there, interpolated linearly.
header, data = (case / manifest["ct"]["file"]).read_bytes().split(b"\n\n", 1)
field = dict(line.split(": ", 1) for line in header.decode().splitlines() if ": " in line)
vectors = lambda text: np.array([[float(c) for c in v.strip("()").split(",")] for v in text.split()])
ct = np.frombuffer(zlib.decompress(data, 31), "<i2").reshape([int(n) for n in field["sizes"].split()][::-1]).astype(float)
axes, origin = vectors(field["space directions"]), vectors(field["space origin"])[0]
assert len(images) == len(source)
off_ct = compared = same = 0
for number, (a, b) in enumerate(zip(images, source)):
    assert np.allclose(a.ImagePositionPatient, b.ImagePositionPatient, atol=1e-6), (a.ImagePositionPatient, b.ImagePositionPatient)
    assert np.allclose(a.ImageOrientationPatient, b.ImageOrientationPatient) and list(a.PixelSpacing) == list(b.PixelSpacing)
    if number % 3:
        continue
    o, u, v = (np.array(x, float) for x in (a.ImagePositionPatient, a.ImageOrientationPatient[:3], a.ImageOrientationPatient[3:]))
    sy, sx = map(float, a.PixelSpacing)
    j, i = np.mgrid[:a.Rows, :a.Columns]
    q = (o + i[..., None] * sx * u + j[..., None] * sy * v - origin) @ np.linalg.inv(axes)
    inside = ((q >= 0.02) & (q <= np.array(ct.shape[::-1]) - 1.02)).all(-1)
    low = np.floor(q[inside]).astype(int)
    part = q[inside] - low
    truth = 0
    for corner in np.ndindex(2, 2, 2):
        w = np.prod(np.where(corner, part, 1 - part), 1)
        truth = truth + w * ct[tuple((low + corner)[:, ::-1].T)]
    off_ct = max(off_ct, np.abs(truth - a.pixel_array[inside]).max(initial=0))
    compared += inside.sum()
    outside = ((q < -0.02) | (q > np.array(ct.shape[::-1]) - 0.98)).any(-1)
    assert (a.pixel_array[outside] == -1000).all()
    same += (a.pixel_array == b.pixel_array * float(b.RescaleSlope) + float(b.RescaleIntercept))[inside].sum()
assert compared > 100000 and off_ct < 3  # HU are whole, and a place within 0.001 voxels of a voxel has its value
if len(sys.argv) > 5:  # of upright slices, without resampling: the scan's own HU, but for apparatus around the head
    assert same > 0.97 * compared, same / compared

# The surface of the encapsulated STL is ours, bit for bit; its section with a slice says which pixels are the segment's.
def triangles(document):
    n = int.from_bytes(document[80:84], "little")
    t = np.frombuffer(document[84:84 + 50 * n], dtype=np.dtype([("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")]))
    return t["p"].astype(float)
shapes = {}
for anatomy, d in models.items():
    document = d.EncapsulatedDocument[:d.EncapsulatedDocumentLength]
    assert document == (stl / f"{anatomy}.stl").read_bytes(), anatomy
    shapes[anatomy] = triangles(document)

def section(t, d):
    """Ends of the segments in which the triangles meet the slice, in pixels; and the places in mm."""
    o, u, v = (np.array(x, float) for x in (d.ImagePositionPatient, d.ImageOrientationPatient[:3], d.ImageOrientationPatient[3:]))
    h = (t - o) @ np.cross(u, v)
    up = h >= 0
    cut = t[(up.any(1)) & (~up.all(1))], h[(up.any(1)) & (~up.all(1))]
    ends = []
    for p, q in zip(*cut):
        s = [p[i] + (p[j] - p[i]) * (q[i] / (q[i] - q[j])) for i, j in ((0, 1), (1, 2), (2, 0)) if (q[i] >= 0) != (q[j] >= 0)]
        ends.append(s)
    ends = np.array(ends).reshape(-1, 2, 3)
    sy, sx = map(float, d.PixelSpacing)
    return np.stack([(ends - o) @ u / sx, (ends - o) @ v / sy], -1), ends

def parity(ends, rows, columns):
    flips = np.zeros((rows, columns + 1), int)
    nearest = np.full((rows, columns), 1e9)
    for (ax, ay), (bx, by) in ends:
        lo, hi = min(ay, by), max(ay, by)
        for j in range(max(0, int(np.ceil(lo))), min(rows, int(np.ceil(hi)))):
            x = ax + (j - ay) * (bx - ax) / (by - ay)
            flips[j, min(columns, max(0, int(np.ceil(x))))] += 1
            if 0 <= round(x) < columns:
                nearest[j, round(x)] = min(nearest[j, round(x)], abs(x - round(x)))
    return np.cumsum(flips, 1)[:, :columns] % 2 == 1, nearest < 1e-4

bits = np.unpackbits(np.frombuffer(seg.PixelData, np.uint8), bitorder="little")[:seg.NumberOfFrames * seg.Rows * seg.Columns]
frames = bits.reshape(-1, seg.Rows, seg.Columns)
by_uid = {d.SOPInstanceUID: d for d in images}
number = {s.SegmentLabel: s.SegmentNumber for s in seg.SegmentSequence}
frame_of = {}
for n, f in enumerate(seg.PerFrameFunctionalGroupsSequence):
    image = by_uid[f.DerivationImageSequence[0].SourceImageSequence[0].ReferencedSOPInstanceUID]
    assert list(f.PlanePositionSequence[0].ImagePositionPatient) == list(image.ImagePositionPatient)
    frame_of[f.SegmentIdentificationSequence[0].ReferencedSegmentNumber, image.SOPInstanceUID] = frames[n]
assert {d.SOPInstanceUID for d in images} == {r.ReferencedSOPInstanceUID for r in seg.ReferencedSeriesSequence[0].ReferencedInstanceSequence}
wrong = pixels = 0
empty = np.zeros((seg.Rows, seg.Columns))
for anatomy, t in shapes.items():
    for image in images[::3]:
        inside, on_edge = parity(section(t, image)[0], seg.Rows, seg.Columns)
        is_ = frame_of.get((number[anatomy], image.SOPInstanceUID), empty) == 1
        wrong += ((inside != is_) & ~on_edge).sum()
        pixels += inside.sum()
assert wrong == 0 and pixels > 5000, (wrong, pixels)

# Names, codes as DICOM's own dictionary has them, colours to the last digit of a screen.
codes = {code: meanings for of in concepts["SCT"].values() for code, meanings in of.items()}
def rgb(lab):
    l, a, b = lab[0] / 655.35, lab[1] / 257 - 128, lab[2] / 257 - 128
    y = (l + 16) / 116
    g = lambda t: t ** 3 if t ** 3 > 216 / 24389 else (116 * t - 16) * 27 / 24389
    xyz = np.array([0.95047 * g(y + a / 500), g(y), 1.08883 * g(y - b / 200)])
    c = np.array([[3.2404542, -1.5371385, -.4985314], [-.969266, 1.8760108, .041556], [.0556434, -.2040259, 1.0572252]]) @ xyz
    return np.where(c <= .0031308, 12.92 * c, 1.055 * np.maximum(c, 1e-9) ** (1 / 2.4) - .055)
colours = {a["name"]: a["colour_rgb"] for a in manifest["anatomies"]}
for s in seg.SegmentSequence:
    c = s.SegmentedPropertyTypeCodeSequence[0]
    assert c.CodingSchemeDesignator == "SCT" and c.CodeValue in codes, c
    assert np.abs(rgb(s.RecommendedDisplayCIELabValue) - colours[s.SegmentLabel]).max() < 0.5 / 255
assert sorted(number) == sorted(colours)

# Contours lie on the slices and on the surfaces' sections, and enclose as much.
roi = {r.ROINumber: r.ROIName for r in rtss.StructureSetROISequence}
assert sorted(roi.values()) == sorted(colours)
off = off_plane = worst_area = 0
for r in rtss.ROIContourSequence:
    anatomy = roi[r.ReferencedROINumber]
    assert [int(c) for c in r.ROIDisplayColor] == [round(255 * c) for c in colours[anatomy]]
    area = {}
    for n, c in enumerate(r.ContourSequence):
        image = by_uid[c.ContourImageSequence[0].ReferencedSOPInstanceUID]
        p = np.array(c.ContourData, float).reshape(-1, 3)
        o, u, v = (np.array(x, float) for x in (image.ImagePositionPatient, image.ImageOrientationPatient[:3], image.ImageOrientationPatient[3:]))
        off_plane = max(off_plane, np.abs((p - o) @ np.cross(u, v)).max())
        x, y = (p - o) @ u, (p - o) @ v
        area[image.SOPInstanceUID] = area.get(image.SOPInstanceUID, 0) + (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
        if anatomy in shapes and n % 7 == 0:
            ends = section(shapes[anatomy], image)[1].reshape(-1, 3)
            for q in p[::11]:
                off = max(off, np.sqrt(((ends - q) ** 2).sum(1)).min())
    for image in images[::7]:
        if anatomy not in shapes:
            continue
        (e, _) = section(shapes[anatomy], image)
        sy, sx = map(float, image.PixelSpacing)
        inside, _ = parity(e * 4, seg.Rows * 4, seg.Columns * 4)
        truth = inside.sum() * sx * sy / 16
        is_ = area.get(image.SOPInstanceUID, 0)
        if truth > 200:
            worst_area = max(worst_area, abs(is_ / truth - 1))
assert off_plane < 0.002 and off < 0.005 and worst_area < 0.03, (off_plane, off, worst_area)
print(f"{name}: {pixels} pixels of segments are the surfaces'; contours {off_plane:.4f} mm off their planes, {off:.4f} mm off the "
      f"surfaces, areas within {worst_area:.4f}; CT within {off_ct:.0f} HU of the case's at {compared} pixels")
PY
"$python" "$work/check.py" "$case" "$work/a" "$scan" "$work/stl"
python3 "$canaries" seek "$scan" "$work/a" || fail "the objects hold something of the patient"

# The example shows what lies on a slice.
"$python" "$SOURCE/examples/dicom_overlay/overlay.py" "$work/a" 20 "$work/overlay.ppm" >"$work/shown"
grep -q '^brain: Brain (SCT 12738006), [1-9]' "$work/shown" || fail "the example shows $(cat "$work/shown")"
[[ $(head -c 2 "$work/overlay.ppm") == P6 ]] || fail "no picture of the example"

# The source's own UIDs only where they are asked for, and then no CT is written.
export_ "$case" --format dicom-seg --series "$scan" --source-uids --out "$work/own"
[[ ! -e $work/own/dicom-ct ]] || fail "a CT beside objects that refer to the source's images"
"$python" - "$work/own/tilted.seg.dcm" "$scan" <<'PY'
import pathlib, pydicom, sys
seg, images = pydicom.dcmread(sys.argv[1]), [pydicom.dcmread(f) for f in pathlib.Path(sys.argv[2]).iterdir()]
d = images[0]
assert (seg.StudyInstanceUID, seg.FrameOfReferenceUID) == (d.StudyInstanceUID, d.FrameOfReferenceUID)
assert {r.ReferencedSOPInstanceUID for r in seg.ReferencedSeriesSequence[0].ReferencedInstanceSequence} == {d.SOPInstanceUID for d in images}
assert seg.PatientID == "tilted"
PY

# Read as labels, each segment is the anatomy again.
"$TREPHINE" import --quiet "$scan" --output "$work/volume.nrrd" 2>/dev/null
for object in seg rtss; do
  "$TREPHINE" labels --quiet "$work/volume.nrrd" --file "$work/a/tilted.$object.dcm" --label brain --output "$work/brain.nrrd" \
    --report "$work/$object.json" 2>>"$work/log" || { cat "$work/log" >&2; fail "labels of $object"; }
done
python3 - "$case" "$work" <<'PY'
import json, pathlib, sys
case, work = map(pathlib.Path, sys.argv[1:])
ml = {a["name"]: a["volume_ml"] for a in json.loads((case / "case.json").read_bytes())["anatomies"]}["brain"]
for name in ("seg", "rtss"):
    got = json.loads((work / f"{name}.json").read_text())["volume_ml"]
    assert abs(got / ml - 1) < 0.02, (name, got, ml)
PY

# Only the series that the case was made of, found also among others; and each refusal's remedy works.
mkdir "$work/many" && cp -r "$scan" "$work/many/own" && cp -r "$SOURCE/sample_dicom" "$work/many/other"
export_ "$case" --format dicom-seg --series "$work/many" --out "$work/many_out"
cmp "$work/many_out/tilted.seg.dcm" "$work/a/tilted.seg.dcm" || fail "another object from a folder of several series"
mkdir "$work/printed"
refused() { expect "$@" --out "$work/no"; cat "$work/stderr" >>"$work/printed/stderr"; [[ ! -e $work/no ]] || fail "a refused export left a folder"; }
refused 65 'series: .*input_sha256' "$TREPHINE" export --quiet "$case" --format dicom-seg --series "$SOURCE/sample_dicom"
refused 64 '--series: is needed for dicom-seg and dicom-rtss' "$TREPHINE" export --quiet "$case" --format dicom-rtss
refused 64 '--source-uids' "$TREPHINE" export --quiet "$case" --format dicom-stl --source-uids
for beside in dicom-ct dicom-stl; do
  refused 64 "--source-uids: .*$beside" "$TREPHINE" export --quiet "$case" --format "dicom-seg,$beside" --series "$scan" --source-uids
done
refused 64 '--series: is for dicom-seg' "$TREPHINE" export --quiet "$case" --format stl --series "$scan"
refused 64 'INPUT: must be a case' "$TREPHINE" export --quiet "$work/stl/skin.stl" --format dicom-stl
refused 66 'series: not found' "$TREPHINE" export --quiet "$case" --format dicom-seg --series "$work/CANARYNONE"
expect 65 'SegmentationType|SOPClassUID' "$TREPHINE" labels --quiet "$work/volume.nrrd" --file "$work/a/skin.stl.dcm" \
  --label skin --output "$work/x.nrrd"
case_of bare '' "$scan"
refused 65 'ct: .*--source-uids' "$TREPHINE" export --quiet "$work/library/bare" --format dicom-seg --series "$scan"
export_ "$work/library/bare" --format dicom-seg,dicom-rtss --series "$scan" --source-uids --out "$work/bare_out"
cp "$work/log" "$work/printed/" && python3 "$canaries" seek "$scan" "$work/printed" || fail "what is printed holds something of the patient"
((LONG == 1)) || exit 0

# Upright slices on the scan's own voxels: the CT is the scan's HU, and a correction painted on the segmentation comes back.
coarsest=()
mkdir "$work/upright"
for f in "$SOURCE"/sample_dicom/*.dcm; do dcmdjpls "$f" "$work/upright/$(basename "$f")"; done
case_of upright $'ct: {}\n' "$work/upright"
case=$work/library/upright scan=$work/upright
export_ "$case" --format $all --series "$scan" --out "$work/u"
export_ "$case" --format stl --out "$work/ustl"
"$python" "$work/check.py" "$case" "$work/u" "$scan" "$work/ustl" exact
"$python" - "$work/u/upright.seg.dcm" "$work/painted.dcm" <<'PY'
import numpy as np, pydicom, sys
d = pydicom.dcmread(sys.argv[1])
brain = [s.SegmentNumber for s in d.SegmentSequence if s.SegmentLabel == "brain"][0]
bits = np.unpackbits(np.frombuffer(d.PixelData, np.uint8), bitorder="little")
frames = bits[:d.NumberOfFrames * d.Rows * d.Columns].reshape(-1, d.Rows, d.Columns)
mine = [n for n, f in enumerate(d.PerFrameFunctionalGroupsSequence)
        if f.SegmentIdentificationSequence[0].ReferencedSegmentNumber == brain]
added = removed = 0
for n in mine[len(mine) // 2:len(mine) // 2 + 3]:
    box = frames[n, d.Rows // 2 - 4:d.Rows // 2 + 4, d.Columns // 2 - 6:d.Columns // 2 + 6]
    removed += int(box.sum())
    box[:] = 0
    corner = frames[n, :4, :4]
    added += int((corner == 0).sum())
    corner[:] = 1
d.PixelData = np.packbits(bits, bitorder="little").tobytes()
d.save_as(sys.argv[2])
print(f"{added} {removed}", file=open(sys.argv[2] + ".txt", "w"))
PY
"$TREPHINE" correction --quiet "$work/u/upright.seg.dcm" "$work/painted.dcm" --label brain --output "$work/correction.nrrd" \
  --report "$work/correction.json" 2>>"$work/log" || { cat "$work/log" >&2; fail "no correction of a painted segmentation"; }
python3 - "$work/correction.json" "$work/painted.dcm.txt" <<'PY'
import json, sys
said, (added, removed) = json.load(open(sys.argv[1])), map(int, open(sys.argv[2]).read().split())
assert (said["added_voxels_count"], said["removed_voxels_count"]) == (added, removed) and added and removed, (said, added, removed)
PY

# A face that the case's policy took off is not in the images either: they are read back and asked of the gate.
"$TREPHINE" phantom "$work/face" --quiet --encoding none --tilt-deg 12 --slice-step-mm 2 --upper-step-mm 3 --slice-thickness-mm 2 \
  --columns-count 160 --rows-count 184 --pixel-mm 1.45 --slices-count 90 >/dev/null
python3 - "$work" "$SOURCE" <<'PY'
import json, pathlib, sys
work, source = pathlib.Path(sys.argv[1]), sys.argv[2]
marks = json.loads((work / "face/truth/truth.json").read_text())["landmarks_mm"]
three = {name: marks[name] for name in ("nasion", "tragus_left", "tragus_right")}
(work / "face_scene.yaml").write_text("trephine: 1\nanatomies: {brain: {}}\nct: {margin_mm: 200}\nface: {policy: deface, believe: given, believe_reason: a phantom}\n")
(work / "face.yaml").write_text(f"trephine: 1\ncase: face\nseries: {work}/face/dicom\npipeline: {source}/pipelines/ventriculostomy.yaml\n"
                                f"scene: face_scene.yaml\nlandmarks: {json.dumps(three)}\n")
(work / "marks.json").write_text(json.dumps({
    "midsagittal": {"point_mm": three["nasion"], "normal": [1, 0, 0], "confidence": 1},
    "landmarks": [{"name": n, "position_mm": p, "confidence": 1, "source": "found"} for n, p in three.items()]}))
PY
"$TREPHINE" run --quiet "$work/face.yaml" --root / --out "$work/library" --no-pictures --no-page \
  --set "resample.spacing_mm=[2,2,2]" >"$work/run.log" 2>&1 ||
  { cat "$work/run.log" >&2; fail "no defaced case"; }
export_ "$work/library/face" --format dicom-ct --series "$work/face/dicom" --out "$work/f"
"$TREPHINE" import --quiet "$work/face/dicom" --output "$work/original.nrrd" 2>/dev/null
"$TREPHINE" import --quiet "$work/f/dicom-ct" --output "$work/exported.nrrd" 2>/dev/null
"$TREPHINE" segment --quiet "$work/original.nrrd" --lower-hu -475 --open-mm 3 --components largest --fill cavities --fill-close-mm 6 \
  --output "$work/skin.nrrd" 2>/dev/null
expect 81 'the CT' "$TREPHINE" face-gate --quiet "$work/skin.nrrd" --landmarks "$work/marks.json" --ct "$work/original.nrrd"
"$TREPHINE" face-gate --quiet "$work/skin.nrrd" --landmarks "$work/marks.json" --ct "$work/exported.nrrd" --report "$work/gate.json" ||
  fail "dicom-ct shows the face that the case does not"

# An archive that stores the objects gives them back as they were.
command -v Orthanc >/dev/null || skip "no Orthanc (package orthanc)"
"$python" - "$work" <<'PY'
import json, pathlib, socket, subprocess, sys, time, urllib.request
work = pathlib.Path(sys.argv[1])
free = []
for _ in range(2):
    s = socket.socket()
    s.bind(("127.0.0.1", 0))
    free.append(s)
http, dicom = (s.getsockname()[1] for s in free)
for s in free:
    s.close()
(work / "orthanc").mkdir()
(work / "orthanc.json").write_text(json.dumps({
    "Name": "test", "StorageDirectory": str(work / "orthanc"), "IndexDirectory": str(work / "orthanc"), "HttpPort": http,
    "DicomPort": dicom, "RemoteAccessAllowed": False, "AuthenticationEnabled": False, "Plugins": []}))
server = subprocess.Popen(["Orthanc", str(work / "orthanc.json")], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
ask = lambda path, data=None: urllib.request.urlopen(f"http://127.0.0.1:{http}{path}", data, 60).read()
try:
    for _ in range(100):
        try:
            ask("/system")
            break
        except OSError:
            time.sleep(0.2)
    files = sorted((work / "u").rglob("*.dcm"))
    for f in files:
        stored = json.loads(ask("/instances", f.read_bytes()))
        assert stored["Status"] == "Success", (f, stored)
        assert ask(f"/instances/{stored['ID']}/file") == f.read_bytes(), f
    assert len(json.loads(ask("/patients"))) == len(json.loads(ask("/studies"))) == 1
    kinds = sorted(json.loads(ask(f"/series/{s}"))["MainDicomTags"]["Modality"] for s in json.loads(ask("/series")))
    assert kinds == ["CT", "M3D", "M3D", "RTSTRUCT", "SEG"], kinds
    print(f"Orthanc stored {len(files)} objects of one study and gave them back")
finally:
    server.terminate()
    server.wait(20)
PY
