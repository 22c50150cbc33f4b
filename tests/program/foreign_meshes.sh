#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Other programs' meshes through measure and repair: no crash, no hang, a verdict each (M7). A few are written here; others' bad
# ones are taken from ${TREPHINE_DATA:-~/.cache/trephine-data}/bad_meshes where that is there.
. "$(dirname "$0")/common.sh"
cd "$work"

# A cube of 20 mm as OBJ: five sides, one of them turned, one of them twice; $1: the sixth, or not.
cube() {
  printf 'v 0 0 0\nv 20 0 0\nv 20 20 0\nv 0 20 0\nv 0 0 20\nv 20 0 20\nv 20 20 20\nv 0 20 20\n'
  printf 'f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 1 2 6 5\nf 6 7 3 2\nf 3 4 8 7\n%s' "$1"
}
cube $'f 4 1 5 8\n' >closed.obj
cube '' >open.obj
for name in closed open; do
  "$TREPHINE" repair $name.obj --output $name.vtp --report $name.json --quiet
  python3 - $name.json <<'PY'
import json, sys
r = json.load(open(sys.argv[1]))
assert r["method"] == "mended", r
assert r["flipped_count"] > 0 and r["duplicates_dropped_count"] > 0, r
assert r["holes_filled_count"] == (1 if "open" in sys.argv[1] else 0), r
assert abs(r["volume_ml"] - 8) < 0.001, r
PY
  "$TREPHINE" measure $name.vtp --report $name.json --quiet
  grep -q '"valid": true' $name.json || fail "$name is not valid after repair"
done
"$TREPHINE" measure open.obj --report open_before.json --quiet 2>"$work/stderr"
grep -q '"valid": false' open_before.json || fail "measure took an open mesh for a valid one"
grep -q 'not valid' "$work/stderr" || fail "measure did not warn"

printf 'v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n' >sheet.obj
expect 80 '^trephine repair: sheet.obj: .*enclose nothing' "$TREPHINE" repair sheet.obj --output sheet.vtp
[[ ! -e sheet.vtp ]] || fail "a refused surface was written"
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n' >index.ply
printf 'property list uchar int vertex_indices\nend_header\n0 0 0\n9 0 0\n0 9 0\n3 0 1 77\n' >>index.ply
expect 65 '^trephine repair: index.ply: ' "$TREPHINE" repair index.ply --output index.vtp
expect 64 '^trephine repair: .*must end in .vtp' "$TREPHINE" repair closed.obj --output closed.stl

data=${TREPHINE_DATA:-$HOME/.cache/trephine-data}/bad_meshes
if [[ ! -d $data ]]; then
  echo "others' bad meshes are not there: $data"
  echo ok
  exit
fi
# verdict COMMAND...: 0, 64 (extension), 65 or 80, no hang, and a line where it is not 0.
verdict() {
  local got=0
  timeout 900 "$@" >"$work/stdout" 2>"$work/stderr" || got=$?
  case $got in
    0) ;;
    64 | 65 | 80) [[ $(grep -c '^trephine [a-z]*: ' "$work/stderr") -ge 1 ]] || fail "no line of why: $*" ;;
    *) cat "$work/stderr" >&2; fail "exit code $got: $*" ;;
  esac
  code=$got
}
repaired=0 refused=0 unreadable=0
while IFS= read -r -d '' file; do
  verdict "$TREPHINE" measure "$file" --quiet
  readable=$code
  rm -f one.vtp
  verdict "$TREPHINE" repair "$file" --recontour-voxels-count 96 --time-limit-s 20 --output one.vtp --quiet
  [[ $readable == 0 || $code != 0 ]] || fail "repair reads what measure does not: $file"
  if [[ $code == 0 ]]; then
    repaired=$((repaired + 1))
    "$TREPHINE" measure one.vtp --report one.json --quiet
    grep -q '"valid": true' one.json || fail "not valid after repair: $file"
  elif [[ $readable == 0 ]]; then
    refused=$((refused + 1))
    echo "refused: ${file#"$data"/}: $(tail -1 "$work/stderr")"
  else
    unreadable=$((unreadable + 1))
  fi
done < <(find "$data" -type f \( -name '*.stl' -o -name '*.STL' -o -name '*.ply' -o -name '*.obj' \) -print0 | sort -z)
echo "$repaired repaired, $refused refused, $unreadable unreadable"
[[ $repaired -gt 10 ]] || fail "too few were repaired"
echo ok
