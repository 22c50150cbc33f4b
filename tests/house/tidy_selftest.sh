#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tidy_selftest.sh SCRIPT: which sources tidy.sh reads, shown with a clang-tidy that only writes down its file: what changed in the last
# 30 commits; of more than 60 a part that moves on with each commit; a part of all without a change or a history; none is a failure.
set -eu
script=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
export GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@b GIT_COMMITTER_NAME=a GIT_COMMITTER_EMAIL=a@b GIT_CONFIG_GLOBAL=/dev/null
export READ="$tree/read" PATH="$tree/bin:$PATH"
mkdir -p "$tree"/{bin,work/tests/house,work/cmake,work/lib/grid,work/tools,work/simulator}
cp "$script" "$tree/work/tests/house/tidy.sh"
cp "$(dirname "$script")/../../cmake/unity_groups.awk" "$tree/work/cmake/"
printf '#!/bin/sh\n' > "$tree/bin/cmake"
printf '#!/bin/sh\nfor f; do :; done; sed -n "s,^#include .*/work/\\(.*\\).$,\\1,p" "$f" >> "$READ"\n' > "$tree/bin/clang-tidy-14"
chmod +x "$tree/bin/"*
cd "$tree/work"
for n in $(seq 100 249); do echo "#include \"grid/$n.h\"" > "lib/grid/$n.cpp"; echo > "lib/grid/$n.h"; done
reads() {  # COUNT WHY: so many sources are read
  rm -f "$READ"
  bash tests/house/tidy.sh > "$tree/told" || { cat "$tree/told"; echo "$2: fails"; exit 1; }
  [ "$(sort -u "$READ" | wc -l)" = "$1" ] || { cat "$tree/told"; echo "$2: $(sort -u "$READ" | wc -l) read, not $1"; exit 1; }
}
commit() { git add -A; git commit -q --allow-empty -m "$1"; }

reads 60 "no history"
git init -q .
commit first
reads 60 "nothing changed since the first commit"
for n in $(seq 30); do commit "$n"; done
for n in $(seq 100 111); do echo >> "lib/grid/$n.cpp"; done
echo >> lib/grid/200.h
commit "a header and 12 sources"
reads 13 "the last 30 commits"
grep -qx lib/grid/200.cpp "$READ" || { echo "a header that changed is not read"; exit 1; }
for n in $(seq 29); do commit "$n"; done
reads 13 "changed 29 commits ago"
commit 30
reads 60 "changed 30 commits ago"
for n in $(seq 100 249); do echo >> "lib/grid/$n.cpp"; done
for n in 1 2 3; do
  commit "all $n"
  reads 60 "150 changed"
  cat "$READ" >> "$tree/all"
done
[ "$(sort -u "$tree/all" | wc -l)" = 150 ] || { echo "three commits in a row read $(sort -u "$tree/all" | wc -l) of 150"; exit 1; }
git tag 1.0
echo >> lib/grid/120.cpp
commit "after the tag"
reads 1 "since the tag"
rm -r lib/grid/*
if bash tests/house/tidy.sh > "$tree/told"; then echo "without a source it succeeds"; exit 1; fi
