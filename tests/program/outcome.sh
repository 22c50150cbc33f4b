#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A ventriculostomy from the CT before it to a score of the CT after it, and what must not be judged.
. "$(dirname "$0")/common.sh"
: "${SIM:?}"
cd "$work"

scan=(--level hard --columns-count 224 --rows-count 224 --field-of-view-mm 224 --noise-hu 8 --subvoxel-mm 1.2 --mesh-step-mm 0
  --no-labels --quiet)
"$TREPHINE" phantom before --seed 3 "${scan[@]}" --slices-count 94 --slice-step-mm 1.8 --slice-thickness-mm 1.8
"$TREPHINE" run "$SOURCE/configs/ct_head.yaml" --series before/dicom --out library --case head --no-page --quiet --set "resample.spacing_mm=[1.8,1.8,1.8]" \
  2>warnings || fail "the case: $(cat warnings)"
"$TREPHINE" rubric "$SOURCE/configs/rubrics/ventriculostomy.yaml" --output rubric.json --quiet
after() { # FOLDER SEED MORE...: a scan of another day, on another table, of the upper head
  local folder=$1 seed=$2
  shift 2
  "$TREPHINE" phantom "$folder" --seed "$seed" "${scan[@]}" --slices-count 70 --slice-step-mm 2.2 --slice-thickness-mm 2.2 \
    --centre-mm 14,-30,97 --head-turn-deg 9,-6,12 --head-shift-mm 14,-22,37 "$@"
}
score() { # FOLDER: judged, the table in table
  "$SIM" score-outcome "$1/outcome.json" --case library/head --rubric rubric.json --participant r-01 --json "$1/score.json" \
    --log attempts.csv >table
}

after cathetered 3 --implants catheter --implant-aim-mm 0,0,2
"$TREPHINE" outcome library/head --series cathetered/dicom --out one >said
grep -q '^catheter *found' said || fail "no catheter: $(cat said)"
[[ $(head -c 4 one/outcome.png | tail -c 3) == PNG ]] || fail "no picture"
python3 - cathetered/truth/truth.json one/outcome.json <<'PY'
import json, sys
truth, found = (json.load(open(f)) for f in sys.argv[1:])
t, c = truth["put_in"][0], found["courses"][0]
off = lambda a, b: sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5
assert off(t["tip_mm"], c["tip_mm"]) < 1.2, (t["tip_mm"], c["tip_mm"])
assert off(t["hole_mm"], found["holes"][0]["outer_mm"]) < 2, (t["hole_mm"], found["holes"])
assert c["side"] == "right" and found["catheter"] == "found" and len(found["holes"]) == 1, found
rows = found["registration"]["transform"]
for p in (t["tip_mm"], [0, 0, 100], [60, 20, 60]):
    at = lambda m: [sum(m[4 * a + k] * p[k] for k in range(3)) + m[4 * a + 3] for a in range(3)]
    assert off(at(rows), at(sum(truth["head_to_scan"], []))) < 0.8, p
PY
if grep -rlE 'PHANTOM|TREPHINE\^|1\.2\.826|/(tmp|work|home)/' one; then fail "something of the patient or the place is in it"; fi
# The lesson's rows: those that a CT shows, by the lesson's own functions; the rest is not judged.
score one
grep -q 'MEASURED on a CT' table || fail "not said what it is: $(cat table)"
python3 - one/score.json cathetered/truth/truth.json <<'PY'
import json, sys
s, truth = json.load(open(sys.argv[1])), json.load(open(sys.argv[2]))
rows = {r["name"]: r for r in s["rows"]}
assert s["checked"] == "measured" and s["facts"]["procedure_s"] is None, s["checked"]
for name in ("landmarks", "time", "passes"):
    assert rows[name]["score"] == "not judged", rows[name]
for name in ("trajectory", "depth", "tip"):
    assert isinstance(rows[name]["score"], int) and rows[name]["decided_s"] is None, rows[name]
assert rows["tip"]["measured"]["foramen_off_mm"] < 8, rows["tip"]
assert s["figures"]["in_ventricle"] is True and s["figures"]["passes_count"] is None, s["figures"]
PY
score one
[[ $(wc -l <attempts.csv) == 2 ]] || fail "one outcome is two attempts: $(cat attempts.csv)"
mkdir results && cp one/score.json results/r-01-real.json
"$SIM" group results --page group.html >/dev/null || fail "no group reads it"

# Of another case's outcome nothing is judged, and a spoilt one is refused by name.
sed 's/"case_sha256": "./"case_sha256": "x/' one/outcome.json >other.json
expect 65 'other.json: case_sha256: .*another case.json' "$SIM" score-outcome other.json --case library/head --rubric rubric.json \
  --participant r-01
sed 's/"found"/"surely"/' one/outcome.json >bad.json
expect 65 'bad.json: .*sighting' "$SIM" score-outcome bad.json --case library/head --rubric rubric.json --participant r-01
expect 64 'participant' "$SIM" score-outcome one/outcome.json --case library/head --rubric rubric.json --participant 'Jane Doe'
long_only

"$TREPHINE" outcome library/head --series cathetered/dicom --out again --threads 1 --quiet
cmp one/outcome.json again/outcome.json && cmp one/outcome.png again/outcome.png || fail "other bytes"

# No catheter: none is found, and nothing of it is judged.
after bare 3
"$TREPHINE" outcome library/head --series bare/dicom --out bare_out >said
grep -q '^catheter *none was found' said && grep -q '^burr hole *none was found' said || fail "found something: $(cat said)"
[[ ! -e bare_out/outcome.png ]] || fail "a picture of nothing"
score bare_out
for row in Trajectory Depth Final; do grep -q "^$row.*not judged.*the CT shows no catheter" table || fail "$row: $(cat table)"; done

# Two catheters: doubtful, and neither is judged.
after two 3 --implants two_catheters
"$TREPHINE" outcome library/head --series two/dicom --out two_out >said
grep -q '^catheter *doubtful (.*two_courses' said || fail "two are one: $(cat said)"
score two_out
for row in Trajectory Depth Final; do grep -q "^$row.*not judged.*doubtful" table || fail "$row: $(cat table)"; done

# Another patient's scan and a mirrored one are refused, or doubtful and judged in no row of the catheter.
spoilt() { # FOLDER MORE...
  local folder=$1 got=0
  shift
  "$TREPHINE" outcome library/head --out "$folder" "$@" >said 2>why || got=$?
  if [[ $got == 80 ]]; then
    [[ ! -e $folder/outcome.json ]] || fail "a refused outcome was written"
    return
  fi
  [[ $got == 0 ]] && grep -q '^registration *doubtful' said || fail "taken for the patient's ($got): $(cat said why)"
  score "$folder"
  ! grep -Eq '^(Trajectory|Depth|Final).* [1-5]  ' table || fail "judged: $(cat table)"
}
after other 11 --implants catheter
spoilt other_out --series other/dicom
"$TREPHINE" import cathetered/dicom --output scan.nrrd --quiet
"$TREPHINE" convert scan.nrrd --output scan.mha --quiet
python3 - <<'PY'
import zlib
data = open("scan.mha", "rb").read()
at = data.index(b"ElementDataFile = LOCAL\n") + len(b"ElementDataFile = LOCAL\n")
head, voxels = data[:at], data[at:]
fields = dict(line.split(" = ", 1) for line in head.decode().splitlines() if " = " in line)
nx = int(fields["DimSize"].split()[0])
if fields.get("CompressedData") == "True":
    voxels = zlib.decompress(voxels)
    head = b"".join(b"CompressedData = False\n" if line.startswith(b"CompressedData =") else line
                    for line in head.splitlines(True) if not line.startswith(b"CompressedDataSize"))
size = 2 if fields["ElementType"] == "MET_SHORT" else 4
row = nx * size
out = bytearray()
for k in range(0, len(voxels), row):
    line = voxels[k:k + row]
    out += b"".join(line[i:i + size] for i in range(row - size, -1, -size))
open("mirrored.mha", "wb").write(head + out)
PY
spoilt mirrored_out --series mirrored.mha --volume-values hu

