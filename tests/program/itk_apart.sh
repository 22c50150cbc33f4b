#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Only trephine-itk loads ITK, and it does nothing by itself.
set -eu
fail() { echo "FAIL: $1"; exit 1; }
for program in trephine trephine-sim; do
  libraries=$(ldd "$BIN/$program")
  [[ $libraries == *libstdc++* ]] || fail "ldd says nothing of $program"
  [[ $libraries != *libITK* && $libraries != *libitk* ]] || fail "$program loads ITK"
done
[[ $(ldd "$BIN/trephine-itk") == *ITK* ]] || fail "trephine-itk does not load ITK"
code=0; said=$("$BIN/trephine-itk" 2>&1) || code=$?
[[ $code == 64 && $said == *trephine* ]] || fail "trephine-itk by itself: $code: $said"
