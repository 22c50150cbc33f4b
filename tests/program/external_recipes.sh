#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The shipped recipes of other programs, from the command line that they give to the case. Stand-ins take the programs' arguments
# and write the labels, in the programs' numbers, of what our own segmentation found in the sample: so the case must be nearly the
# same as ours.
. "$(dirname "$0")/common.sh"
coarse=(--set "resample.spacing_mm=[2.5,2.5,2.5]" --series "$SOURCE/sample_dicom" --quiet --no-pictures --no-page --case head)
"$TREPHINE" run "$SOURCE/configs/ct_head.yaml" "${coarse[@]}" --out "$work/ours" --keep "$work/keep" >"$work/said" 2>&1 ||
  { cat "$work/said"; fail "no case of our own"; }
for anatomy in brain ventricles; do
  "$TREPHINE" export --quiet --format nii.gz --labels "$anatomy=$work/keep/$anatomy.$anatomy.nrrd" --out "$work/prepared" --name $anatomy
done

mkdir "$work/bin"
cat >"$work/bin/labeller.py" <<PY
import gzip, struct
def read(name):
    data = gzip.open(name).read()
    size, at = struct.unpack_from("<3h", data, 42), int(struct.unpack_from("<f", data, 108)[0])
    rows = [struct.unpack_from("<4f", data, 280 + 16 * r) for r in range(3)]
    return data, size, at, rows
def write(source, out, labels):
    """labels: (anatomy, value) pairs; the later wins. On the scan's own voxels, as uint8."""
    data, size, at, rows = read(source)
    voxels = bytearray(size[0] * size[1] * size[2])
    for anatomy, value in labels:
        d, s, a, r = read("$work/prepared/" + anatomy + ".nii.gz")
        off = [round((r[x][3] - rows[x][3]) / rows[x][x]) for x in range(3)]
        for k in range(s[2]):
            for j in range(s[1]):
                begin = ((k + off[2]) * size[1] + j + off[1]) * size[0] + off[0]
                line = d[a + (k * s[1] + j) * s[0]:a + (k * s[1] + j + 1) * s[0]]
                for i, v in enumerate(line):
                    if v:
                        voxels[begin + i] = value
    head = bytearray(data[:at])
    struct.pack_into("<hh", head, 70, 2, 8)
    gzip.open(out, "wb", 1).write(bytes(head) + bytes(voxels))
PY
cat >"$work/bin/TotalSegmentator" <<PY
#!/usr/bin/python3
import argparse, os, sys
sys.path.insert(0, "$work/bin")
sys.dont_write_bytecode = True
import labeller
p = argparse.ArgumentParser()
p.add_argument("--version", action="version", version="2.4.0")
p.add_argument("-i"), p.add_argument("-o"), p.add_argument("--task"), p.add_argument("--nr_thr_saving", type=int)
p.add_argument("--ml", action="store_true")
a = p.parse_args()
assert a.ml and os.environ["TOTALSEG_WEIGHTS_PATH"] == "/opt/totalsegmentator/nnunet/results"
open(os.path.expanduser("~/config.json"), "w").write("{}")  # as it does in its home
labeller.write(a.i, a.o, {"total": [("brain", 90)], "ventricle_parts": [("ventricles", 3)]}[a.task])
PY
cat >"$work/bin/mri_synthseg" <<PY
#!/usr/bin/python3
import argparse, os, sys
sys.path.insert(0, "$work/bin")
sys.dont_write_bytecode = True
import labeller
p = argparse.ArgumentParser()
p.add_argument("--i"), p.add_argument("--o"), p.add_argument("--threads", type=int)
for flag in ("--ct", "--keepgeom", "--cpu"):
    p.add_argument(flag, action="store_true")
a = p.parse_args()
assert a.ct and a.keepgeom and a.threads > 0 and os.environ["FS_LICENSE"]
labeller.write(a.i, a.o, [("brain", 2), ("ventricles", 43)])
PY
chmod +x "$work/bin/TotalSegmentator" "$work/bin/mri_synthseg"

for recipe in totalsegmentator synthseg; do
  PATH=$work/bin:$PATH "$TREPHINE" run "$SOURCE/configs/ct_head_$recipe.yaml" "${coarse[@]}" --out "$work/$recipe" --allow-external \
    --cache "$work/ours/.trephine-cache" >"$work/said" 2>&1 || { cat "$work/said"; fail "no case of $recipe"; }
  "$TREPHINE" diff --quiet "$work/ours/head" "$work/$recipe/head" --json "$work/diff.json"
  python3 - "$work/diff.json" "$work/$recipe/head/case.json" $recipe <<'PY'
import json, sys
said, case = (json.load(open(f)) for f in sys.argv[1:3])
by_name = {a["name"]: a for a in said["anatomies"]}
assert set(by_name) >= {"skin", "brain", "ventricles"}
for name in ("brain", "ventricles"):
    a = by_name[name]
    ratio = a["volume_ml"]["new"] / a["volume_ml"]["old"]
    # Half a voxel of 2.5 mm; the ventricles are a few voxels wide.
    most = {"brain": 0.02, "ventricles": 0.12}[name]
    assert a["deviation"]["rms_mm"] < 1.25 and abs(ratio - 1) < most, (name, a["deviation"], ratio)
assert by_name["skin"]["same_bytes"]
made_of = case["provenance"]["parameters"]
stages = sorted(k for k in made_of if k.endswith(".output_sha256"))
assert len(stages) == {"totalsegmentator": 2, "synthseg": 1}[sys.argv[3]], stages
PY
done
