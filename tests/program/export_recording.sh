#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A recording for other programs: CSV and JSON say the same as the recording itself, which the example reads; nothing is lost when
# frames are passed over.
. "$(dirname "$0")/common.sh"
: "${WRITE_CASE:?}"
"$WRITE_CASE" "$work/case" head_drilled
"$TREPHINE" servo "$work/case" --no-paced --seconds 1 --record "$work/one.servo" >/dev/null
out() { "$TREPHINE" export-recording "$work/one.servo" "$@" >"$work/said" || { cat "$work/said"; fail "export-recording $*"; }; }
out --csv "$work/one.csv" --json "$work/one.json" --plot "$work/one.svg"
grep -q '1000 frames, sealed' "$work/said" || { cat "$work/said"; fail "what it holds"; }
out --csv "$work/few.csv" --every-count 100 --plot "$work/one.png"
grep -q '<svg' "$work/one.svg" && head -c 8 "$work/one.png" | grep -q PNG || fail "no picture"
python3 - "$SOURCE" "$work" <<'PY'
import csv, sys
source, work = sys.argv[1:]
sys.path.insert(0, source + "/examples/python_reader")
import read_recording
assert len(open(read_recording.__file__).readlines()) <= 120
header, binary = read_recording.read(work + "/one.servo")
header_text, text = read_recording.read(work + "/one.json")
rows = list(csv.DictReader(open(work + "/one.csv")))
assert len(rows) == len(binary["tick"]) == len(text["tick"]) == 1000
assert header["case"] == header_text["case"] and header["rate_hz"] == header_text["rate_hz"]
for name in ("time_s", "tip_x_mm", "proxy_z_mm", "normal_y", "force_x_n", "touched", "inside", "buttons", "late_us"):
    assert binary[name] == text[name] == [float(r[name]) for r in rows], name  # to the last bit
assert binary["events"] == text["events"] == [r["events"] for r in rows] and any(binary["events"])
assert all(abs(a - b) < 1e-12 for a, b in zip(binary["force_n"], text["force_n"])) and max(text["force_n"]) > 0
few = list(csv.DictReader(open(work + "/few.csv")))
assert len(few) == 10 and float(few[0]["tick"]) == 99
seen = lambda rows: {e for r in rows for e in r["events"].split("+")} - {""}
assert seen(few) == seen(rows)
PY
reader=(python3 "$SOURCE/examples/python_reader/read_recording.py")
for file in one.json one.servo; do "${reader[@]}" "$work/$file" | grep -q '1000 frames at 1000 Hz' || fail "the example"; done
expect 64 'usage: ' "${reader[@]}"
expect 66 'none\.servo' "${reader[@]}" "$work/none.servo"
python3 - "$work" <<'PY'
import sys
work = sys.argv[1]
data = open(work + "/one.servo", "rb").read()
at = 16 + 8192 + 216 * 500 + 130
for name, spoilt in (("empty", b""), ("begun", data[:9]), ("short", data[:100]), ("cut", data[:-5]), ("foreign", bytes(range(256)) * 40),
                     ("other", b"{}"), ("old", data[:8] + b"\x14" + data[9:]), ("head", data[:16] + b"\xff" + data[17:]),
                     ("flipped", data[:at] + bytes([data[at] ^ 1]) + data[at + 1:])):
    open(f"{work}/{name}.servo", "wb").write(spoilt)
PY
for fault in 'empty: is no recording' 'begun: is cut short' 'short: header: is cut short' 'cut: frames: are cut short' \
  'foreign: is no recording' 'other: is no recording' 'old: version: 20, this program reads version 21' 'head: header: is damaged'; do
  expect 65 "${fault%%:*}\.servo:${fault#*:}" "${reader[@]}" "$work/${fault%%:*}.servo"
done
"$TREPHINE" export-recording "$work/flipped.servo" --json "$work/flipped.json" >/dev/null 2>&1 || fail "a broken seal"
expect 80 'flipped\.servo: seal_sha256: is not of these bytes' "${reader[@]}" "$work/flipped.servo"
expect 80 'flipped\.json: seal: was broken' "${reader[@]}" "$work/flipped.json"
expect 64 'one of them must be given' "$TREPHINE" export-recording "$work/one.servo"
expect 64 'must end in .svg or .png' "$TREPHINE" export-recording "$work/one.servo" --plot "$work/one.pdf"
expect 65 'is no recording' "$TREPHINE" export-recording "$work/one.csv" --json "$work/two.json"
[[ ! -e $work/two.json ]] || fail "half an output"
