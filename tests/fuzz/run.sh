#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh build FOLDER | run.sh TARGET FOLDER: builds the fuzzers with clang into FOLDER (77 where there is no clang, in ./check 1), or
# runs one for TREPHINE_FUZZ_S seconds (6) on the corpus that fuzz_corpus ($CORPUS) makes. What crashes lies as
# FOLDER/crashes/TARGET-*: make a case of it in tests/dicom_mutants_test.cpp.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
target=$1 folder=$2
compiler=$(command -v clang++ || true)
[[ -n $compiler ]] || { echo "no clang++: not fuzzed"; [[ ${TREPHINE_CHECK:-} != 1 ]] || exit 1; exit 77; }
if [[ $target == build ]]; then
  cmake -G Ninja -S "$here" -B "$folder" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_C_COMPILER="${compiler%++}"
  cmake --build "$folder"
  rm -rf "$folder/seeds"
  "$CORPUS" "$folder/seeds"
  exit
fi
mkdir -p "$folder/found/$target" "$folder/crashes"
# No leak check: it cannot run where processes may not be traced, and the decoder's are the library's.
export ASAN_OPTIONS=detect_leaks=0:max_allocation_size_mb=2000:hard_rss_limit_mb=4000
export UBSAN_OPTIONS=print_stacktrace=1
cd "$folder"
# Not 77, as libFuzzer ends with by default: that means skipped here.
exec "./$target" -max_total_time="${TREPHINE_FUZZ_S:-6}" -max_len=65536 -timeout=30 -rss_limit_mb=3000 \
  -error_exitcode=1 -timeout_exitcode=1 -print_final_stats=1 -artifact_prefix="crashes/$target-" "found/$target" "seeds/$target"
