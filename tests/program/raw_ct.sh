#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A raw CT without segmentation, by the scene that docs/how-to/raw-ct.md prints: felt, drawn and drilled. A window of HU has a whole surface,
# the picture of the drilled bone is that of the volume, and the recording gives the same bits again.
. "$(dirname "$0")/common.sh"
root=$work/root
mkdir -p "$root" && touch "$root/trephine.root"
cp -r "$SOURCE/configs" "$SOURCE/pipelines" "$root"
sed -n '/^A raw CT can be felt/,$p' "$SOURCE/docs/how-to/raw-ct.md" | sed -n '/^```yaml/,/^```$/p' | sed '1d;/^```$/,$d' >"$root/configs/scenes/raw.yaml"
grep -q 'encoding: hu' "$root/configs/scenes/raw.yaml" || fail "docs/how-to/raw-ct.md holds no scene of a raw CT"
printf 'trephine: 1\ncase: raw\npipeline: ../pipelines/ventriculostomy.yaml\nscene: scenes/raw.yaml\nlandmarks: {kocher_right: [-25, -38, 116]}\n' \
  >"$root/configs/raw.yaml"
make() {  # CASE FLAGS...
  "$OFFLINE" run "$root/configs/raw.yaml" --series "$SOURCE/sample_dicom" --out "$work/out" --case "$1" --quiet --no-pictures --no-page \
    --set "haptic.spacing_mm=[1.2,1.2,1.2]" "${@:2}" >"$work/said" 2>&1 || { cat "$work/said"; fail "no case $1"; }
}
make raw
"$TREPHINE" check "$work/out/raw" >"$work/said" || { cat "$work/said"; fail "check"; }
grep -q '2 bone .*cuttable' "$work/said" || { cat "$work/said"; fail "bone is not said to be cuttable"; }

# How much of the picture the surface covers between its own left and right ends, row by row: rings leave most of it open.
cover() {  # SHARE CASE FLAGS...
  "$TREPHINE" render "$work/out/$2" --out "$work/pictures" --view back --width 320 --height 240 --no-places "${@:3}" >"$work/said" 2>&1 ||
    { cat "$work/said"; grep -q 'OpenGL' "$work/said" && skip "no OpenGL here"; fail "render"; }
  python3 - "$work/pictures/frame-00001.png" "$1" <<'PY'
import struct, sys, zlib
data, at, packed = open(sys.argv[1], "rb").read(), 8, b""
while at < len(data):
    size, kind = struct.unpack_from(">I4s", data, at)
    body = data[at + 8:at + 8 + size]
    if kind == b"IHDR": w, h, depth, colour = struct.unpack_from(">IIBB", body)
    if kind == b"IDAT": packed += body
    at += 12 + size
assert (depth, colour) == (8, 2), (depth, colour)
raw, row, rows = zlib.decompress(packed), bytearray(3 * w), []
for y in range(h):
    kind, line = raw[y * (3 * w + 1)], raw[y * (3 * w + 1) + 1:(y + 1) * (3 * w + 1)]
    now = bytearray(3 * w)
    for n, v in enumerate(line):
        a, b, c = (now[n - 3] if n >= 3 else 0), row[n], (row[n - 3] if n >= 3 else 0)
        p = a + b - c
        near = a if abs(p - a) <= abs(p - b) and abs(p - a) <= abs(p - c) else b if abs(p - b) <= abs(p - c) else c
        now[n] = v + (0, a, b, (a + b) // 2, near)[kind] & 255
    row = now
    rows.append(bytes(now))
back = rows[0][:3]
covered = spanned = 0
for line in rows[h // 4:h // 2]:  # the vault
    shown = [x for x in range(w) if max(abs(line[3 * x + c] - back[c]) for c in range(3)) > 24]
    if shown:
        covered, spanned = covered + len(shown), spanned + shown[-1] - shown[0] + 1
assert spanned > 2000 and covered > float(sys.argv[2]) * spanned, (covered, spanned)
PY
}
cover 0.99 raw --opacity skin=0 || fail "soft tissue is not drawn whole"
cover 0.99 raw --opacity skin=0,soft=0 || fail "bone is not drawn whole"
cover 0.99 raw --cast haptic || fail "rays do not see soft tissue whole"

# One function for sight and touch, as the page prints it: bone is the HU that are at least half opaque.
python3 - "$SOURCE/docs/how-to/raw-ct.md" "$root/configs/scenes/raw.yaml" <<'PY'
import re, sys
bone = re.findall(r"```yaml\n(    bone:\n.*?)```", open(sys.argv[1]).read(), re.S)
assert len(bone) == 1, bone
scene = open(sys.argv[2]).read()
with_function, count = re.subn(r"    bone: \{.*\}\n", bone[0], scene)
assert count == 1
open(sys.argv[2] + ".ramp", "w").write(with_function)
PY
cp "$root/configs/scenes/raw.yaml" "$work/raw.yaml"
mv "$root/configs/scenes/raw.yaml.ramp" "$root/configs/scenes/raw.yaml"
sed -i 's/^  skin: {/  skin: {touched_as: metal, /' "$root/configs/scenes/raw.yaml"  # and a surface that is touched as a mesh
make ramp
python3 - "$work/out/ramp/case.json" <<'PY'
import json, sys
case = json.load(open(sys.argv[1]))
assert [a["touched_as"]["name"] for a in case["anatomies"] if "touched_as" in a] == ["metal"], case["anatomies"]
bone = [s for s in case["haptic"]["shapes"] if s["name"] == "bone"][0]
assert [p["stiffness_n_per_mm"] for p in bone["transfer"]["points"]] == [0.3, 0.5, 1.0], bone
assert bone["window"][0] == 256 and len(bone["transfer"]["points"]) == 3 and bone["cuttable"], bone
PY
"$TREPHINE" servo "$work/out/ramp" --no-paced --seconds 3 --record "$work/skin.servo" >"$work/said" 2>&1 || { cat "$work/said"; fail "a surface beside a raw CT"; }
"$TREPHINE" replay "$work/out/ramp" "$work/skin.servo" | grep -q '^replayed bit for bit$' || fail "no replay beside a surface"
cover 0.99 ramp --cast haptic --transfer bone || fail "rays do not see bone whole"
cp "$work/raw.yaml" "$root/configs/scenes/raw.yaml"

# Drilled, with bone alone: soft tissue is in the way of the hand otherwise, as it is in a patient.
sed -i '/^    soft:/d' "$root/configs/scenes/raw.yaml"
sed -i 's/^haptic:/landmarks: {kocher_right: 0}\nhaptic:/' "$root/configs/scenes/raw.yaml"
make bone
"$TREPHINE" servo "$work/out/bone" --tool ball --tool-diameter-mm 7 --drill --no-paced --seconds 10 --record "$work/hole.servo" \
  --json "$work/hole.json" >"$work/said" 2>&1 || { cat "$work/said"; fail "a raw CT is not drilled"; }
python3 - "$work/hole.json" <<'PY'
import json, sys
said = json.load(open(sys.argv[1]))
assert said["faults"] == 0 and said["drilled"]["removed_mm3"]["bone"] > 50, said["drilled"]
PY
"$TREPHINE" replay "$work/out/bone" "$work/hole.servo" >"$work/said" || { cat "$work/said"; fail "no replay"; }
grep -q '^the drilled volume is the same$' "$work/said" && grep -q '^replayed bit for bit$' "$work/said" || { cat "$work/said"; fail "replay"; }

# In a window: what is cast, and by which function, changes while it is open.
. "$(dirname "$0")/window.sh"
open_window "$TREPHINE" play "$work/out/ramp" --window-width 480 --window-height 360 --no-realtime --no-panels --max-step-s 3600 \
  --cast haptic --view back --shots "$work/shots"
until_is state 'time [1-9]|time 0\.[1-9]'
shot() { ok shot; until_file "$work/shots/picture-00$1.png"; }
shot 1
ok 'cast none'; shot 2
ok 'cast haptic bone'; shot 3
! cmp -s "$work/shots/picture-001.png" "$work/shots/picture-002.png" && ! cmp -s "$work/shots/picture-001.png" "$work/shots/picture-003.png" ||
  fail "the picture does not change with what is cast"
ask 'cast haptic bones'
[[ $answer == 'error: --transfer: bones: must be a preset (bone, skin, vessels)'* ]] || fail "no such preset: $answer"
ask 'cast ct'
[[ $answer == *'the case has no CT'* ]] || fail "there is no CT: $answer"
ask 'cast mri'
[[ $answer == 'error: cast: must be none, ct or haptic' ]] || fail "another volume: $answer"

# The editor: what it writes comes back in this window, in `render`, and in a case whose scene names it, with the same picture.
ok 'cast haptic'
ask 'point 1 200 0'
[[ $answer == 'error: each shape has a function of its own'* ]] || fail "one of two functions is edited: $answer"
ok 'editor on'; ok 'transfer shape bone'
ask transfer
[[ $answer == '150:0:ede3c7,350:0.95:ede3c7,1200:1:faf7ed' ]] || fail "the shape's own function: $answer"
ok 'point 2 600 0.5 ff4020'; ok 'add_point 400 0.05'; ok 'point 2 420 0.04'
ask 'point 9 1 1'
[[ $answer == 'error: 9: the function has points 1 to 4' ]] || fail "no such point: $answer"
ask transfer
[[ $answer == '150:0:ede3c7,420:0.04:'*',600:0.5:ff4020,1200:1:faf7ed' ]] || fail "what was edited: $answer"
edited=$answer
ask write_transfer
file=$answer
[[ $file == "$work/shots/transfer-001.yaml" && -s $file ]] || fail "nothing is written: $answer"
ok 'cast haptic bone'; ask transfer
[[ $answer == '150:0:'* && $answer != "$edited" ]] || fail "another function: $answer"
ok "cast haptic $file"; ask transfer
[[ $answer == "$edited" ]] || fail "what was written is not what comes back: $answer"
rm -r "$work/shots"
ask write_transfer
[[ $answer == 'error: a file could not be written: '*shots* ]] || fail "a folder that is gone: $answer"
mkdir "$work/shots"
ask write_transfer
cp "$answer" "$root/configs/scenes/edited.yaml"
ok quit; finish 0
sed -i 's/^    bone: .*/    bone: {material: bone, cuttable: true, transfer_file: edited.yaml}/; /^    soft:/d' "$root/configs/scenes/raw.yaml"
make edited
python3 - "$work/out/edited/case.json" "$root/configs/scenes/edited.yaml" <<'PY'
import json, sys
written, bone = json.load(open(sys.argv[2])), json.load(open(sys.argv[1]))["haptic"]["shapes"][0]
assert bone["transfer"]["points"] == written["points"], (bone, written)
assert bone["window"][0] == 600, bone["window"]
PY
picture() {  # NAME FLAGS...
  "$TREPHINE" render "$work/out/edited" --out "$work/pictures" --view back --width 320 --height 240 --no-places --cast haptic "${@:2}" >"$work/said" ||
    { cat "$work/said"; fail "render"; }
  mv "$work/pictures/frame-00001.png" "$work/$1.png"
}
picture own; picture file --transfer "$root/configs/scenes/edited.yaml"; picture bone --transfer bone
cmp -s "$work/own.png" "$work/file.png" || fail "the case's own function and its file give two pictures"
! cmp -s "$work/own.png" "$work/bone.png" || fail "every function gives the same picture"
echo ok
