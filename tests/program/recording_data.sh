#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A recording as data (--hdf5): what is in it, against the case; from a camera of one's own; the same bytes again; what is refused.
. "$(dirname "$0")/common.sh"
export LP_NUM_THREADS=1
unset DISPLAY WAYLAND_DISPLAY
/usr/bin/python3 -c 'import h5py' 2>/dev/null || skip "no python3-h5py"
"$WRITE_CASE" "$work/sample" play
"$TREPHINE" servo "$work/sample" --no-paced --tool ball --drill --incision-radius-mm 15 --approach-mm 7 --hole-diameter-mm 8 \
  --seconds 8 --record "$work/hole.servo" >/dev/null
small=(--width 320 --height 240 --frames-per-s 0.5)
data() { "$TREPHINE" render "$work/sample" "$work/hole.servo" "${small[@]}" "$@" >"$work/text" 2>&1; }
if ! data --hdf5 "$work/hole.hdf5"; then
  cat "$work/text"
  grep -q OpenGL "$work/text" && skip "no OpenGL without a display"
  fail "writes nothing"
fi
grep -Eq '^4 frames of 320 x 240, [0-9]+ voxels removed, [0-9.]+ MB' "$work/text" || { cat "$work/text"; fail "does not say what it wrote"; }
"$TREPHINE" replay "$work/sample" "$work/hole.servo" | grep -q 'replayed bit for bit' || fail "the recording does not replay"

# Beside the tool in the open, near enough that its ball is large.
eye=-160,-19.92,343.02
data --hdf5 "$work/tool.hdf5" --to-s 0.01 --eye-mm="$eye" --target-mm=1.08,-19.92,345.52 --up=0,0,1 --field-of-view-deg 5 --opacity scalp=0,skull=0,brain=0 \
  --baseline-mm 4 || { cat "$work/text"; fail "a camera of one's own"; }
/usr/bin/python3 "$SOURCE/tests/program/recording_data.py" "$SOURCE" "$work/sample" "$work/hole.hdf5" "$work/tool.hdf5" "[$eye]" ||
  fail "the data"
(($(wc -l <"$SOURCE/examples/recording_data/frames.py") < 60)) || fail "the example is long"
/usr/bin/python3 "$SOURCE/examples/recording_data/frames.py" "$work/hole.hdf5" >"$work/said" || fail "the example"
grep -q 'tip at pixel' "$work/said" && grep -q 'voxels removed' "$work/said" || { cat "$work/said"; fail "the example says nothing"; }

sleep 1.1  # a date in the file would be another one
data --hdf5 "$work/again.hdf5"
cmp "$work/hole.hdf5" "$work/again.hdf5" || fail "other bytes"
data --hdf5 "$work/both.hdf5" --out "$work/pictures"
cmp "$work/hole.hdf5" "$work/both.hdf5" && [[ $(ls "$work/pictures" | wc -l) == 4 ]] || fail "data and pictures at once"

refused() { expect 64 "$1" "$TREPHINE" render "$work/sample" "${@:2}" --hdf5 "$work/no.hdf5"; [[ ! -e $work/no.hdf5 ]] || fail "half an output"; }
refused '[-]-hdf5: is of a recording'
refused '[-]-cut: ' "$work/hole.servo" --cut axial
refused '[-]-stereo: ' "$work/hole.servo" --stereo side_by_side
refused 'up: ' "$work/hole.servo" --eye-mm=0,0,500 --target-mm=0,0,0
expect 64 '[-]-out, --hdf5: one of them' "$TREPHINE" render "$work/sample"
expect 73 'no/x.hdf5' "$TREPHINE" render "$work/sample" "$work/hole.servo" --hdf5 "$work/no/x.hdf5"
cp "$work/hole.servo" "$work/changed.servo"
printf '\x01' | dd of="$work/changed.servo" bs=1 seek=$((8208 + 216 * 100 + 120)) conv=notrunc status=none
expect 80 'seal' "$TREPHINE" render "$work/sample" "$work/changed.servo" --hdf5 "$work/no.hdf5"
# A force that is not the recorded one is found, also where nothing is cut, and where the file is sealed again.
cat >"$work/reseal.py" <<'PY'
import hashlib, re, struct, sys
data = bytearray(open(sys.argv[1], "rb").read())
size = int(re.search(rb'"frame_bytes": *(\d+)', data[16:8208]).group(1))
at = 8208 + size * 500 + 120
data[at:at + 8] = struct.pack("<d", struct.unpack("<d", data[at:at + 8])[0] + 1e-9)
place = re.search(rb'"seal_sha256": *"([0-9a-f]{64})"', data[:8208]).start(1)
data[place:place + 64] = b"0" * 64
data[place:place + 64] = hashlib.sha256(data[8208:] + data[:8208]).hexdigest().encode()
open(sys.argv[2], "wb").write(data)
PY
"$TREPHINE" servo "$work/sample" --no-paced --seconds 2 --record "$work/touch.servo" >/dev/null
"$TREPHINE" render "$work/sample" "$work/touch.servo" "${small[@]}" --hdf5 "$work/touch.hdf5" >/dev/null || fail "a recording without a drill"
for one in hole touch; do
  python3 "$work/reseal.py" "$work/$one.servo" "$work/other.servo"
  expect 80 'frames: 1 of .* differ when replayed' "$TREPHINE" render "$work/sample" "$work/other.servo" "${small[@]}" --hdf5 "$work/no.hdf5"
  [[ ! -e $work/no.hdf5 ]] || fail "half an output"
done
code=0; (ulimit -f 400; data --hdf5 "$work/no.hdf5") || code=$?  # as a full disk
[[ $code == 74 && ! -e $work/no.hdf5 ]] && grep -q 'HDF5 could not write' "$work/text" || { cat "$work/text"; fail "a full disk: $code"; }
interrupted "$TREPHINE" render "$work/sample" "$work/hole.servo" --width 640 --height 480 --frames-per-s 30 --hdf5 "$work/no.hdf5"
[[ $code == 130 && ! -e $work/no.hdf5 ]] || fail "interrupted: $code"
! ls -A "$work" | grep -q trephine-tmp || fail "a temporary file is left"
