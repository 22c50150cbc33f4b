#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Every command that the README shows works as it stands there (the chain of single tools is same_bytes.sh's, the package
# deb.sh's).
. "$(dirname "$0")/common.sh"
PATH=$(dirname "$TREPHINE"):$PATH
cp -r "$SOURCE/configs" "$SOURCE/pipelines" "$SOURCE/sample_dicom" "$SOURCE/trephine.root" "$work"
mkdir -p "$work/build/release"
ln -s "$(dirname "$TREPHINE")" "$work/build/release/bin"
cd "$work"

# Blocks: one a line, FOLDER and LIBRARY filled in.
sed -E '/<!-- (chain|package) -->/,/<!-- end -->/d' "$SOURCE/README.md" | sed -n '/^```sh$/,/^```$/p' | sed '/^```/d' |
  sed 's,FOLDER,sample_dicom,; s,LIBRARY,library,g' >blocks.sh
grep -q 'trephine run' blocks.sh || fail "README.md shows no run"
printf 'trephine: 1\nconfig: configs/ct_head.yaml\ncases: [{case: head-01, series: sample_dicom}]\n' >library.yaml
bash -euo pipefail blocks.sh >/dev/null
case_digest library/head-01 >/dev/null

# Commands within the text. A small head: that the command works is what counts here.
sed '/^```sh$/,/^```$/d' "$SOURCE/README.md" | tr '\n' ' ' | grep -oE '`[^`]*trephine [a-zA-Z][^`]*`' | tr -d '`' |
  sort -u >inline.txt
small=(--columns-count 64 --rows-count 64 --slices-count 40 --pixel-mm 4 --slice-step-mm 5)
seen=0
while read -r line; do
  case $line in
    'trephine phantom head') eval "$line ${small[*]} --quiet" ;;
    'trephine measure skull.vtp --truth '*) ;;  # after the loop: it needs the phantom
    'trephine import --list FOLDER') trephine import --list sample_dicom --quiet | grep -q usable ;;
    'trephine export LIBRARY/head-01 '*)
      mkdir exported
      eval "${line/LIBRARY/library} --quiet" && [[ -s exported/brain.stl && -s exported/skin.x3d ]] ;;
    'eval "$(trephine completion bash)"') (eval "$line" && complete -p trephine) >/dev/null ;;
    'trephine STAGE --help') for s in import segment contour decimate smooth normals; do trephine "$s" --help >/dev/null; done ;;
    *) fail "README.md shows a command that this test does not know: $line" ;;
  esac
  seen=$((seen + 1))
done <inline.txt
[[ $seen == 6 ]] || { cat inline.txt; fail "$seen commands in README.md's text"; }
cp head/truth/skull.vtp skull.vtp
eval "$(grep '^trephine measure' inline.txt) --quiet"
echo ok
