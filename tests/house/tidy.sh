#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tidy.sh [--all] [FILE...]: clang-tidy (.clang-tidy) on the sources of lib, tools and simulator that changed since the last
# tag, 60 at most, with the headers that they include; a header that changed is read through a source that includes it.
# --all: all sources. Without a tag none is checked unless --all or FILEs say so. Prints how many, and all that was found;
# ends with 1 where that holds an error (as .clang-tidy defines it), else 0.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
most=60
mapfile -t sources < <(find lib tools simulator -name '*.cpp' | sort)
mapfile -t headers < <(find lib tools simulator -name '*.h' | sort)

files=()
if [[ ${1:-} == --all ]]; then
  files=("${sources[@]}")
  most=${#sources[@]}
elif (($#)); then
  files=("$@")
elif tag=$(git describe --tags --abbrev=0 2>/dev/null); then
  # Sources that changed, and for every header that changed and that none of them includes, the first that does.
  declare -A changed=()
  while read -r f; do [[ ! -f $f ]] || changed[$f]=1; done < <(git diff --name-only "$tag" -- lib tools simulator)
  for f in "${sources[@]}"; do [[ -z ${changed[$f]:-} ]] || files+=("$f"); done
  for h in "${headers[@]}"; do
    [[ -n ${changed[$h]:-} ]] || continue
    name=${h#*/}
    ((${#files[@]})) && grep -qF -e "#include \"$name\"" -- "${files[@]}" && continue
    first=$(grep -lF -e "#include \"$name\"" -e "#include \"${h##*/}\"" -- "${sources[@]}" | head -1 || true)
    [[ -z $first ]] || files+=("$first")
  done
  echo "since $tag: ${#files[@]} of ${#sources[@]} sources"
else
  echo "no tag: none of ${#sources[@]} sources with ${#headers[@]} headers is checked (./check --long: all)"
  exit 0
fi
((${#files[@]})) || exit 0
if ((${#files[@]} > most)); then
  echo "$((${#files[@]} - most)) sources beyond the first $most are left out (./check --long: all)"
  files=("${files[@]:0:most}")
fi
tool=$(command -v clang-tidy-14 || command -v clang-tidy) ||
  { echo "skipped: no clang-tidy"; [[ ${TREPHINE_CHECK:-} != 1 ]] || exit 1; exit 77; }

# A configuration of its own, which is never built: each file by itself, and none of gcc's precompiled headers.
cmake --preset release -B build/tidy -DTREPHINE_UNITY=OFF -DTREPHINE_TESTS=OFF -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >/dev/null
found=$(mktemp) said=$(mktemp)
trap 'rm -f "$found" "$said"' EXIT
status=0
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" "$tool" -p build/tidy --quiet >"$found" 2>"$said" || status=$?
# A header's fault is found by every source that includes it.
count() { grep -E "^[^ ]+:[0-9]+:[0-9]+: $1: " "$found" | sort -u | wc -l || true; }
awk -v root="$PWD/" '{ sub(root, "") } !/: (warning|error): / { if (shown) print; next } { shown = !seen[$0]++ } shown' "$found"
errors=$(count error)
echo "clang-tidy on ${#files[@]} sources: $errors errors, $(count warning) warnings"
((errors == 0)) || exit 1
# clang-tidy that fails and names no error could not read its input, or crashed.
((status == 0)) || { tail -5 "$said"; echo "clang-tidy failed"; exit 1; }
