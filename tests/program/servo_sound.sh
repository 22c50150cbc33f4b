#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A drill is heard: as a WAV file of a recording, and live through a stub for ALSA's library.
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/sample" drill
way=(--device trajectory --trajectory "$work/way.txt" --tool ball --tool-diameter-mm 6 --drill --no-realtime --max-step-s 3600)
printf '0 1 -20 330 0 0 1 0\n0.2 1 -20 322 0 0 1 0\n0.3 1 -20 320 0 0 1 1\n1.0 1 -20 316 0 0 1 1\n1.2 1 -20 330 0 0 1 0\n' >"$work/way.txt"
"$TREPHINE" servo "$work/sample" "${way[@]}" --no-paced --seconds 1.5 --record "$work/way.servo" >"$work/text" || { cat "$work/text"; fail "servo"; }
for name in a b; do
  "$TREPHINE" replay "$work/sample" "$work/way.servo" --sound "$work/$name.wav" >"$work/text" || { cat "$work/text"; fail "replay"; }
  grep -q '^sound of 1.50 s at 48000 Hz$' "$work/text" || { cat "$work/text"; fail "its length is not told"; }
  grep -q '^replayed bit for bit$' "$work/text" || fail "with sound it is not compared"
done
cmp "$work/a.wav" "$work/b.wav" || fail "the same recording sounds different"
python3 - "$work/a.wav" <<'PY' || fail "what is heard"
import struct, sys, wave
w = wave.open(sys.argv[1])
assert (w.getnchannels(), w.getsampwidth(), w.getframerate(), w.getnframes()) == (1, 2, 48000, 72000), w.getparams()
s = struct.unpack("<72000h", w.readframes(72000))
loud = lambda a, b: (sum(x * x for x in s[int(48000 * a):int(48000 * b)]) / (48000 * (b - a))) ** 0.5
assert loud(0, 0.25) == 0, "it runs before the pedal"
assert loud(0.6, 0.9) > 500, loud(0.6, 0.9)
PY
# Live: the thread of the sound plays what the drill does, in blocks that the device takes as it can.
mkdir "$work/stubs"
ln -s "$ASOUND_STUB" "$work/stubs/libasound.so.2"
TREPHINE_ASOUND=$work/played LD_LIBRARY_PATH=$work/stubs \
  "$TREPHINE" servo "$work/sample" "${way[@]}" --seconds 1.5 --sound >"$work/text" || { cat "$work/text"; fail "servo --sound"; }
python3 - "$work/played" <<'PY' || fail "what is played"
import array, sys
s = array.array("f", open(sys.argv[1], "rb").read())
assert len(s) > 480 and max(map(abs, s)) <= 1, len(s)
assert any(s), "silent"
PY
code=0
LD_LIBRARY_PATH=$work/stubs "$TREPHINE" servo "$work/sample" "${way[@]}" --seconds 1 --sound 2>"$work/text" || code=$?
[[ $code == 66 ]] && grep -q 'no sound device default' "$work/text" || { cat "$work/text"; fail "no device: $code"; }
code=0
"$TREPHINE" servo "$work/sample" --device trajectory --trajectory "$work/way.txt" --no-paced --seconds 0.1 --record "$work/still.servo" >/dev/null
"$TREPHINE" replay "$work/sample" "$work/still.servo" --sound "$work/c.wav" >/dev/null 2>"$work/text" || code=$?
[[ $code == 64 ]] || { cat "$work/text"; fail "a sound of nothing: $code"; }
