#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A case of a CT and an MR as its user makes it: brain and ventricles from the MR, its provenance in case.json, what is not
# computed, and a burr hole that keeps clear of what was found. given_scans.sh has transforms that are given, and what is refused.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/scans_common.sh"
both --scan mr=head/second/scan.nrrd --keep keep >said 2>&1 || fail "run: $(cat said)"
grep -q 'mr.import: .*taken on trust' said || fail "nothing said of the patient: $(cat said)"
python3 - out/both/case.json <<'PY'
import json, sys
p = json.load(open(sys.argv[1]))["provenance"]["parameters"]
assert p["scans.mr.modality"] == "mr", p
assert p["mr.import.input"].startswith("sha256 "), p
assert len(p["mr.register.transform"]) == 12 and p["mr.register.inverse_mm"] < 1 and p["mr.register.overlap_ratio"] > 0.5, p
assert p["brain.t1_contrast.bright"] == "grey" and p["ventricles.t1_contrast.bright"] == "white"
PY
python3 - out/both/case.json <<'PY'
import json, sys
case = json.load(open(sys.argv[1]))
assert not [f for f in case.get("findings", []) if f["kind"] == "other_patient"], case["findings"]
assert "another patient" not in case["figures"]["verdict"], case["figures"]["verdict"]
PY

for anatomy in brain ventricles; do
  "$TREPHINE" measure keep/$anatomy.$anatomy.nrrd --truth head/truth/truth.json --anatomy $anatomy --sample-count 2000 \
    --report $anatomy.json --quiet
done
python3 - brain.json 0.94 ventricles.json 0.93 <<'PY'
import json, sys
for file, least in zip(sys.argv[1::2], sys.argv[2::2]):
    dice = json.load(open(file))["dice_ratio"]
    assert dice > float(least), (file, dice)
PY

# Only what the scene needs: of a skull the MR is neither read nor registered, so it need not be there.
sed 's/scene: .*/scene: scenes\/skull.yaml/; s/case: .*/case: bone/' root/configs/both.yaml >root/configs/bone.yaml
"$TREPHINE" run root/configs/bone.yaml --series head/dicom --out out --explain >said || fail "explain"
! grep -Eq '(^| )mr\.' said || fail "the MR is not needed: $(cat said)"
both --scan mr=head/second/scan.nrrd --explain >said || fail "explain"
grep -q 'mr.register' said && grep -q 'read by .*brain.t1_contrast' said || fail "not explained: $(cat said)"

# A burr hole keeps clear of a zone: here of the ventricles, into which the line to the foramen leads.
"$TREPHINE" contour keep/skull.segment.nrrd --output skull.vtp --quiet
"$TREPHINE" contour keep/ventricles.ventricles.nrrd --output zone.vtp --quiet
mapfile -t points < <(python3 - <<'PY'
import json
for name, p in json.load(open("head/truth/truth.json"))["landmarks_mm"].items():
    if name in ("nasion", "inion", "monro_right"):
        print("--landmark=" + name + "=" + ",".join(str(v) for v in p))
PY
)
hole=("$TREPHINE" burrhole skull.vtp "${points[@]}" --zone zone=zone.vtp --output hole.json --quiet)
"${hole[@]}" --avoid zone=10 --report hole.r.json 2>said || fail "burrhole: $(cat said)"
grep -q '"clear_of_zone_mm": [1-9][0-9]' hole.r.json || fail "no distance: $(cat hole.r.json)"
rm hole.json
refuses 80 'avoid.zone: the trajectory enters the zone by .*move the hole' "${hole[@]}" --toward monro_right --avoid zone=1
[[ ! -e hole.json ]] || fail "a refused hole was written"
refuses 64 'avoid: sinus, no zone of that name is given' "${hole[@]}" --avoid sinus=1

long_only

# A head that is 2.5 % longer, as another patient's may be, is within the limits of the registration: it is published, and the verdict,
# the findings and the class say that it is doubtful.
python3 - head/second/scan.nrrd longer.nrrd <<'PY'
import re, sys
data = open(sys.argv[1], "rb").read()
end = data.index(b"\n\n")
vectors = re.search(rb"space directions: \(([^)]*)\) \(([^)]*)\) \(([^)]*)\)", data[:end])
longer = b",".join(b"%.17g" % (1.025 * float(v)) for v in vectors[2].split(b","))
open(sys.argv[2], "wb").write(data[: vectors.start(2)] + longer + data[vectors.end(2) :])
PY
both --case other --scan mr=longer.nrrd >said 2>&1 || fail "run: $(cat said)"
grep -q 'whether this is the same patient' said || fail "nothing said of the patient: $(cat said)"
python3 - out/other/case.json <<'PY'
import json, sys
case = json.load(open(sys.argv[1]))
figures = case["figures"]
found = [f for f in case["findings"] if f["kind"] == "other_patient"]
assert len(found) == 1 and found[0]["confidence"] >= 0.5 and sorted(found[0]["concerns"]) == ["brain", "ventricles"], case["findings"]
assert figures["verdict"].startswith("brain, ventricles: doubtful") and "may be another patient's" in figures["verdict"], figures
assert figures.get("class", "uncertain") in ("uncertain", "unknown"), figures
assert all(t["confidence"] < 0.5 for t in case.get("targets", [])), case["targets"]
PY
