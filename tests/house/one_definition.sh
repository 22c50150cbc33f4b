#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# one_definition.sh ROOT COMPILER: every file of a room stands in the namespace of its room, and no two headers of the
# programs define the same name: one file that includes all of them compiles. Two types of one name in one program link
# without a word, and what uses them does something else than it says.
set -u
root=$1 compiler=$2
cd "$root" || exit 2
faults=0
fault() { echo "$1"; faults=$((faults + 1)); }

while IFS= read -r file; do
  room=${file#*/} room=${room%%/*}
  [[ $room == base || $room == *.* ]] && continue  # base is trephine itself; simulator/main.cpp is in no room
  if grep -qE '^namespace trephine \{' "$file"; then fault "$file: stands in trephine, not in trephine::$room"; fi
done < <(find lib simulator \( -name '*.h' -o -name '*.cpp' \) 2>/dev/null | sort)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for folder in lib simulator tools; do
  [[ -d $folder ]] && find "$folder" -name '*.h' ! -path 'lib/itk/program/*' ! -path 'lib/tetra/program/*' | sort
done | sed "s|.*|#include \"$PWD/&\"|" > "$work/all.cpp"
includes=(-I lib -I simulator -I tools)
for found in /usr/include/vtk-9.1 /usr/include/gdcm-3.0 /usr/include/eigen3 /usr/include/imgui; do
  [[ -d $found ]] && includes+=(-isystem "$found")
done
"$compiler" -std=c++17 -fsyntax-only -w "${includes[@]}" "$work/all.cpp" > "$work/said" 2>&1 ||
  { grep -E 'error|previous' "$work/said" | head -20; fault "the headers of the programs do not compile together"; }
[ "$faults" -eq 0 ] || exit 1
