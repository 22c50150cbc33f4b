#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# format.sh ROOT: every source is as clang-format 14 (Debian 12's) leaves it. 77 (skipped) where that version is
# absent, but in ./check a failure.
set -u
cd "$1" || exit 2
skip() { echo "skipped: $*"; [ "${TREPHINE_CHECK:-}" != 1 ] || exit 1; exit 77; }
tool=$(command -v clang-format-14 || command -v clang-format) || skip "no clang-format"
"$tool" --version | grep -q 'version 14\.' || skip "clang-format is not version 14, which lays out otherwise"
# Many files a call: to start it takes longer than to lay a file out.
said=$(find lib tools simulator python examples tests bench -type f \( -name '*.h' -o -name '*.cpp' \) -print0 2>/dev/null |
  xargs -0 -r -n 100 -P 2 "$tool" --dry-run -Werror 2>&1)
status=$?
wrong=$(sed -n 's/:[0-9]*:[0-9]*: .*clang-format-violations.*//p' <<<"$said" | sort -u)
[ -n "$wrong" ] || [ $status = 0 ] || { printf '%s\n' "$said"; exit 1; }
[ -z "$wrong" ] || { printf '%s\nnot formatted; run clang-format -i on these\n' "$wrong"; exit 1; }
