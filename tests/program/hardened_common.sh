# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced, after common.sh, by the scripts that look at how the programs are linked.

has_no_run_path() {  # FILE: it looks for libraries nowhere but where the system does
  ! readelf -dW "$1" 2>/dev/null | grep -E '\((RPATH|RUNPATH)\)' || fail "$1 looks for libraries there"
}

has_whole_run_path() {  # FILE: none of the folders where it looks for libraries is the working folder, or lies below it
  local paths
  paths=$(readelf -dW "$1" 2>/dev/null | sed -n 's/.*(\(RPATH\|RUNPATH\)).*\[\(.*\)\]$/\2/p')
  [[ -z $paths || ":$paths:" =~ ^:(/[^:]*:)+$ ]] || fail "$1 looks for libraries in $paths"
}

is_hardened() {  # PROGRAM
  has_no_run_path "$1"
  readelf -dW "$1" >"$work/dynamic" && readelf -lW "$1" >"$work/segments" || fail "readelf $1"
  grep -E '\(FLAGS_1\).*NOW' "$work/dynamic" | grep -q PIE || fail "$1 binds late, or lies at a fixed address"
  grep -q GNU_RELRO "$work/segments" || fail "$1: its tables stay writable"
  grep -E 'GNU_STACK +.* RW +0x' "$work/segments" >/dev/null || fail "$1: its stack can be executed"
  ! grep -E 'LOAD .* RWE ' "$work/segments" || fail "$1: a segment can be written and executed"
}
