#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# sizes_selftest.sh SCRIPT: the check names a file and a room that are too long, and nothing at the limits.
set -u
script=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/lib/{grid,mask} "$tree"/simulator/window "$tree"/tests/deep
seq 400 > "$tree/lib/grid/a.cpp"
for n in $(seq 14); do cp "$tree/lib/grid/a.cpp" "$tree/lib/grid/a$n.h"; done
cp "$tree"/lib/grid/* "$tree/simulator/window"
mkdir -p "$tree"/simulator/lessons/needle
cp "$tree"/lib/grid/* "$tree/simulator/lessons"
cp "$tree"/lib/grid/* "$tree/simulator/lessons/needle"
seq 400 > "$tree/tests/deep/b.cpp"
seq 900 > "$tree/lib/grid/notes.md"
bash "$script" "$tree" || { echo "a tree at its limits is refused"; exit 1; }

expect_fault() {  # FILE NAMED: a line more in the file, and what is named
  touch "$tree/$1"
  cp "$tree/$1" "$tree/before"
  echo more >> "$tree/$1"
  if bash "$script" "$tree" > "$tree/said"; then echo "not found: $1 makes $2 too long"; exit 1; fi
  grep -q "^$2: " "$tree/said" || { cat "$tree/said"; echo "$2 is not named"; exit 1; }
  mv "$tree/before" "$tree/$1"
}
expect_fault lib/grid/a.cpp lib/grid/a.cpp
expect_fault tests/deep/b.cpp tests/deep/b.cpp
expect_fault lib/grid/small.h lib/grid
expect_fault simulator/window/small.h simulator/window
expect_fault simulator/lessons/small.h simulator/lessons
expect_fault simulator/lessons/needle/small.h simulator/lessons/needle
