#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# spdx.sh ROOT: every source and script says its licence in its first two lines.
set -u
cd "$1" || exit 2
missing=$({
  find lib tools simulator examples tests bench cmake -type f \( -name '*.h' -o -name '*.c' -o -name '*.cpp' -o -name '*.cmake' -o -name '*.sh' \
    -o -name CMakeLists.txt \) -print0 2>/dev/null
  find . -maxdepth 1 -type f \( -name CMakeLists.txt -o -name quickstart -o -name check \) -print0
} | xargs -0 awk '
  FNR <= 2 && /SPDX-License-Identifier: GPL-3\.0-or-later/ { said[FILENAME] = 1 }
  FNR == 2 { nextfile }
  END { for (i = 1; i < ARGC; ++i) if (!(ARGV[i] in said)) print ARGV[i] ": no SPDX line" }')
[ -z "$missing" ] || { printf '%s\n' "$missing"; exit 1; }
