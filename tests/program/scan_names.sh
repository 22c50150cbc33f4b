#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Names of a scan's folders and files, which may be patients', stand in no message and in no other process's words; the map that says
# which file is which is for its owner alone.
. "$(dirname "$0")/common.sh"
cd "$work"
mkdir -p CANARYDOE_JOHN/CANARYSCANS
n=0
for slice in "$SOURCE"/sample_dicom/*.dcm; do cp "$slice" "CANARYDOE_JOHN/CANARYSCANS/CANARY$((1000 + n++)).dcm"; done
truncate -s -300 CANARYDOE_JOHN/CANARYSCANS/CANARY1005.dcm
silent() { ! grep -q CANARY said || fail "a name is told: $(cat said)"; }
refuse() {  # refuse CODE PATTERN COMMAND...
  local code=$1 pattern=$2 got=0
  shift 2
  "$@" >said 2>&1 || got=$?
  [[ $got == "$code" ]] && grep -Eq "$pattern" said || fail "exit $got, not $code with $pattern: $(cat said)"
  silent
}
refuse 65 "^trephine import: scan: file 6 of $n \([0-9a-f]{8}\): PixelData" "$TREPHINE" import CANARYDOE_JOHN --output o.nrrd --quiet
refuse 65 'scan: file 6 of' "$TREPHINE" run "$SOURCE/configs/sample.yaml" --series CANARYDOE_JOHN --out lib --quiet
refuse 66 'scan: --series: not found: of the 1 part of the path that is given none exists' "$TREPHINE" run "$SOURCE/configs/sample.yaml" --series CANARYNOWHERE --out lib --quiet
refuse 66 'scan: ' "$TREPHINE" import CANARYNOWHERE --list
refuse 65 'scan \([0-9a-f]{8}\): PixelData' "$TREPHINE" import CANARYDOE_JOHN/CANARYSCANS/CANARY1005.dcm --output o.nrrd --quiet
# The map names it, and nobody else may read it, whatever stood there before.
"$TREPHINE" import CANARYDOE_JOHN --output o.nrrd --quiet 2>said || true
digest=$(sed -E 's/.*\(([0-9a-f]{8})\).*/\1/' said)
echo old >private.tsv
chmod 0644 private.tsv
"$TREPHINE" import CANARYDOE_JOHN --list --file-map private.tsv >said 2>&1 || fail "no list: $(cat said)"
silent
[[ $(stat -c %a private.tsv) == 600 ]] || fail "mode $(stat -c %a private.tsv)"
grep -Pq "^6\t$digest\tCANARYSCANS/CANARY1005.dcm$" private.tsv || fail "not in the map: $(cat private.tsv)"
[[ $(head -c 4096 CANARYDOE_JOHN/CANARYSCANS/CANARY1005.dcm | sha256sum | head -c 8) == "$digest" ]] || fail "the digest is another one"
refuse 64 'file_map|file-map' "$TREPHINE" import CANARYDOE_JOHN --output o.nrrd --file-map private.tsv
# The words of a command from standard input, or from a descriptor, as a library's jobs have them.
printf '%s\0' import CANARYDOE_JOHN --list | "$TREPHINE" @- >said 2>&1 || fail "@-: $(cat said)"
grep -q 'PixelData' said || fail "@- lists nothing: $(cat said)"
printf '%s\0' import CANARYNOWHERE --list >words
refuse 66 '^trephine import: scan: ' "$TREPHINE" @7 7<words
refuse 64 'a command is needed' "$TREPHINE" @- </dev/null
