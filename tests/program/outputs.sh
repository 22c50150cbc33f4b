#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What a run leaves beside case.json: nothing of an older state of the case, all of --keep, what lay beside the series. And
# what it refuses to do: write into the case's own folder, publish with a warning untold.
. "$(dirname "$0")/common.sh"
out=$work/out case=$work/out/small
mkdir "$work/series"
cp "$SOURCE"/sample_dicom/* "$work/series"
cp "$SOURCE/pipelines/ventriculostomy.yaml" "$work/p.yaml"
printf 'trephine: 1\ncase: small\nseries: series\npipeline: p.yaml\nscene: s.yaml\n' >"$work/c.yaml"
scene() { printf 'trephine: 1\nanatomies: {%s}\nface: {policy: keep, reason: synthetic}\n' "$1" >"$work/s.yaml"; }
run=("$TREPHINE" run "$work/c.yaml" --out "$out" --quiet "${coarse[@]}")
pictures() { (cd "$case" && echo report/*.png); }
# The files under meshes/ are those that case.json names.
expect_no_old_files() {
  case_digest "$case" >/dev/null
  [[ $(ls "$case/meshes" | sort) == "$(grep -o '"meshes/[^"]*"' "$case/case.json" | tr -d '"' | sed 's,meshes/,,' | sort -u)" ]] ||
    fail "meshes/ holds what case.json does not name: $(ls "$case/meshes")"
}

scene 'skin: , skull: '
"${run[@]}"
expect_no_old_files
[[ $(pictures) == "report/axial.png report/coronal.png report/cut.png report/middle.png report/overview.png report/removed_by_body.png report/sagittal.png" ]] ||
  fail "pictures: $(pictures)"
# Six sides of each surface are drawn for whoever asks, by the run or of the case.
"$TREPHINE" pictures "$case" --quiet
made=$(pictures)
[[ $made == *"report/skin_sides.png report/skull_sides.png" ]] || fail "pictures of the sides: $made"
"${run[@]}"
[[ $(pictures) != *_sides.png* ]] || fail "pictures of an older run are left: $(pictures)"
"${run[@]}" --report full
[[ $(pictures) == "$made" ]] || fail "a full report: $(pictures)"
expect 64 '[-]-report' "${run[@]}" --report whole

# Refused by the scene's limit after all was computed: the old case and its pictures stay as they were, and the warnings,
# here of a file that is cut short, are told all the same.
before=$(cd "$case" && cat case.json report/*.png | sha256sum)
scene 'skull: {max_deviation_mm: 0.35}'
slice=$(ls "$work/series" | head -1)
head -c 300 "$work/series/$slice" >"$work/series/cut"
code=0
"${run[@]}" --set skull.decimate.max_deviation_mm=3 2>"$work/stderr" || code=$?
[[ $code == 80 ]] || { cat "$work/stderr"; fail "exit code $code instead of 80"; }
grep -q 'small: skull: deviates by .* the scene allows 0.35' "$work/stderr" || { cat "$work/stderr"; fail "no reason"; }
grep -q 'warning: small: import: .*left out' "$work/stderr" || { cat "$work/stderr"; fail "no warning"; }
rm "$work/series/cut"
[[ $before == "$(cd "$case" && cat case.json report/*.png | sha256sum)" ]] || fail "a refused run changed the case"

# An anatomy less; a warm cache keeps no output from --keep; what lies beside the series is told, but changes no byte.
scene 'skull: '
"${run[@]}"
expect_no_old_files
[[ $(pictures) == "report/axial.png report/coronal.png report/cut.png report/middle.png report/overview.png report/removed_by_body.png report/sagittal.png" ]] ||
  fail "pictures: $(pictures)"
first=$(case_digest "$case")
echo note >"$work/series/notes.txt"
"${run[@]}" --keep "$work/kept" --no-pictures --json "$work/run.json"
[[ $first == "$(case_digest "$case")" ]] || fail "a file that is no DICOM changed the case"
[[ $(pictures) == 'report/*.png' ]] || fail "pictures of an older run are left: $(pictures)"
for node in import skin.segment skull.segment skull.contour skull.decimate skull.smooth skull.normals; do
  ls "$work/kept/$node".* >/dev/null || fail "--keep lacks $node"
done
grep -q '"skipped_not_dicom_count": 1' "$work/run.json" || fail "run.json does not tell what lay in the folder"

# Nothing of the user's may end up in the case's folder.
expect 64 '--json: lies in the case' "${run[@]}" --json "$case/x.json"
expect 64 '--keep: lies in the case' "${run[@]}" --keep "$case/kept"
expect 64 '--cache: lies in the case' "${run[@]}" --cache "$case"

# Two series: the message says how to choose, and choosing works.
"$TREPHINE" phantom "$work/other" --columns-count 64 --rows-count 64 --slices-count 12 --quiet
cp "$work/other/dicom"/* "$work/series"
expect 64 'series: 2 usable series.*--set import.series=s1' "${run[@]}"
expect 64 'proposed is s1-.*--set import.series_rule=best takes it' "${run[@]}"

long_only

"${run[@]}" --set import.series=s1 --no-pictures
[[ $first != "$(case_digest "$case")" ]] || fail "the choice of the series is not among the case's parameters"
echo ok
