#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Lessons with two hands: the row of the other hand, X-rays by its switch, a teacher's station that hears both, and who forges.
. "$(dirname "$0")/common.sh"
: "${OFFLINE:?}" "${WRITE_CASE:?}"
"$WRITE_CASE" "$work/head" head_drilled
# Down the burr hole in four seconds, in the last two with the switch down.
python3 - "$work" <<'PY'
import json, sys
hole = json.load(open(sys.argv[1] + "/head/case.json"))["burr_holes"][0]
out = [-a for a in hole["direction"]]
with open(sys.argv[1] + "/swept.txt", "w") as f:
    for n in range(0, 101):
        print(0.04 * n, *(a + o * (30 - 0.5 * n) for a, o in zip(hole["position_mm"], out)), *out, 1 if n > 50 else 0, file=f)
PY
# A lesson in which suction presses on the brain: its row, and the same by a replay; one hand has no such row.
"$OFFLINE" rubric "$SOURCE/configs/rubrics/ventriculostomy.yaml" --output "$work/rubric.json" >/dev/null
cat >"$work/script.json" <<'JSON'
{"module": "ventriculostomy", "steps": [{"take": {"tool": "catheter"}},
  {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish"]}
JSON
lesson=("$TREPHINE" lesson "$work/head" --script "$work/script.json" --participant r-01)
"${lesson[@]}" --record "$work/one.lesson" --second-trajectory "$work/swept.txt" >/dev/null
"$TREPHINE" score "$work/one.lesson" --case "$work/head" --rubric "$work/rubric.json" --json "$work/one.json" --page "$work/one.html" --language de >"$work/text"
"${lesson[@]}" --record "$work/alone.lesson" >/dev/null
"$TREPHINE" score "$work/alone.lesson" --case "$work/head" --rubric "$work/rubric.json" --json "$work/alone.json" >/dev/null
python3 - "$work" <<'PY' || fail "the other hand's row: $(cat "$work/text")"
import json, sys
one, alone = (json.load(open(f"{sys.argv[1]}/{n}.json")) for n in ("one", "alone"))
rows = {r["name"]: r for r in one["rows"]}
row = rows["second_hand"]
assert row["score"] == 3 and 0.5 < row["measured"]["second_force_n"] <= 1, row
assert one["facts"]["second_hand"]["tool"] == "suction" and one["facts"]["second_hand"]["suctions"] >= 1, one["facts"]["second_hand"]
assert "second_hand" not in {r["name"] for r in alone["rows"]} and "second_hand" not in alone["facts"]
for r in alone["rows"]:
    assert rows[r["name"]]["score"] == r["score"], r  # nothing else is judged otherwise
assert "Die andere Hand" in open(sys.argv[1] + "/one.html").read()
PY
# A tip that begins in the brain feels nothing until it was outside: it takes up nothing either. One that jumps is no hand's.
python3 - "$work" <<'PY'
import sys
lines = open(sys.argv[1] + "/swept.txt").read().splitlines()
pose = lines[-1].split()[1:7]
open(sys.argv[1] + "/inside.txt", "w").write("".join(" ".join([str(t), *pose, "1"]) + "\n" for t in (0, 5)))
first = lines[0].split()[1:7]
beside = [str(float(first[0]) + 80), *first[1:]]
open(sys.argv[1] + "/jumps.txt", "w").write("".join(" ".join([str(t), *p, "0"]) + "\n" for t, p in ((0, first), (0.5, first), (0.502, beside), (5, beside))))
PY
"${lesson[@]}" --record "$work/inside.lesson" --second-trajectory "$work/inside.txt" >/dev/null
"$TREPHINE" score "$work/inside.lesson" --case "$work/head" --rubric "$work/rubric.json" --json "$work/inside.json" >/dev/null
python3 - "$work/inside.json" <<'PY' || fail "suction that feels nothing"
import json, sys
second = json.load(open(sys.argv[1]))["facts"]["second_hand"]
assert second["suctions"] == 0 and second["most_force_n"] == 0 and second["switch_s"] > 1, second
PY
"${lesson[@]}" --record "$work/jumps.lesson" --second-trajectory "$work/jumps.txt" >/dev/null
expect 65 'second hand: tick [0-9]+, .*the device jumped' "$TREPHINE" score "$work/jumps.lesson" --case "$work/head" --rubric "$work/rubric.json"
# Who presses less in the recording than the hand did, and seals it anew, is found by the replay.
python3 - "$work" <<'PY'
import hashlib, json, re, sys
data = bytearray(open(sys.argv[1] + "/one.lesson", "rb").read())
head = 16 + 8192
at = next(n for n in range(head + 216, len(data), 432) if any(data[n + 120:n + 144]))  # the second hand's first force
data[at + 120:at + 144] = bytes(24)
seal = re.search(rb'"seal_sha256": *"([0-9a-f]{64})"', data[:head])
data[seal.start(1):seal.end(1)] = b"0" * 64
data[seal.start(1):seal.end(1)] = hashlib.sha256(bytes(data[head:]) + bytes(data[:head])).hexdigest().encode()
open(sys.argv[1] + "/forged.lesson", "wb").write(data)
PY
expect 80 'does not replay bit for bit' "$TREPHINE" score "$work/forged.lesson" --case "$work/head" --rubric "$work/rubric.json"
expect 80 '1 of [0-9]+ differ when replayed' "$TREPHINE" replay "$work/head" "$work/forged.lesson"
# A teacher's station hears both hands, each at a port, and signs its own recording of both.
openssl genpkey -algorithm ed25519 -out "$work/key" 2>/dev/null
openssl pkey -in "$work/key" -pubout -out "$work/public" 2>/dev/null
server=("$TREPHINE" record-server "$work/head" --rubric "$work/rubric.json" --participant r-01 --key "$work/key" --no-questions --no-realtime
  --max-step-s 3600)
expect 64 'second-tool: needs --second-port' "${server[@]}" --record "$work/x.lesson" --second-tool suction
"${server[@]}" --record "$work/signed.lesson" --second-port 0 >"$work/text" 2>"$work/stderr" &
server_pid=$!
timeout 300 python3 - "$SOURCE" "$work" <<'PY' || fail "the two hands of a window: $(cat "$work/text" "$work/stderr")"
import hashlib, json, re, sys, time
source, work = sys.argv[1:]
sys.path.insert(0, source + "/examples/udp_client")
import udp_client
head = json.loads(open(work + "/one.lesson", "rb").read()[16:8208])
rubric = json.load(open(work + "/rubric.json"))["sha256"]
number = hashlib.sha256("\n".join([head["case_sha256"], rubric, "ventriculostomy", "r-01", head["lesson"]["task"], "second suction"]).encode())
links, taken, end = [], 0, time.monotonic() + 200
while time.monotonic() < end:
    ports = re.findall(r"^waiting for a device on 127\.0\.0\.1:(\d+)$", open(work + "/text").read(), re.M)
    while len(links) < len(ports):
        links.append(udp_client.Link("127.0.0.1", int(ports[len(links)])))
        links[-1].session = int(number.hexdigest()[:8], 16) | 1
    for link in links:
        link.sequence += 1
        pedals = 1 if link is links[-1] and taken > 100 else 0
        command = 3 if link is links[0] and taken > 300 else 0  # finish
        try:
            link.socket.send(udp_client.POSE.pack(b"TRPP", 2, 0, link.session, 0, link.sequence, time.monotonic(), 0, 0, 400, 0, 0, 0, 1,
                                                  pedals, 0, command))
        except OSError:
            pass  # the server has ended
        link.take()
    taken = links[0].answers if links else 0
    if taken > 300 and time.monotonic() - links[0].heard > 0.5:
        break  # the server has what it needs
    time.sleep(0.002)
assert taken > 300 and links[1].answers > 200, (taken, [l.answers for l in links])
PY
wait $server_pid || { cat "$work/text" "$work/stderr"; fail "the server"; }
"$TREPHINE" score "$work/signed.lesson" --case "$work/head" --rubric "$work/rubric.json" --signed-by "$work/public" --json "$work/signed.json" >/dev/null
python3 - "$work/signed.json" <<'PY' || fail "the signed lesson"
import json, sys
j = json.load(open(sys.argv[1]))
assert j["signature"] == "signed" and j["facts"]["second_hand"]["tool"] == "suction" and j["facts"]["second_hand"]["switch_s"] > 0.1, j
PY
# X-rays by the other hand's switch, as the pedal takes them.
"$WRITE_CASE" "$work/spine" spine
"$OFFLINE" rubric "$SOURCE/configs/rubrics/spine_needle.yaml" --output "$work/spine.json" >/dev/null
printf '0 0 0 900 0 0 1 0\n0.2 0 0 900 0 0 1 1\n0.5 0 0 900 0 0 1 0\n0.7 0 0 900 0 0 1 1\n0.8 0 0 900 0 0 1 0\n' >"$work/switch.txt"
echo '{"module": "spine_needle", "steps": [{"wait": {"seconds": 1.5}}, "finish"]}' >"$work/wait.json"
spine=("$TREPHINE" lesson "$work/spine" --script "$work/wait.json" --second-trajectory "$work/switch.txt" --record "$work/xray.lesson")
"${spine[@]}" >/dev/null
"$TREPHINE" score "$work/xray.lesson" --case "$work/spine" --rubric "$work/spine.json" --json "$work/xray.json" >/dev/null
python3 - "$work/xray.json" <<'PY' || fail "X-rays by the other hand"
import json, sys
shots = json.load(open(sys.argv[1]))["facts"]["shots"]
assert len(shots) == 2 and abs(sum(s["end_s"] - s["begin_s"] for s in shots) - 0.4) < 0.01, shots
PY
expect 64 'second-tool: the lesson spine_needle has no use for suction in the other hand' "${spine[@]}" --second-tool suction
echo '{"module": "subclavian", "steps": ["finish"]}' >"$work/wait.json"
expect 64 'second-device: the lesson subclavian has no use for a second hand' "${spine[@]}"
