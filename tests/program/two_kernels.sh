#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Two reconstructions of one scan: bone from the sharp kernel, soft tissue from the soft one, without a registration; and what is
# refused where the two are no such pair.
. "$(dirname "$0")/common.sh"
cd "$work"
mkdir root && touch root/trephine.root
cp -r "$SOURCE/pipelines" "$SOURCE/configs" root/
"$TREPHINE" phantom head --level hard --seed 5 --columns-count 128 --rows-count 128 --field-of-view-mm 240 --slices-count 90 \
  --slice-step-mm 2 --slice-thickness-mm 2 --mesh-step-mm 0 --no-labels --encoding none --noise-hu 8 --second-kernel-mm 0.6 --subvoxel-mm 1 --quiet
"$TREPHINE" import head/dicom --list >list
sharp=$(sed -n 's/^ *\(s[0-9]\)-.*sharp.*/\1/p;s/^ *\(s[0-9]\)-.*bone.*/\1/p' list | head -n 1)
[[ -n $sharp ]] || sharp=$(for s in s1 s2; do
  "$TREPHINE" import head/dicom --series $s --output $s.nrrd --quiet
  "$TREPHINE" scan $s.nrrd --report $s.json --quiet 2>said
  printf '%s %s\n' "$(sed -n 's/^ *"noise_hu": *\([0-9.]*\),*$/\1/p' $s.json)" $s
done | sort -g | tail -n 1 | cut -d' ' -f2)
soft=$([[ $sharp == s1 ]] && echo s2 || echo s1)
printf 'trephine: 1\nanatomies: {skull: {}, brain: {}, ventricles: {}}\nface: {policy: keep, reason: a phantom has no face}\n' >root/configs/three.yaml
sed 's/scene: .*/scene: three.yaml/' root/configs/head_two_kernels.yaml >root/configs/two.yaml
both() {
  "$TREPHINE" run root/configs/two.yaml --series head/dicom --set import.series=$soft --out out --case two --quiet \
    --no-pictures --no-page "$@"
}
both --scan sharp=head/dicom --set sharp.import.series=$sharp --keep keep >said 2>&1 || fail "run: $(cat said)"
python3 - out/two/case.json <<'PY'
import json, sys
p = json.load(open(sys.argv[1]))["provenance"]["parameters"]
assert p["sharp.register.given"].startswith("sha256 "), p
assert p["sharp.register.bone_ratio"] > 0.85, p
t = p["sharp.register.transform"]
assert t == [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0], t
PY
# Bone is that of the sharp series to the last voxel, brain that of the soft one.
"$TREPHINE" segment keep/sharp.register.nrrd --lower-hu 226 --seed-lower-hu 400 --edge half_maximum --min-component-ml 1 \
  --fill cavities --fill-close-mm 2 --fill-max-ml 100 --within keep/skin.segment.nrrd --output skull.nrrd --quiet
cmp skull.nrrd keep/skull.segment.nrrd || fail "the skull is not that of the sharp series"
"$TREPHINE" brain keep/head_region.nrrd --skull skull.nrrd --output brain.nrrd --quiet
cmp brain.nrrd keep/brain.brain.nrrd || fail "the brain is not that of the soft series"
for anatomy in brain ventricles; do
  "$TREPHINE" measure keep/$anatomy.$anatomy.nrrd --truth head/truth/truth.json --anatomy $anatomy --sample-count 1000 \
    --report $anatomy.json --quiet
done
python3 - brain.json 0.95 ventricles.json 0.88 <<'PY'
import json, sys
for file, least in zip(sys.argv[1::2], sys.argv[2::2]):
    dice = json.load(open(file))["dice_ratio"]
    assert dice > float(least), (file, dice)
PY

# Another frame of reference: its positions mean other places.
cp -r head/dicom other
python3 - other/* <<'PY'
import sys
for name in sys.argv[1:]:
    data = bytearray(open(name, "rb").read())
    at = data.index(b"\x20\x00\x52\x00UI")
    last = at + 8 + int.from_bytes(data[at + 6:at + 8], "little") - 1
    while data[last] == 0:
        last -= 1
    data[last] = ord("7") if data[last] != ord("7") else ord("3")
    open(name, "wb").write(data)
PY
refuses 65 'sharp.register.given: moves nothing, and the scan has another frame of reference' both --scan sharp=other \
  --set sharp.import.series=$sharp
# Volumes say no frame; that the patient moved in between shows in the bones.
"$TREPHINE" import head/dicom --series $sharp --output moved.nrrd --quiet
python3 - moved.nrrd <<'PY'
import re, sys
data = open(sys.argv[1], "rb").read()
end = data.index(b"\n\n")
head, body = data[:end].decode(), data[end:]
def aside(m):
    x, rest = m.group(1).split(",", 1)
    return "space origin: (%r,%s)" % (float(x) + 4, rest)
head, n = re.subn(r"space origin: \(([^)]*)\)", aside, head)
assert n == 1
head = "\n".join(line for line in head.split("\n") if not line.startswith("#"))
open(sys.argv[1], "wb").write(head.encode() + body)
PY
refuses 80 'the bones of the two scans lie upon each other by 0\.[0-9]*, .*leave .given. out' "$TREPHINE" register \
  keep/import.nrrd moved.nrrd --moving-values hu --given root/configs/same_place.tfm --output m.nrrd --quiet
