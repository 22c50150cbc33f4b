#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What a refused run made is kept for looking, obeys the face policy, is no case to any program, comes again at once from the
# cache, and goes with the next run that is published or with the library's gc.
. "$(dirname "$0")/common.sh"
cd "$SOURCE"
library=$work/library
# The sample with what the check needs and no more: what is refused here is refused alike with any further anatomy.
printf 'trephine: 1\nanatomies: {skin: {}, skull: {}, brain: {}}\nface: {policy: keep, reason: a phantom}\n' >"$work/scene.yaml"
sed "s,^scene: .*,scene: scene.yaml,; s,: \.\./,: $SOURCE/," configs/sample.yaml >"$work/small.yaml"
coarse=("${coarsest[@]:0:2}")  # this scene has no haptic volume
small=("$TREPHINE" run "$work/small.yaml" --root "$SOURCE" --series sample_dicom --out "$library" --case a)
run() { "${small[@]}" --quiet "${coarse[@]}" "$@"; }
refused() {  # PATTERN COMMAND...: 80, and the last line on stderr matches
  local pattern=$1 code=0
  shift
  "$@" 2>"$work/said" >/dev/null || code=$?
  ((code == 80)) || { cat "$work/said" >&2; fail "exit code $code instead of 80"; }
  tail -1 "$work/said" | grep -Eq -- "$pattern" || { cat "$work/said" >&2; fail "does not match '$pattern'"; }
}
strict=(--set anatomy.min_skin_skull_gap_mm=19)

refused 'set [0-9]+ for `max_near_mm2` of the stage `anatomy`' run "${strict[@]}"
kept=$library/a.refused
[[ $(stat -c %a "$kept") == 700 ]] || fail "the folder is open to others: $(stat -c %a "$kept")"
[[ ! -e $library/a ]] || fail "a refused run left a case"
for picture in fault overview skin_sides skull_sides axial sagittal; do [[ -s $kept/$picture.png ]] || fail "no $picture.png"; done
cmp -s "$kept/skin_sides.png" "$kept/skull_sides.png" && fail "one anatomy's picture is another's"
[[ -z $(find "$kept" -type f ! -name '*.png' ! -name message.txt) ]] || fail "more than pictures: $(ls "$kept")"
grep -q 'nearer than the 19 mm asked for' "$kept/message.txt" || fail "the message is not in message.txt"
! grep -q -e "$work" -e sample_dicom "$kept/message.txt" || fail "message.txt holds a path"

# Skin and skull alone are at fault: no brain was made for that, and nothing of the others has its name.
code=0
"$TREPHINE" run "$work/small.yaml" --root "$SOURCE" --series sample_dicom --out "$library" --case early --no-use-cache --threads 1 \
  "${coarse[@]}" "${strict[@]}" >"$work/early" 2>&1 || code=$?
((code == 80)) || { cat "$work/early" >&2; fail "exit code $code instead of 80"; }
! grep -Eq '^brain\.' "$work/early" || { cat "$work/early" >&2; fail "a brain was made for a fault of skin and skull"; }
[[ -s $library/early.refused/skull_sides.png && ! -e $library/early.refused/brain_sides.png ]] || fail "pictures: $(ls "$library/early.refused")"
rm -rf "$library/early.refused"

# Again: the same words, and nothing is computed. The pictures of the run that made them stay.
cp "$work/said" "$work/said_before"
before=$(sha256sum "$kept"/*.png)
refused . run "${strict[@]}"
diff <(tail -1 "$work/said_before") <(tail -1 "$work/said") || fail "the refusal from the cache says something else"
[[ $(sha256sum "$kept"/*.png) == "$before" ]] || fail "the pictures changed"
code=0
"${small[@]}" "${coarse[@]}" "${strict[@]}" 2>"$work/said" || code=$?
! grep -q 'computed' "$work/said" || { cat "$work/said" >&2; fail "something was computed again"; }

# Pictures of another run do not stay under this run's message.
stamp=$(tail -1 "$kept/message.txt")
refused . run --set anatomy.min_skin_skull_gap_mm=18
[[ $(tail -1 "$kept/message.txt") != "$stamp" ]] || fail "other values, the same stamp"
refused . run "${strict[@]}"
[[ $(tail -1 "$kept/message.txt") == "$stamp" && ! -e $kept/fault.png && -s $kept/skull_sides.png ]] ||
  fail "pictures of another run stay: $(ls "$kept")"

# No program takes it for a case.
"$TREPHINE" library list "$library" | grep -q refused && fail "the library lists it"
expect 66 'case.json' "$TREPHINE" page "$kept"
[[ -z ${TREPHINE_SIM:-} ]] || expect 66 'case.json' "$TREPHINE_SIM" check "$kept"

# What the message says to do works, and the case that is published takes the folder away.
most=$(grep -o 'set [0-9]* for `max_near_mm2`' "$work/said_before" | grep -o '[0-9]*' | head -1)
run "${strict[@]}" --set anatomy.max_near_mm2="$most" >/dev/null 2>"$work/said" || { cat "$work/said" >&2; fail "the remedy does not work: $most"; }
[[ ! -e $kept ]] || fail "the folder outlives the case that was published"

# After an 81 there is the message alone. (Voxels this coarse do not show the ears.)
code=0
"$TREPHINE" run configs/ct_head_defaced.yaml --series sample_dicom --out "$library" --case b \
  --set "resample.spacing_mm=[2.5,2.5,2.5]" >/dev/null 2>"$work/said" || code=$?
grep -q 'the message alone is kept, for there is nothing that may be looked at, in .*b\.refused' "$work/said" || {
  cat "$work/said" >&2; fail "the run says that there is something to look at"; }
((code == 81)) || fail "exit code $code instead of 81"
[[ $(ls "$library/b.refused") == message.txt ]] || fail "more than the message: $(ls "$library/b.refused")"

# The library's gc removes it.
"$TREPHINE" library gc "$library" | grep -q '1 folders without a case' || fail "gc does not count it"
[[ ! -e $library/b.refused ]] || fail "gc leaves it"

long_only

# A scene that takes the face away, refused before its gate, which waits for all that would be published: no picture of the scan, none of the skin.
python3 - "$library/a/case.json" "$SOURCE" "$work/defaced_scene.yaml" >"$work/defaced.yaml" <<'PY'
import json, sys
marks = {l["name"]: l["position_mm"] for l in json.load(open(sys.argv[1]))["landmarks"]}
print(f"trephine: 1\npipeline: {sys.argv[2]}/pipelines/ventriculostomy.yaml")
scene = open(f"{sys.argv[2]}/configs/scenes/ventriculostomy_defaced.yaml").read()
wanted = "face: {policy: deface}"
assert wanted in scene
scene = scene.replace("../materials.yaml", f"{sys.argv[2]}/configs/materials.yaml")
open(sys.argv[3], "w").write(scene.replace(wanted, "face: {policy: deface, believe: given, believe_reason: a phantom}"))
print("scene: defaced_scene.yaml")
print("landmarks:", json.dumps({"nasion": marks["nasion"], "tragus_left": [77, -2, 0], "tragus_right": [-75, -4, 0]}))
PY
refused 'max_near_mm2' "$TREPHINE" run "$work/defaced.yaml" --root "$SOURCE" --series sample_dicom --out "$library" --case b --quiet \
  "${coarse[@]}" --set anatomy.min_skull_brain_gap_mm=19
for picture in skin_sides axial coronal sagittal fault landmarks; do
  [[ ! -e $library/b.refused/$picture.png ]] || fail "$picture.png may show a face"
done
[[ -s $library/b.refused/message.txt && -s $library/b.refused/brain_sides.png ]] || fail "message or brain missing: $(ls "$library/b.refused")"
echo "refused: kept for looking, remedied, collected"
