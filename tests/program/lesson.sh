#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A lesson as its user does it: the shipped rubric, a script, the recording, its score twice, and what is refused.
. "$(dirname "$0")/common.sh"
: "${OFFLINE:?}" "${WRITE_CASE:?}"
"$WRITE_CASE" "$work/head" head_drilled
"$OFFLINE" rubric "$SOURCE/configs/rubrics/ventriculostomy.yaml" --output "$work/rubric.json" >/dev/null
cat >"$work/script.json" <<'JSON'
{"module": "ventriculostomy", "steps": [{"take": {"tool": "catheter"}},
  {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish"]}
JSON
lesson=("$TREPHINE" lesson "$work/head" --script "$work/script.json")
"${lesson[@]}" --record "$work/one.lesson" --participant r-01 >"$work/text" || { cat "$work/text"; fail "no lesson"; }
score=("$TREPHINE" score "$work/one.lesson" --case "$work/head" --rubric "$work/rubric.json")
"${score[@]}" --json "$work/one.json" >"$work/text" || { cat "$work/text"; fail "no score"; }
grep -q '^25 of 25 points (20 of 20 by the table), completed; finished, catheter passes: 1, success at the first pass$' "$work/text" || { cat "$work/text"; fail "other points"; }
grep -Eq '^Burr hole placement +not judged  the hole was there beforehand$' "$work/text" || fail "the case's own hole is judged"
"${score[@]}" --json "$work/two.json" >/dev/null
cmp "$work/one.json" "$work/two.json" || fail "scored again it is not the same"
# The page has neither script nor foreign address; the log holds a recording once, and counts attempts.
"${score[@]}" --page "$work/one.html" --log "$work/log.csv" >/dev/null
"${score[@]}" --page "$work/two.html" --log "$work/log.csv" >/dev/null
cmp "$work/one.html" "$work/two.html" || fail "another page"
! grep -Eqi '<script|javascript:|https?://' "$work/one.html" || fail "the page does more than show"
grep -q "default-src 'none'" "$work/one.html" || fail "the page has no policy"
[[ $(wc -l <"$work/log.csv") == 2 ]] || fail "the log holds it twice"
"${lesson[@]}" --record "$work/other.lesson" --participant r-01 --aim-noise-mm 2 --seed 5 >/dev/null
"$TREPHINE" score "$work/other.lesson" --case "$work/head" --rubric "$work/rubric.json" --log "$work/log.csv" >/dev/null
python3 - "$work/log.csv" <<'PY'
import csv, sys
rows = list(csv.DictReader(open(sys.argv[1])))
assert [(r["participant"], r["attempt"], r["case"]) for r in rows] == [("r-01", "1", "head-drilled"), ("r-01", "2", "head-drilled")], rows
assert rows[0]["points"] == "25" and rows[0]["landmarks_score"] == "" and rows[0]["tip_score"] == "5", rows[0]
assert rows[0]["first_pass"] == "1" and rows[0]["kakarla_grade"] == "1" and abs(float(rows[0]["depth_mm"]) - 55.7) < 2, rows[0]
PY
echo 'name,score' >"$work/foreign.csv"
expect 65 'foreign.csv: columns: are not those' "${score[@]}" --log "$work/foreign.csv"
"${lesson[@]}" --record "$work/two.lesson" --participant r-01 >/dev/null
cmp "$work/one.lesson" "$work/two.lesson" || fail "done again it is not the same"
"$TREPHINE" replay "$work/head" "$work/one.lesson" | grep -q '^replayed bit for bit$' || fail "replays otherwise"

# A recording that was forged is refused as `replay` refuses it, and scored only on trust, which the report says. What the hand did
# names the attempt: an edited header makes no new one, and another participant's token is found.
cat >"$work/forge.py" <<'PY'
import hashlib, re, struct, sys
way, source, target, seal = sys.argv[1:]
b = bytearray(open(source, "rb").read())
length = struct.unpack_from("<I", b, 12)[0]
each = int(b[16:16 + length].decode().split('"frame_bytes":')[1].split(",")[0].split("}")[0])
def header(old, new):
    text = bytes(b[16:16 + length]).decode()
    assert old in text, old
    b[16:16 + length] = text.replace(old, new).rstrip().ljust(length - 1).encode() + b"\n"
frames = range(16 + length, len(b), each)
for f in frames:
    if way == "forces": struct.pack_into("<3d", b, f + 120, 0, 0, 0)
    if way == "proxies": struct.pack_into("<3d", b, f + 72, *struct.unpack_from("<3d", b, f + 24))
    if way == "times": struct.pack_into("<d", b, f + 8, struct.unpack_from("<d", b, f + 8)[0] / 10)
    if way == "steps": struct.pack_into("<2d", b, f + 8, *(v / 10 for v in struct.unpack_from("<2d", b, f + 8)))
if way == "rate":
    text = bytes(b[16:16 + length]).decode()
    rate = text.split('"rate_hz":')[1].split(",")[0]
    header('"rate_hz":' + rate, '"rate_hz": 1e300')
if way == "device": header('"script"', '"scrapt"')
if way == "token": header('"r-01"', '"r-02"')
if way == "erased":
    header(re.search(r',\s*"seal_sha256":\s*"[0-9a-f]{64}"', bytes(b[16:16 + length]).decode())[0], "")
if way == "xray":
    for f in frames: struct.pack_into("<I", b, f + 144, struct.unpack_from("<I", b, f + 144)[0] & ~(1 << 20))
    struct.pack_into("<I", b, frames[0] + 144, struct.unpack_from("<I", b, frames[0] + 144)[0] ^ (1 << 20))
if way == "shrunk":
    for f in frames: struct.pack_into("<2d", b, f + 8, *(v / 40 for v in struct.unpack_from("<2d", b, f + 8)))
if way == "spliced":
    for f in frames[len(frames) // 2:]: struct.pack_into("<3d", b, f + 24, *struct.unpack_from("<3d", b, f - each + 24))
if seal == "seal":  # as anybody can: a seal finds accidents and careless changes
    said = re.search(rb'"seal_sha256":\s*"([0-9a-f]{64})"', b)[1]
    zeroed = bytes(b[:16 + length]).replace(said, b"0" * 64)
    is_now = hashlib.sha256(bytes(b[16 + length:]) + zeroed).hexdigest().encode()
    b[:16 + length] = bytes(b[:16 + length]).replace(said, is_now)
open(target, "wb").write(b)
PY
for way in forces proxies times steps rate; do
  python3 "$work/forge.py" $way "$work/one.lesson" "$work/$way.lesson" seal
  forged=("$TREPHINE" score "$work/$way.lesson" --case "$work/head" --rubric "$work/rubric.json")
  expect 80 "$way.lesson: (frames|rate_hz): " "${forged[@]}" --json "$work/forged.json" --log "$work/forged.csv"
  [[ ! -e $work/forged.json && ! -e $work/forged.csv ]] || fail "$way: something was written"
done
python3 "$work/forge.py" forces "$work/one.lesson" "$work/forces.lesson" seal
"$TREPHINE" score "$work/forces.lesson" --case "$work/head" --rubric "$work/rubric.json" --trust-recording --json "$work/forged.json" \
  --page "$work/forged.html" --log "$work/forged.csv" >"$work/text"
grep -q '"checked": "trusted"' "$work/forged.json" || fail "the report does not say that it was trusted"
grep -q 'Trusted: the recording was not replayed' "$work/forged.html" || fail "the page does not say it"
grep -q ',trusted,' "$work/forged.csv" || fail "the log does not say it"
grep -q '^TRUSTED' "$work/text" || fail "the command does not say it"
grep -q '"checked": "replayed"' "$work/one.json" || fail "the report does not say that it was replayed"
for way in device token; do
  python3 "$work/forge.py" $way "$work/one.lesson" "$work/$way.lesson" seal
  "$TREPHINE" score "$work/$way.lesson" --case "$work/head" --rubric "$work/rubric.json" --log "$work/log.csv" >"$work/text"
  grep -q '^the motion is that of r-01, attempt 1$' "$work/text" || { cat "$work/text"; fail "$way: the motion is not recognised"; }
done
python3 - "$work/log.csv" <<'PY'
import csv, sys
rows = list(csv.DictReader(open(sys.argv[1])))
assert [(r["participant"], r["attempt"], r["repeats"], r["checked"]) for r in rows] == [
    ("r-01", "1", "", "replayed"), ("r-01", "2", "", "replayed"), ("r-02", "1", "r-01 1", "replayed")], rows
assert rows[0]["motion_sha256"] == rows[2]["motion_sha256"] != rows[1]["motion_sha256"], rows
PY

# Bytes that were changed after the recording are found by its seal, in `score` and `replay`; one whose seal was taken off is told.
grep -q '"seal": "sealed"' "$work/one.json" || fail "the report does not say that it was sealed"
for way in xray shrunk proxies times spliced rate device token; do
  python3 "$work/forge.py" $way "$work/one.lesson" "$work/$way.lesson" keep
  expect 80 "$way.lesson: seal_sha256: is not of these bytes" "$TREPHINE" score "$work/$way.lesson" --case "$work/head" --rubric "$work/rubric.json"
  expect 80 "$way.lesson: seal_sha256: is not of these bytes" "$TREPHINE" replay "$work/head" "$work/$way.lesson"
done
python3 "$work/forge.py" erased "$work/one.lesson" "$work/erased.lesson" keep
"$TREPHINE" score "$work/erased.lesson" --case "$work/head" --rubric "$work/rubric.json" --log "$work/erased.csv" >"$work/text"
grep -q '^NOT SEALED' "$work/text" && grep -q ',not sealed,$' "$work/erased.csv" || fail "a seal that is missing is not told"
"$TREPHINE" replay "$work/head" "$work/erased.lesson" | grep -q '^not sealed' || fail "a replay does not tell it"
"$TREPHINE" score "$work/token.lesson" --case "$work/head" --rubric "$work/rubric.json" --trust-recording | grep -q '^BROKEN SEAL' || fail "trusted, a broken seal is not told"

# The limits that are the dissertation's say so, with its table; the others are ours, and say why.
python3 - "$work/one.json" <<'PY'
import json, sys
j = json.load(open(sys.argv[1]))
assert j["participant"] == "r-01" and [r["name"] for r in j["rows"]] == ["landmarks", "burr_hole", "trajectory", "depth", "tip", "time", "passes"]
limits = {(r["name"], k): l for r in j["rows"] for k, l in r["limits"].items()}
thesis = {k: l["limit"] for k, l in limits.items() if l["from"] == "thesis"}
assert thesis == {("depth", "least_mm"): 30, ("depth", "low_mm"): 40, ("depth", "ideal_low_mm"): 50, ("depth", "ideal_high_mm"): 60,
                  ("depth", "high_mm"): 70, ("depth", "most_mm"): 90, ("tip", "foramen_mm"): 5, ("time", "ideal_s"): 300,
                  ("time", "acceptable_s"): 600}, thesis
assert all("Table XIII" in limits[k]["why"] for k in thesis) and all(l["why"] for l in limits.values())
assert all(r["decided_s"] is not None for r in j["rows"] if r["score"] != "not judged")
PY

sed 's/"limit": 300.0/"limit": 310.0/' "$work/rubric.json" >"$work/changed.json"
cmp -s "$work/rubric.json" "$work/changed.json" && fail "nothing was changed"
expect 65 'changed.json: sha256: the rubric was changed' "$TREPHINE" score "$work/one.lesson" --case "$work/head" --rubric "$work/changed.json"
expect 64 '[-]-participant: must be' "${lesson[@]}" --record "$work/x" --participant "Jane Doe"
"$TREPHINE" servo "$work/head" --no-paced --seconds 0.1 --record "$work/plain.servo" >/dev/null
expect 65 'plain.servo: lesson: is missing' "$TREPHINE" score "$work/plain.servo" --case "$work/head" --rubric "$work/rubric.json"
echo '{"module": "ventriculostomy", "steps": ["fly"]}' >"$work/script.json"
expect 65 'script.json: steps\[0\]: fly, no such step' "${lesson[@]}" --record "$work/x"
sed 's/limit: 300/limit: 3000/' "$SOURCE/configs/rubrics/ventriculostomy.yaml" >"$work/wrong.yaml"
expect 78 'wrong.yaml:[0-9]+:[0-9]+: time.good_s.limit: is below ideal_s' "$OFFLINE" rubric "$work/wrong.yaml" --output "$work/x"
sed 's/, why: interpolated//' "$SOURCE/configs/rubrics/ventriculostomy.yaml" >"$work/wrong.yaml"
expect 78 'tip.near_mm.why: is missing' "$OFFLINE" rubric "$work/wrong.yaml" --output "$work/x"
[[ ! -e $work/x ]] || fail "something was written"
