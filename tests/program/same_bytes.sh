#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# case.json and all that it names are the same bytes with 1 and 2 threads, in another folder, time zone and locale, and the
# README's chain of single tools gives the surfaces of `run`, bit for bit.
. "$(dirname "$0")/common.sh"
config=$SOURCE/configs/sample.yaml

"$TREPHINE" run "$config" --out "$work/one" --threads 1 --no-use-cache --quiet --keep "$work/kept"
mkdir -p "$work/a folder/ünder"
TZ=Asia/Kathmandu LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 \
  "$TREPHINE" run "$config" --out "$work/a folder/ünder" --threads 2 --no-use-cache --quiet
[[ $(case_digest "$work/one/sample") == "$(case_digest "$work/a folder/ünder/sample")" ]] || fail "the bytes differ"
find "$work" -name '.trephine-tmp-*' | grep . && fail "temporary files are left"
grep -aiE "$(hostname)|$work|TREPHINE\^PHANTOM" "$work/one/sample/case.json" && fail "case.json holds a host, a path or a name"

cd "$work"
"$TREPHINE" import "$SOURCE/sample_dicom" --output volume.nrrd --quiet
sed -n '/<!-- chain -->/,/<!-- end -->/p' "$SOURCE/README.md" | sed -n '/^```sh/,/^```$/p' | sed '/^```/d' >chain.sh
grep -q 'trephine normals' chain.sh || fail "README.md holds no chain of single tools"
PATH=$(dirname "$TREPHINE"):$PATH bash -euo pipefail chain.sh
cmp skull.vtp kept/skull.normals.vtp || fail "the chain's skull differs from run's"
cmp volume.nrrd kept/import.nrrd || fail "the imported volume differs"
echo ok
