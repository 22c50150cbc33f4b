#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# sizes.sh ROOT: no C++ file has more than 400 lines, no room (a folder of lib/ or simulator/; of
# simulator/lessons each folder is one, and what lies beside them another) more than 6,000 lines of C++.
set -u
cd "$1" || exit 2
most_of_file=400
most_of_room=6000
faults=0
fault() { echo "$1"; faults=$((faults + 1)); }

sources() { find "$@" -type f \( -name '*.cpp' -o -name '*.h' \) -print0; }
folders=()
for folder in lib simulator tools bench tests; do [ -d "$folder" ] && folders+=("$folder"); done
[ ${#folders[@]} -gt 0 ] || { echo "$1: no folder of sources"; exit 2; }

while read -r lines file; do
  [ "$lines" -le $most_of_file ] || fault "$file: $lines lines, at most $most_of_file"
done < <(sources "${folders[@]}" | sort -z | xargs -0 -r -n 500 wc -l | grep -v ' total$')
for room in lib/*/ simulator/*/ simulator/lessons/*/; do
  [ -d "$room" ] || continue
  deep=99
  [ "$room" = simulator/lessons/ ] && deep=1
  lines=$(sources "$room" -maxdepth $deep | xargs -0 -r cat | wc -l)
  [ "$lines" -le $most_of_room ] || fault "${room%/}: $lines lines of C++, at most $most_of_room"
done
[ "$faults" -eq 0 ] || { echo "$faults too long"; exit 1; }
