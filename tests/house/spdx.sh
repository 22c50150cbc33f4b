#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# spdx.sh ROOT: every source and script says its licence in its first two lines.
set -u
cd "$1" || exit 2
faults=0
while IFS= read -r -d '' file; do
  head -n 2 "$file" | grep -q 'SPDX-License-Identifier: GPL-3.0-or-later' || { echo "$file: no SPDX line"; faults=1; }
done < <(
  find lib tools simulator examples tests bench cmake -type f \( -name '*.h' -o -name '*.c' -o -name '*.cpp' -o -name '*.cmake' -o -name '*.sh' \
    -o -name CMakeLists.txt \) -print0 2>/dev/null
  find . -maxdepth 1 -type f \( -name CMakeLists.txt -o -name quickstart -o -name check \) -print0
)
exit $faults
