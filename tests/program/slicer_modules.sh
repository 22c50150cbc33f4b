#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# D26. Commands as modules of 3D Slicer: described, and called, by the rules of its execution model (slicer_modules.py).
. "$(dirname "$0")/common.sh"
: "${WRITE_CASE:?}" "${MODULES:?}"
"$WRITE_CASE" "$work/case" minimal
"$TREPHINE" export --quiet "$work/case" --format vtp --anatomy inner --out "$work/surface" 2>"$work/log" || { cat "$work/log" >&2; fail "no surface"; }
python3 "$SOURCE/tests/program/slicer_modules.py" "$MODULES" "$work" "$work/case" "$work/surface/inner.vtp" "$SOURCE/configs/sample.yaml" ||
  fail "a module is not as Slicer needs it"
expect 64 'slicer-module' "$TREPHINE" slicer-module
expect 64 'exprot: unknown command; did you mean export' "$TREPHINE" slicer-module exprot --xml
! "$TREPHINE" --help | grep -q slicer-module || fail "the hidden command is in the help"
