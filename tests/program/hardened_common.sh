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

is_compiled_hardened() {  # PROGRAM; FORTIFIED=1 where it was optimised. Debian's crt1.o has no note of its own, so the linker
  # leaves out that of a whole program: the landing pads themselves are counted, and the notes are read in our libraries.
  readelf -W --dyn-syms "$1" >"$work/symbols" || fail "readelf $1"
  grep -q ' __stack_chk_fail@' "$work/symbols" || fail "$1: no canary before a return address"
  # trephine-itk calls nothing that is checked: what it reads comes through templates of its own. Nor do the libraries.
  [[ ${FORTIFIED:-} != 1 || $1 == */trephine-itk || $1 == *.so ]] || grep -Eq ' __(mem|str|stp|v?s?n?v?printf|v?f?printf|read|fd)[a-z]*_chk@' "$work/symbols" ||
    fail "$1: no checked call of libc"
  # A library of a few functions alone has one for each of them; what comes from the compiler's own files has two.
  local functions
  functions=$(awk '$4 == "FUNC" && $7 != "UND"' "$work/symbols" | wc -l)
  [[ $(uname -m) != x86_64 ]] || python3 - "$1" "$functions" <<'PY' || fail "$1: functions without a landing pad"
import sys
program, functions = sys.argv[1], int(sys.argv[2])
least = 200 if not program.endswith(".so") else 20 if functions > 10 else functions + 1
sys.exit(0 if open(program, "rb").read().count(b"\xf3\x0f\x1e\xfa") > least else 1)
PY
}

is_hardened() {  # PROGRAM, or library of ours
  [[ -z ${COMPILED_HARDENED:-} ]] || is_compiled_hardened "$1"
  has_no_run_path "$1"
  readelf -dW "$1" >"$work/dynamic" && readelf -lW "$1" >"$work/segments" || fail "readelf $1"
  grep -E '\(FLAGS_1\).*NOW' "$work/dynamic" | grep -q "$([[ $1 == *.so ]] && echo NOW || echo PIE)" || fail "$1 binds late, or lies at a fixed address"
  grep -q GNU_RELRO "$work/segments" || fail "$1: its tables stay writable"
  grep -E 'GNU_STACK +.* RW +0x' "$work/segments" >/dev/null || fail "$1: its stack can be executed"
  ! grep -E 'LOAD .* RWE ' "$work/segments" || fail "$1: a segment can be written and executed"
}
