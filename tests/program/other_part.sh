#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A scan of another part of the body than the recipe's: refused where that is sure, with a remedy that works, and told as doubtful
# where it is not, as of a jaw.
. "$(dirname "$0")/common.sh"
cd "$SOURCE"
library=$work/library
make() {  # FOLDER PARAMETER...
  "$TREPHINE" phantom "$@" --slice-step-mm 2.5 --slice-thickness-mm 2.5 --columns-count 160 --rows-count 160 --field-of-view-mm 240 \
    --mesh-step-mm 0 --no-labels --quiet
}
make "$work/jaw" --level hard --seed 9 --slices-count 20 --centre-mm 0,0,-75
make "$work/spine" --body spine --slices-count 60
skull() {  # PART PARAMETER...
  "$TREPHINE" run configs/ct_skull.yaml --series "$work/$1/dicom" --out "$library" --case "$1" --no-page --no-pictures "${@:2}" \
    >"$work/out" 2>"$work/said"
}
is_doubtful() {  # PART
  grep -q '^skull: doubtful.*; it is not sure that the scan shows the part of the body that is made of it' "$work/out" || {
    cat "$work/out" >&2; fail "$1: no word in the verdict"; }
}
skull jaw || { cat "$work/said" >&2; fail "the jaw was refused"; }
grep -q 'nothing says that a head was scanned' "$work/said" || { cat "$work/said" >&2; fail "no warning of the jaw"; }
is_doubtful jaw

# A head is no spine, and is told so before anything is looked for in it.
code=0; "$TREPHINE" run configs/ct_spine_bone.yaml --series sample_dicom --out "$library" --case spineless --quiet >"$work/out" 2>"$work/said" || code=$?
[[ $code == 80 ]] && grep -q 'body_part: .*a head is seen .*configs/ct_head.yaml makes a head' "$work/said" || { cat "$work/said" >&2; fail "a head as a spine: $code"; }

code=0; skull spine || code=$?
[[ $code == 80 ]] || { cat "$work/said" >&2; fail "a spine as a skull: exit code $code"; }
grep -q 'a spine is seen, and no head.*--set body_part.refuse=false makes it' "$work/said" || { cat "$work/said" >&2; fail "no remedy"; }
[[ ! -e $library/spine ]] || fail "a case was left"
skull spine --set body_part.refuse=false || { cat "$work/said" >&2; fail "the remedy does not work"; }
is_doubtful spine
