#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The round trip of a correction by hand: labels out, painted (by this script in the place of 3D Slicer and ITK-SNAP), taken
# out as a difference, applied by a configuration. It survives a rerun with another threshold and is listed in case.json.
. "$(dirname "$0")/common.sh"
mkdir "$work/root"
touch "$work/root/trephine.root"
cp -r "$SOURCE/pipelines" "$SOURCE/configs" "$work/root/"
cat >"$work/root/configs/head.yaml" <<'YAML'
trephine: 1
case: head
pipeline: ../pipelines/ventriculostomy.yaml
scene: scenes/skull.yaml
set: {skin.segment.fill: none, skin.segment.coarse_mm: 1.5, resample.spacing_mm: [2.5, 2.5, 2.5]}
YAML
run() { "$TREPHINE" run "$@" --series "$SOURCE/sample_dicom" --quiet --no-pictures --no-page >"$work/said" 2>&1 || { cat "$work/said"; fail "run $*"; }; }
run "$work/root/configs/head.yaml" --out "$work/out" --keep "$work/keep"

# paint FILE OUT: adds a block of 5 voxels a side outside of the skull, beside its rightmost voxel, and removes what lies in a
# block of 9 about its leftmost one, of label 1. It prints both counts.
cat >"$work/paint.py" <<'PY'
import gzip, struct, sys
source, out = sys.argv[1:3]
data = open(source, "rb").read()
if source.endswith(".nii.gz"):
    data = gzip.decompress(data)
    size, at = struct.unpack_from("<3h", data, 42), int(struct.unpack_from("<f", data, 108)[0])
    head, body = data[:at], bytearray(data[at:])
else:
    head, _, body = data.partition(b"\n\n")
    size = [int(n) for n in [l for l in head.split(b"\n") if l.startswith(b"sizes:")][0].split()[1:]]
    head, body = head + b"\n\n", bytearray(gzip.decompress(body))
nx, ny, nz = size
assert len(body) == nx * ny * nz
inside = [(n % nx, n // nx % ny, n // nx // ny) for n, v in enumerate(body) if v == 1]
low, high = min(inside), max(inside)
def block(middle, half):
    for k in range(middle[2] - half, middle[2] + half + 1):
        for j in range(middle[1] - half, middle[1] + half + 1):
            for i in range(middle[0] - half, middle[0] + half + 1):
                if 0 <= i < nx and 0 <= j < ny and 0 <= k < nz:
                    yield (k * ny + j) * nx + i
plus = minus = 0
for n in block(high, 2):
    plus += body[n] != 1
    body[n] = 1
for n in block(low, 4):
    minus += body[n] == 1
    body[n] = 0
open(out, "wb").write(gzip.compress(head + body) if source.endswith(".nii.gz") else head + gzip.compress(bytes(body)))
print(plus, minus)
PY
"$TREPHINE" export --quiet --format seg.nrrd,nii.gz --labels "skull=$work/keep/skull.segment.nrrd" --out "$work/labels"
for format in seg.nrrd nii.gz; do
  painted=$(python3 "$work/paint.py" "$work/labels/labels.$format" "$work/painted.$format")
  label=skull
  [[ $format == seg.nrrd ]] || label=1
  "$TREPHINE" correction "$work/labels/labels.$format" "$work/painted.$format" --label $label --output "$work/$format.correction.nrrd" \
    --report "$work/report.json" --quiet
  python3 - "$work/report.json" $painted <<'PY' || fail "the correction of $format is not what was painted"
import json, sys
said = json.load(open(sys.argv[1]))
assert [said["added_voxels_count"], said["removed_voxels_count"]] == [int(n) for n in sys.argv[2:]], (said, sys.argv)
assert min(said["added_voxels_count"], said["removed_voxels_count"]) > 20, said
PY
done
cmp "$work/seg.nrrd.correction.nrrd" "$work/nii.gz.correction.nrrd" || fail "the two formats give other corrections"
cp "$work/seg.nrrd.correction.nrrd" "$work/root/configs/skull_by_hand.nrrd"

# The configuration names it; the case lists it.
echo 'corrections: {skull: skull_by_hand.nrrd}' >>"$work/root/configs/head.yaml"
run "$work/root/configs/head.yaml" --out "$work/out2" --cache "$work/out/.trephine-cache" --keep "$work/keep2" --json "$work/run.json"
python3 - "$work/out/head/case.json" "$work/out2/head/case.json" "$work/root/configs/skull_by_hand.nrrd" "$work/run.json" <<'PY'
import hashlib, json, sys
before, after = (json.load(open(f)) for f in sys.argv[1:3])
p = {k: v for k, v in after["provenance"]["parameters"].items() if ".correct." in k}
assert p["skull.correct.file"] == "sha256 " + hashlib.sha256(open(sys.argv[3], "rb").read()).hexdigest(), p
assert p["skull.correct.added_ml"] > 0.3 and p["skull.correct.removed_ml"] > 0.3 and p["skull.correct.already_ratio"] == 0, p
volume = lambda m: [a["volume_ml"] for a in m["anatomies"] if a["name"] == "skull"][0]
expected = p["skull.correct.added_ml"] - p["skull.correct.removed_ml"]
assert abs(volume(after) - volume(before) - expected) < 0.35 * (p["skull.correct.added_ml"] + p["skull.correct.removed_ml"]), (
    volume(before), volume(after), p)
assert json.load(open(sys.argv[4]))["stages"]["skull.correct"]["state"] == "computed"
PY
"$TREPHINE" diff --quiet "$work/out/head" "$work/out2/head" --json "$work/diff.json"
python3 - "$work/diff.json" <<'PY'
import json, sys
said = json.load(open(sys.argv[1]))
assert said["anatomies"][0]["deviation"]["max_mm"] > 3 and said["anatomies"][0]["deviation"]["p99_mm"] < 1, said["anatomies"]
assert {p["name"] for p in said["parameters"]} >= {"skull.correct.file", "skull.correct.added_ml"}, said["parameters"]
PY
# What was painted is there, whatever the threshold: in the corrected field of another segmentation, too.
run "$work/root/configs/head.yaml" --out "$work/out4" --set skull.segment.lower_hu=300 --keep "$work/keep4"
"$TREPHINE" export --quiet --format seg.nrrd --labels "skull=$work/keep4/skull.correct.nrrd" --out "$work/labels4"
cat >"$work/held.py" <<'PY'
import gzip, sys
def read(file):
    head, _, body = open(file, "rb").read().partition(b"\n\n")
    field = dict(l.split(": ", 1) for l in head.decode().split("\n") if ": " in l)
    size = [int(n) for n in field["sizes"].split()]
    origin = [float(x) for x in field["space origin"].strip("()").split(",")]
    step = [[float(x) for x in v.strip("()").split(",")][a] for a, v in enumerate(field["space directions"].split())]
    return size, origin, step, gzip.decompress(body) if "gzip" in field["encoding"] else body
size, origin, step, change = read(sys.argv[1])
lsize, lorigin, lstep, label = read(sys.argv[2])
assert step == lstep
off = [round((o - l) / s) for o, l, s in zip(origin, lorigin, step)]
n = held = 0
for at, v in enumerate(change):
    if not v:
        continue
    i, j, k = at % size[0] + off[0], at // size[0] % size[1] + off[1], at // size[0] // size[1] + off[2]
    inside = all(0 <= x < m for x, m in zip((i, j, k), lsize)) and label[(k * lsize[1] + j) * lsize[0] + i] != 0
    n += 1
    held += inside == (v == 1)
print(n, held)
assert n == held > 40, (n, held)
PY
python3 "$work/held.py" "$work/root/configs/skull_by_hand.nrrd" "$work/labels4/labels.seg.nrrd" || fail "another threshold lost the correction"
# What cannot be meant.
config="$work/root/configs/wrong.yaml"
wrong() { sed "s|^corrections:.*|corrections: $1|" "$work/root/configs/head.yaml" >"$config"; }
refused() { expect "$@" "$TREPHINE" run "$config" --series "$SOURCE/sample_dicom" --out "$work/no" --quiet; }
wrong '{skul: skull_by_hand.nrrd}'
refused 78 'corrections\.skul: .*did you mean skull\?'
wrong '{skull: nothing.nrrd}'
refused 66 'nothing\.nrrd'
wrong '{skull: ../../out/head/case.json}'
refused 78 'corrections\.skull'
cp "$work/labels/labels.seg.nrrd" "$work/root/configs/whole.nrrd"
wrong '{skull: whole.nrrd}'
refused 65 "whole\.nrrd: .*is no correction: it has no segment 'added'"
expect 65 'after: nothing of the label is different' "$TREPHINE" correction "$work/labels/labels.seg.nrrd" \
  "$work/labels/labels.seg.nrrd" --label skull --output "$work/x.nrrd" --quiet
expect 65 "before: label: no 'brain'" "$TREPHINE" correction "$work/labels/labels.seg.nrrd" "$work/painted.seg.nrrd" \
  --label brain --output "$work/x.nrrd" --quiet

long_only

digest=$(case_digest "$work/out2/head")
run "$work/root/configs/head.yaml" --out "$work/out3" --threads 1
[[ $(case_digest "$work/out3/head") == "$digest" ]] || fail "the corrected case is another one in a second run"

# On other voxels: most of it, and it is said.
"$TREPHINE" run "$work/root/configs/head.yaml" --series "$SOURCE/sample_dicom" --out "$work/out5" --quiet --no-pictures --no-page \
  --set "resample.spacing_mm=[3,3,3]" 2>"$work/said" || { cat "$work/said"; fail "no case on other voxels"; }
grep -q 'skull\.correct: the correction was made on other voxels' "$work/said" || fail "other voxels are not said"

# The same by --set, and by a library for one of its cases.
sed -i '/^corrections:/d' "$work/root/configs/head.yaml"
run "$work/root/configs/head.yaml" --out "$work/out6" --set skull.correct.file="$work/root/configs/skull_by_hand.nrrd"
[[ $(case_digest "$work/out6/head") == "$digest" ]] || fail "--set gives another case than the configuration"
cat >"$work/root/configs/many.yaml" <<'YAML'
trephine: 1
config: head.yaml
cases:
  - {case: corrected, series: series, set: {skull.correct.file: skull_by_hand.nrrd}}
  - {case: plain, series: series}
YAML
ln -s "$SOURCE/sample_dicom" "$work/root/configs/series"
"$TREPHINE" library build "$work/root/configs/many.yaml" --out "$work/library" --quiet --no-pictures --root "$SOURCE" >"$work/said" 2>&1 ||
  { cat "$work/said"; fail "no library with a correction"; }
python3 - "$work/library" <<'PY'
import json, pathlib, sys
made = {c: json.loads((pathlib.Path(sys.argv[1]) / c / "case.json").read_bytes())["provenance"]["parameters"] for c in ("corrected", "plain")}
assert "skull.correct.added_ml" in made["corrected"] and not any(".correct." in k for k in made["plain"]), made
PY
