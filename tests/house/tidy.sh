#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tidy.sh [--all] [FILE...]: clang-tidy (.clang-tidy) on the sources of lib, tools and simulator that changed since the last tag, or
# without a tag in the last 30 commits, with the headers that they include; a header that changed is read through a source that
# includes it. Of more than 60, and of all where none changed or there is no history, 60 are read: which follows from the number of
# commits (without history from the day), so that commits in a row read all of them. Files of a folder are read in groups, as the build
# compiles them, which takes a third of the time. --all: all sources, each by itself, so that one that does not include what it uses is
# found too. Prints how many, and all that was found; ends with 1 where that holds an error (as .clang-tidy defines it) or nothing was
# read, else 0.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
most=60
mapfile -t sources < <(find lib tools simulator -name '*.cpp' | sort)
mapfile -t headers < <(find lib tools simulator -name '*.h' | sort)

files=()
if [[ ${1:-} == --all ]]; then
  files=("${sources[@]}")
elif (($#)); then
  files=("$@")
else
  turn=$(git rev-list --count HEAD 2>/dev/null) || turn=$(($(date +%s) / 86400))
  since=$({ git describe --tags --abbrev=0 || git rev-parse -q --verify HEAD~30 || git rev-list --max-parents=0 HEAD; } 2>/dev/null |
    head -1 || true)
  # Sources that changed, and for every header that changed and that none of them includes, the first that does.
  declare -A changed=()
  if [[ -n $since ]]; then
    while read -r f; do [[ ! -f $f ]] || changed[$f]=1; done < <(git diff --name-only "$since" -- lib tools simulator)
  fi
  for f in "${sources[@]}"; do [[ -z ${changed[$f]:-} ]] || files+=("$f"); done
  for h in "${headers[@]}"; do
    [[ -n ${changed[$h]:-} ]] || continue
    name=${h#*/}
    ((${#files[@]})) && grep -qF -e "#include \"$name\"" -- "${files[@]}" && continue
    first=$(grep -lF -e "#include \"$name\"" -e "#include \"${h##*/}\"" -- "${sources[@]}" | head -1 || true)
    [[ -z $first ]] || files+=("$first")
  done
  echo "since ${since:-the beginning}: ${#files[@]} of ${#sources[@]} sources changed"
  ((${#files[@]})) || files=("${sources[@]}")
  if ((${#files[@]} > most)); then
    from=$((turn * most % ${#files[@]}))
    echo "of ${#files[@]} sources $most are read, from number $from on (./check --long: all)"
    files=("${files[@]:from}" "${files[@]:0:from}")
    files=("${files[@]:0:most}")
  fi
fi
((${#files[@]})) || { echo "no sources: nothing was read"; exit 1; }
tool=$(command -v clang-tidy-14 || command -v clang-tidy) || { echo "no clang-tidy: nothing was read"; exit 1; }

# A configuration of its own, which is never built: each file by itself, and none of gcc's precompiled headers. A group is a file
# beside it that includes its members, with the options of the first.
cmake --preset release -B build/tidy -DTREPHINE_UNITY=OFF -DTREPHINE_TESTS=OFF -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >/dev/null
units=("${files[@]}")
checks=() database=build/tidy
if [[ ${1:-} != --all ]]; then
  checks=(--checks=-bugprone-suspicious-include)  # a group includes sources
  rm -rf build/tidy/read
  mapfile -t units < <(
    for folder in $(dirname "${files[@]}" | sort -u); do
      mkdir -p "build/tidy/read/$folder"
      printf '%s\n' "${files[@]}" | grep -x "$folder/[^/]*" |
        xargs awk -v most_lines=4000 -f cmake/unity_groups.awk | while read -r group member; do
          echo "#include \"$PWD/$member\"" >>"build/tidy/read/$folder/group_$group.cpp"
        done
      printf '%s\n' "${files[@]}" | grep -x "$folder/[^/]*" | xargs grep -l '^#include <CGAL/' || true
    done
    find build/tidy/read -name '*.cpp'
  )
  database=build/tidy/read
  python3 - build/tidy "${units[@]}" <<'END'
import json, re, sys
from pathlib import Path
folder = Path(sys.argv[1])
known = folder / "compile_commands.json"
all = json.loads(known.read_text()) if known.exists() else []
by_file = {c["file"]: c for c in all}
for unit in map(Path, sys.argv[2:]):
    members = re.findall(r'^#include "(/.*)"$', unit.read_text(), re.M) if "tidy/read" in str(unit) else []
    for c in [by_file[m] for m in members if m in by_file][:1]:
        file = str(unit.resolve())
        all.append({**c, "file": file, "command": c["command"].replace(c["file"], file)})
(folder / "read" / "compile_commands.json").write_text(json.dumps(all))
END
fi
found=$(mktemp) said=$(mktemp)
trap 'rm -f "$found" "$said"' EXIT
status=0
printf '%s\0' "${units[@]}" |
  xargs -0 -n 1 -P "$(nproc)" "$tool" -p "$database" --quiet "${checks[@]}" --header-filter='/(lib|tools|simulator)/.*\.(h|cpp)$' \
    >"$found" 2>"$said" || status=$?
# A header's fault is found by every source that includes it. What a library's own headers hold against clang is no fault of ours.
said_errors=$(grep -c ': error: ' "$found" || true)
count() { grep -E "^$PWD/[^ ]+:[0-9]+:[0-9]+: $1: " "$found" | sort -u | wc -l || true; }
awk -v root="$PWD/" '{ sub(root, "") } !/: (warning|error): / { if (shown) print; next } { shown = !seen[$0]++ } shown' "$found"
errors=$(count error)
echo "clang-tidy on ${#files[@]} sources: $errors errors, $(count warning) warnings"
((errors == 0)) || exit 1
# clang-tidy that fails and names no error could not read its input, or crashed.
((status == 0 || said_errors > 0)) || { tail -5 "$said"; echo "clang-tidy failed"; exit 1; }
