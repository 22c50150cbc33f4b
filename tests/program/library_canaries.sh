#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Canaries in the tags and the folders' names of two series of a library, one of which is damaged: none of them is anywhere in the
# library, its logs, its cache or its page, nor in what the commands say (acceptance P1, P3).
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/library_common.sh"
cd "$work/l"
canaries="$SOURCE/tests/program/canaries.py"
for n in 1 2; do "$TREPHINE" phantom "$work/l/$n" $tiny_flags --seed $n --quiet >/dev/null; done
mkdir CANARYSCANS
python3 "$canaries" put 1/dicom CANARYSCANS/CANARYONE^ERIKA
python3 "$canaries" put 2/dicom CANARYSCANS/CANARYTWO
printf 'trephine: 1\nconfig: c.yaml\nseries: [CANARYSCANS/*]\n' >l.yaml
said=$work/said
mkdir "$said"
library() { local what=$1; shift; "$TREPHINE" library "$what" "$@" >>"$said/out" 2>>"$said/err"; }
library build l.yaml --out "$work/out" --json "$said/build.json" --dry-run
library build l.yaml --out "$work/out" --json "$said/build.json" || { cat "$said"/*; fail "build"; }
token=$(basename "$(dirname "$(ls "$work"/out/case-*/case.json | head -1)")")
library build l.yaml --out "$work/out" --set skull.smooth.iterations_count=4 --why "$token"
# A slice loses its end, another one its pixels' description: the messages of what fails.
for slice in CANARYSCANS/CANARYTWO/CANARYFILE0003.dcm CANARYSCANS/CANARYTWO/CANARYFILE0004.dcm; do truncate -s -300 "$slice"; done
code=0; library build l.yaml --out "$work/out" --set skull.smooth.iterations_count=4 || code=$?
[[ $code == 65 ]] || { cat "$said"/*; fail "a damaged series ends with $code"; }
# Its folder may not be named, its number among those found is.
grep -q '^series\[0\] folder 2 ' "$said/out" || { cat "$said/out"; fail "the damaged series is not told"; }
library list "$work/out" --sheet --json "$said/list.json"
library show "$work/out" "$token"
library verify "$work/out"
library gc "$work/out"
[[ -s $work/out/index.html && -d $work/out/.trephine-cache ]] || fail "no page or no cache"
python3 "$canaries" seek CANARYSCANS/CANARYONE^ERIKA "$work/out" "$said" || fail "canaries"
echo ok
