#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Each kind of bad input gets one line on stderr and its documented exit code, and leaves nothing behind.
. "$(dirname "$0")/common.sh"
config=$SOURCE/configs/ct_head.yaml
run=("$TREPHINE" run --quiet)

expect 66 'trephine run: scan: --series: not found: of the [0-9]+ parts of the path that is given the first [0-9]+ exist; check' "${run[@]}" "$config" --series "$work/nowhere" --out "$work/out"
mkdir "$work/empty"
expect 65 'trephine run: .*scan: .*DICOM' "${run[@]}" "$config" --series "$work/empty" --out "$work/out"
echo text >"$work/empty/notes.txt"
expect 65 'trephine run: .*DICOM' "${run[@]}" "$config" --series "$work/empty" --out "$work/out"
expect 66 'trephine run: .*missing.yaml' "${run[@]}" "$work/missing.yaml" --out "$work/out"
expect 64 'trephine run: .*series' "${run[@]}" "$config" --out "$work/out"
expect 64 '--serie.*--series' "${run[@]}" "$config" --serie "$work/empty" --out "$work/out"
expect 64 '--set: skull.smooth, must be' "${run[@]}" "$config" --series "$SOURCE/sample_dicom" --out "$work/out" --set skull.smooth
expect 64 '--sett: unknown flag; did you mean --set' "${run[@]}" "$config" --out "$work/out" --sett a

[[ ! -e $work/out ]] || fail "a run that was refused left a folder"

mkdir "$work/configs"
printf 'trephine: 1\npipeline: p.yaml\nscene: s.yaml\ncaes: x\n' >"$work/configs/c.yaml"
cp "$SOURCE/pipelines/ventriculostomy.yaml" "$work/configs/p.yaml"
sed 's,\.\./materials,materials,' "$SOURCE/configs/scenes/ventriculostomy.yaml" >"$work/configs/s.yaml"
cp "$SOURCE/configs/materials.yaml" "$work/configs"
expect 78 'c.yaml:4:1: caes: .*case' "${run[@]}" "$work/configs/c.yaml" --series "$SOURCE/sample_dicom" --out "$work/out"

# What a stage takes for a wrong use is, from a configuration, a wrong configuration.
cat >"$work/configs/bp.yaml" <<'END'
trephine: 1
anatomies:
  skin:
    colour_rgb: [0.87, 0.68, 0.56]
    shows_face: false
    stages: [presegment: {lower_hu: -475}, snake: {bubbles: nonsense}, contour]
END
printf 'trephine: 1\nanatomies: {skin: {}}\nface: {policy: keep, reason: a test}\n' >"$work/configs/bs.yaml"
printf 'trephine: 1\npipeline: bp.yaml\nscene: bs.yaml\n' >"$work/configs/bc.yaml"
expect 78 'skin.snake: bubbles: "nonsense"' "${run[@]}" "$work/configs/bc.yaml" --series "$SOURCE/sample_dicom" --out "$work/out" --case x

# A folder that cannot be made (a file stands there), and one that cannot be written: before any work.
echo >"$work/file"
expect 73 'trephine run: .*file' "${run[@]}" "$SOURCE/configs/sample.yaml" --out "$work/file"
expect 73 'trephine run: .*file' "${run[@]}" "$SOURCE/configs/sample.yaml" --out "$work/file/below"
if [[ $(id -u) != 0 ]]; then
  mkdir "$work/readonly" && chmod a-w "$work/readonly"
  expect 73 'trephine run: .*readonly' "${run[@]}" "$SOURCE/configs/sample.yaml" --out "$work/readonly"
fi

# A disk that is too small for the case, once the scan's size is known, before anything is made of it.
if mkdir "$work/small" && mount -t tmpfs -o size=2m none "$work/small" 2>/dev/null; then
  code=0; "${run[@]}" "$SOURCE/configs/sample.yaml" --out "$work/small" --no-use-cache 2>"$work/said" || code=$?
  left=$(find "$work/small" -type f)
  umount "$work/small"
  [[ $code == 73 ]] && grep -Eq '^trephine run: sample: .*disk: [0-9.]+ MB are needed by estimate, [0-9.]+ MB are free' "$work/said" ||
    { cat "$work/said"; fail "a disk that is too small: $code"; }
  [[ -z $left ]] || fail "a run without disk left $left"
else
  echo "no tmpfs can be mounted here: the small disk is left out"
fi

# A threshold that no voxel reaches.
expect 80 'trephine run: sample: skull.segment: .*voxel' "${run[@]}" "$SOURCE/configs/sample.yaml" --out "$work/gate" \
  --set skull.segment.lower_hu=30000 --set skull.segment.seed_lower_hu=30000
[[ ! -e $work/gate/sample ]] || fail "a refused case left its folder"

# Burr holes: where they are not said, where a landmark is missing, where there is no bone; materials nobody has.
drilled=("${run[@]}" "$work/configs/d.yaml" --series "$SOURCE/sample_dicom" --out "$work/out" --set "haptic.spacing_mm=[3,3,3]")
sed 's,\.\./materials,materials,' "$SOURCE/configs/scenes/ventriculostomy_drilled.yaml" >"$work/configs/t.yaml"
d() { printf 'trephine: 1\ncase: d\npipeline: p.yaml\nscene: t.yaml\n%s\n' "$1" >"$work/configs/d.yaml"; }
d ''
expect 78 'd.yaml:1:1: burr_holes: is missing' "${drilled[@]}"
d $'landmarks: {nasion: [0, -93, 40], inion: [0, 89, 6]}\nburr_holes: [{toward: monro}]'
expect 78 'd.yaml:6:.*burr_hole_1.toward: monro, no such landmark' "${drilled[@]}"
# A recipe that finds no landmarks needs them given.
sed '/^landmarks:/d' "$work/configs/p.yaml" >"$work/configs/q.yaml"
d 'burr_holes: [{side: right}]'
sed -i 's/p\.yaml/q.yaml/' "$work/configs/d.yaml"
expect 78 'd.yaml:5:.*burr_hole_1.landmarks.nasion: is missing; give it' "${drilled[@]}"
d 'burr_holes: [{at: position}]'
expect 78 'd.yaml:5:.*burr_hole_1.position_mm: is missing' "${drilled[@]}"
d 'burr_holes: [{at: position, position_mm: [0, 0, 300], direction: [1, 0, 0]}]'
(cd "$work" && refuses 80 'trephine run: d: burr_hole_1.*skull' "${drilled[@]}" "${coarsest[@]:0:2}")  # after warnings of coarse voxels
sed -i 's/material: bone/material: bon/' "$work/configs/t.yaml"
expect 78 't.yaml:[0-9:]*: haptic.shapes.skull.material: bon, no such material, did you mean bone' "${drilled[@]}"
[[ ! -e $work/out/d ]] || fail "a refused burr hole left a folder"

# Single tools: flags that contradict each other, or that would be overlooked.
echo >"$work/v.nrrd" && echo >"$work/h.json"
felt=("$TREPHINE" voxelize "$work/v.nrrd" --output "$work/felt.nrrd")
expect 64 '--shape, --encoding: give shapes' "${felt[@]}"
expect 64 '--region-of: bone, no such --shape' "${felt[@]}" --encoding hu --shapes bone:window_hu=300,3000 --region-of bone
expect 64 '--shapes: .*lower one first' "${felt[@]}" --encoding hu --shapes bone:window_hu=3000,300
expect 64 '--shapes: .*did you mean window_hu' "${felt[@]}" --encoding hu --shapes bone:window=300,3000
expect 64 '--shape: Bone, a name has' "${felt[@]}" --encoding hu --shapes Bone:window_hu=300,3000
expect 64 '--shapes: .*clear_of: and clear_mm go together' "${felt[@]}" --shape "a=$work/v.nrrd" --shapes a:clear_of=a
expect 64 '--cutters, --drill: go together' "${felt[@]}" --shape "a=$work/v.nrrd" --cutters "$work/h.json"
expect 64 '--drill: .*widen_mm, must be a number from 0 to 50' "${felt[@]}" --shape "a=$work/v.nrrd" --cutters "$work/h.json" \
  --drill a:widen_mm=-1
expect 64 '--kind: nothing to cut with' "$TREPHINE" boolean "$work/v.nrrd" --output "$work/o.nrrd"
expect 65 'h.json' "$TREPHINE" boolean "$work/v.nrrd" --cutters "$work/h.json" --output "$work/o.nrrd"
[[ ! -e $work/felt.nrrd && ! -e $work/o.nrrd ]] || fail "a refused tool left an output"

# A scene that shows a face without saying so.
sed '/^face:/d' "$work/configs/s.yaml" >"$work/configs/faceless.yaml"
printf 'trephine: 1\npipeline: p.yaml\nscene: faceless.yaml\n' >"$work/configs/c.yaml"
expect 81 'trephine run: .*face' "${run[@]}" "$work/configs/c.yaml" --series "$SOURCE/sample_dicom" --out "$work/out"

# A recipe that does not say whether an anatomy shows a face, and a scene with a broken line: both are named.
sed '/shows_face: true/d' "$SOURCE/pipelines/ventriculostomy.yaml" >"$work/configs/p.yaml"
expect 78 'p.yaml:5:5: anatomies.skin.shows_face: is missing' "${run[@]}" "$work/configs/c.yaml" \
  --series "$SOURCE/sample_dicom" --out "$work/out"

# Flags of measure that would be overlooked, and help.
echo >"$work/file.vtp"
expect 64 '--anatomy: is needed with --truth' "$TREPHINE" measure "$work/file.vtp" --truth "$work/file.vtp"
expect 64 '--anatomy: is of the truth' "$TREPHINE" measure "$work/file.vtp" --anatomy skull
expect 64 '--label: .*--labels' "$TREPHINE" measure "$work/file.vtp" --label 3
"$TREPHINE" help run >"$work/help"  # all of it: a reader that stops early would be an error of its own
grep -q 'Usage: trephine run' "$work/help" || fail "trephine help run"
"$TREPHINE" --help >"$work/help"
grep -q completion "$work/help" || fail "--help does not list completion"

find "$work" -name '.trephine-tmp-*' | grep . && fail "temporary files are left"
echo ok
