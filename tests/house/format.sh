#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# format.sh ROOT: every source is as clang-format 14 (Debian 12's) leaves it. 77 (skipped) where that version is
# absent, but in ./check a failure.
set -u
cd "$1" || exit 2
skip() { echo "skipped: $*"; [ "${TREPHINE_CHECK:-}" != 1 ] || exit 1; exit 77; }
tool=$(command -v clang-format-14 || command -v clang-format) || skip "no clang-format"
"$tool" --version | grep -q 'version 14\.' || skip "clang-format is not version 14, which lays out otherwise"
export tool
wrong=$(find lib tools simulator examples tests bench -type f \( -name '*.h' -o -name '*.cpp' \) -print0 2>/dev/null |
  xargs -0 -r -n 8 -P 2 bash -c 'for f; do "$tool" "$f" | cmp -s - "$f" || echo "$f"; done' format | sort)
[ -z "$wrong" ] || { printf '%s\nnot formatted; run clang-format -i on these\n' "$wrong"; exit 1; }
