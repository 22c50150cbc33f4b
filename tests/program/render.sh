#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Pictures of a case and of a recording without a display, and what is refused.
. "$(dirname "$0")/common.sh"
export LP_NUM_THREADS=1
"$WRITE_CASE" "$work/sample" play
small=(--width 320 --height 240)
unset DISPLAY WAYLAND_DISPLAY
if ! "$TREPHINE" render "$work/sample" --out "$work/one" "${small[@]}" >"$work/text" 2>&1; then
  cat "$work/text"
  grep -q OpenGL "$work/text" && skip "no OpenGL without a display"
  fail "draws nothing"
fi
grep -q '^1 pictures of 320 x 240' "$work/text" || fail "does not say what it drew"

# size FILE: width x height of a PNG; colours FILE: how many it has.
cat >"$work/png.py" <<'PY'
import struct, sys, zlib
def read(name):
    data = open(name, "rb").read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, idat = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        assert zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0]
        if kind == b"IHDR": w, h = struct.unpack(">II", body[:8])
        if kind == b"IDAT": idat += body
        at += 12 + size
    raw, rows, row = zlib.decompress(idat), [], bytes(3 * w)
    for y in range(h):
        line = raw[y * (3 * w + 1):(y + 1) * (3 * w + 1)]
        row = bytes((a + b) & 255 for a, b in zip(line[1:], row)) if line[0] == 2 else line[1:]
        rows.append(row)
    return w, h, rows
def different(a, b):
    return sum(x[i:i + 3] != y[i:i + 3] for x, y in zip(a, b) for i in range(0, len(x), 3))
PY
check() { (cd "$work" && python3 -c "from png import *; $1") || fail "$1"; }
check 'w, h, rows = read("one/frame-00001.png"); assert (w, h) == (320, 240) and len({r[i:i+3] for r in rows for i in range(0, 960, 3)}) > 200'

# The same picture twice; another with each of these.
"$TREPHINE" render "$work/sample" --out "$work/again" "${small[@]}" >/dev/null
cmp "$work/one/frame-00001.png" "$work/again/frame-00001.png" || fail "the same picture differs"
for other in '--opacity scalp=0.3' '--cut sagittal' '--view left' '--stereo side_by_side' '--stereo anaglyph' '--no-occlusion'; do
  read -ra flags <<<"$other"
  "$TREPHINE" render "$work/sample" --out "$work/other" "${small[@]}" "${flags[@]}" >/dev/null
  check 'assert different(read("one/frame-00001.png")[2], read("other/frame-00001.png")[2]) > 60'
done

# A recording: the hole is not there at its begin, and grows.
"$TREPHINE" servo "$work/sample" --no-paced --tool ball --drill --incision-radius-mm 15 --approach-mm 7 --hole-diameter-mm 8 \
  --seconds 12 --record "$work/hole.servo" >/dev/null
"$TREPHINE" render "$work/sample" "$work/hole.servo" --out "$work/film" "${small[@]}" --frames-per-s 0.25 --opacity scalp=0 >"$work/text"
grep -q '^3 pictures\|^4 pictures' "$work/text" || { cat "$work/text"; fail "not a picture for each 4 s"; }
check 'a, b, c = (read(f"film/frame-0000{n}.png")[2] for n in (1, 2, 3)); assert different(a, b) > 50 and different(b, c) > 50'

# Bone dust is seen where it was drilled, the same each time, and can be left out.
dusty() { "$TREPHINE" render "$work/sample" "$work/hole.servo" --out "$work/$1" "${small[@]}" --from-s 11 --to-s 11 --opacity scalp=0 "${@:2}" >/dev/null; }
dusty dust; dusty dust_again; dusty no_dust --no-dust
cmp "$work/dust/frame-00001.png" "$work/dust_again/frame-00001.png" || fail "the same dust differs"
check 'assert different(read("dust/frame-00001.png")[2], read("no_dust/frame-00001.png")[2]) > 50'

# Settings from a file: what the command line gives comes first, and what is wrong is refused.
echo '{"view": "left", "width": 320, "height": 240, "occlusion": false}' >"$work/settings.json"
"$TREPHINE" render "$work/sample" --out "$work/set" --settings "$work/settings.json" --write-settings "$work/all.json" >/dev/null
"$TREPHINE" render "$work/sample" --out "$work/flags" "${small[@]}" --view left --no-occlusion >/dev/null
cmp "$work/set/frame-00001.png" "$work/flags/frame-00001.png" || fail "settings are not flags"
"$TREPHINE" render "$work/sample" --out "$work/read" --settings "$work/all.json" >/dev/null
cmp "$work/set/frame-00001.png" "$work/read/frame-00001.png" || fail "written settings are others"
"$TREPHINE" render "$work/sample" --out "$work/first" --settings "$work/settings.json" --view surgeon --occlusion >/dev/null
cmp "$work/one/frame-00001.png" "$work/first/frame-00001.png" || fail "the command line does not come first"
refused() { echo "$1" >"$work/wrong.json"; expect 65 "$2" "$TREPHINE" render "$work/sample" --out "$work/x" --settings "$work/wrong.json"; }
refused '{"views": "left"}' 'views: is no parameter'
refused '{"view": "inside"}' 'view: '
refused '{"width": 1, "width": 300}' 'width: comes twice'
refused '{"width": "wide"}' 'width: '
refused '{"ct_low_hu": 900}' 'ct_high_hu'
expect 64 'ct_high_hu' "$TREPHINE" render "$work/sample" --out "$work/x" --ct-low-hu 900
refused '[1]' 'JSON object'
refused '{"view": ' 'no JSON'
expect 64 '[-]-opacity: hair=1: the case shows scalp, skull, brain' "$TREPHINE" render "$work/sample" --out "$work/x" --opacity hair=1
expect 64 '[-]-from-s: the recording lasts' "$TREPHINE" render "$work/sample" "$work/hole.servo" --out "$work/x" --from-s 100
expect 65 'is no recording' "$TREPHINE" render "$work/sample" "$work/sample/case.json" --out "$work/x"
MESA_GL_VERSION_OVERRIDE=3.3 expect 74 'OpenGL: .*4\.3' "$TREPHINE" render "$work/sample" --out "$work/x"
cp -r "$work/sample" "$work/damaged"
printf x >>"$work"/damaged/meshes/scalp-*.glb
expect 65 'scalp' "$TREPHINE" render "$work/damaged" --out "$work/x"
expect 74 'display: no window' "$TREPHINE" play "$work/sample"
