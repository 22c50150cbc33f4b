#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# reference.sh PROGRAM REFERENCE GOLDEN: the reference that the build made is what the program writes; it has a page for each command that
# --help lists; and the pages of GOLDEN, which people read, are in it word for word.
set -u
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
"$1" reference --out "$fresh" || exit 1
diff -r "$2" "$fresh" || { echo "$2 is not what $1 writes: build it again"; exit 1; }
commands=$("$1" --help | sed -n 's/^  \([a-z][a-z_-]*\)  .*/\1/p')
[[ $(wc -l <<<"$commands") -gt 10 ]] || { echo "--help lists no commands"; exit 1; }
for command in $commands; do
  [[ -s $fresh/$command.md ]] || { echo "$command has no page"; exit 1; }
  grep -q "($command.md)" "$fresh/index.md" || { echo "index.md does not lead to $command.md"; exit 1; }
done
for page in "$3"/*; do
  diff -u "$page" "$fresh/${page##*/}" || { echo "where that is meant: cp $2/${page##*/} $page"; exit 1; }
done
