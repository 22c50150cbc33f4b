#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# contributing.sh ROOT COMPILER: the stage that CONTRIBUTING.md shows is one that compiles and is formatted as it should be.
set -euo pipefail
root=$1 compiler=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 - "$root/CONTRIBUTING.md" "$work" <<'PY'
import pathlib, re, sys
text, out = open(sys.argv[1]).read(), pathlib.Path(sys.argv[2])
files = re.findall(r"`lib/([\w/]+\.(?:h|cpp))`:\n\n```cpp\n(.*?)```", text, re.S)
assert [f for f, _ in files] == ["segmentation/threshold_count.h", "segmentation/threshold_count.cpp",
                                 "stages/threshold_count_stage.cpp"], [f for f, _ in files]
for name, code in files:
    (out / name).parent.mkdir(exist_ok=True)
    (out / name).write_text(code)
PY
for file in "$work"/*/*.cpp; do
  "$compiler" -std=c++17 -Wall -Wextra -Werror -fsyntax-only -I"$work" -I"$root/lib" "$file"
done
if command -v clang-format >/dev/null; then
  clang-format --style=file:"$root/.clang-format" --dry-run --Werror "$work"/*/*
fi
