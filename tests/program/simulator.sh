#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# trephine-sim check: what is in a case, and one line that names the file where it is damaged.
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/sample"
check=("$TREPHINE" check)

"${check[@]}" "$work/sample" >"$work/text" 2>"$work/stderr"
[[ ! -s $work/stderr ]] || fail "a good case is not silent on stderr"
for line in 'case sample, format 2\.0' 'frame LPS, mm, centre 1\.0, -20\.0, 300\.0' '2 anatomies, 216 triangles' \
            '10 x 10 x 10 voxels of 17\.6' 'with hardness, 2 shapes' 'material tissue' 'felt against seen' \
            'landmark nasion' 'target middle' 'burr hole entry .*cut from outer' '4 files, .* in 0\.[0-9]* s'; do
  grep -Eq "$line" "$work/text" || { cat "$work/text"; fail "not said: $line"; }
done
"${check[@]}" "$work/sample" --json >"$work/json"
python3 - "$work/json" "$work/sample" <<'PY'
import json, os, sys
said = json.load(open(sys.argv[1]))
assert said["triangles"] == 216 and said["files"] == 4 and said["seconds"] > 0, said
assert [a["name"] for a in said["anatomies"]] == ["outer", "inner"], said
low, high = said["anatomies"][0]["min_mm"], said["anatomies"][0]["max_mm"]
assert all(150 < h - l < 170 for l, h in zip(low, high)), said
assert said["haptic"]["size"] == [10, 10, 10] and said["haptic"]["shapes"][1]["window"] == [2001, 2555], said
assert said["bytes"] == sum(os.path.getsize(os.path.join(d, f)) for d, _, fs in os.walk(sys.argv[2]) for f in fs)
PY
# The same whatever the thread count.
for threads in 1 2 8; do
  "${check[@]}" "$work/sample" --threads $threads | grep -v ' in 0\.[0-9]* s$' >"$work/text.$threads"
  cmp "$work/text.1" "$work/text.$threads" || fail "$threads threads say something else"
done

expect 66 'trephine-sim check: .*nowhere' "${check[@]}" "$work/nowhere"
mkdir "$work/empty"
expect 66 'trephine-sim check: .*empty/case\.json: .*not found' "${check[@]}" "$work/empty"
expect 64 'trephine-sim: .*chekc.*check' "$TREPHINE" chekc "$work/sample"
for file in case.json $(cd "$work/sample" && ls meshes/*.glb haptic-*.nrrd hardness-*.nrrd); do
  cp -r "$work/sample" "$work/damaged"
  size=$(stat -c %s "$work/damaged/$file")
  truncate -s $((size - 1)) "$work/damaged/$file"
  expect 65 "^trephine-sim check: .*damaged/$file: " "${check[@]}" "$work/damaged"
  cp "$work/sample/$file" "$work/damaged/$file"
  printf '\x01' | dd of="$work/damaged/$file" bs=1 seek=$((size / 2)) conv=notrunc status=none
  expect 65 "^trephine-sim check: .*damaged/$file: checksum: " "${check[@]}" "$work/damaged"
  rm "$work/damaged/$file"
  expect 66 "^trephine-sim check: .*damaged/$file: .*not found" "${check[@]}" "$work/damaged"
  rm -r "$work/damaged"
done
# Another major version: both are named, and no checksum is asked.
cp -r "$work/sample" "$work/other"
sed -i '2s/trephine-case 2\.0/trephine-case 3.0/' "$work/other/case.json"
expect 65 'other/case\.json: format: version 3\.0, this program reads versions 2\.\*: take a newer Trephine' "${check[@]}" "$work/other"
sed -i '2s/trephine-case 3\.0/trephine-case 1.7/' "$work/other/case.json"
expect 65 'other/case\.json: format: version 1\.7, this program reads versions 2\.\*: make the case again' "${check[@]}" "$work/other"
# A name that would forge a second line.
mkdir "$work/$(printf 'a\nb')"
expect 66 'a\?b' "${check[@]}" "$work/$(printf 'a\nb')"
# Somebody reads no further.
set +o pipefail
"${check[@]}" "$work/sample" --json | head -c 1 >"$work/first"
[[ $(cat "$work/first") == '{' ]] || fail "no JSON"
{ sleep 1; "$TREPHINE" servo --help 2>"$work/stderr"; } | true
[[ ! -s $work/stderr ]] || { cat "$work/stderr"; fail "a reader that has enough is reported as a failure"; }
"${check[@]}" "$work/sample" >/dev/full 2>"$work/stderr" && fail "a full device was not noticed"
grep -q 'standard output' "$work/stderr" || fail "a full device is not named"
