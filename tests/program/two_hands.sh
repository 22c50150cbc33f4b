#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Two hands: both are felt, recorded and replayed, the first as it is without the second; what is spoilt or makes no sense is
# refused in one line.
. "$(dirname "$0")/common.sh"
: "${WRITE_CASE:?}"
"$WRITE_CASE" "$work/head" head_drilled
servo=("$TREPHINE" servo "$work/head" --no-paced --max-step-s 3600 --seconds 1 --device trajectory --trajectory "$work/first.txt")
second=(--second-device trajectory --second-trajectory "$work/second.txt" --second-tool suction)
# Down the burr hole, and beside it onto the head.
python3 - "$work" <<'PY'
import json, sys
work = sys.argv[1]
hole = json.load(open(work + "/head/case.json"))["burr_holes"][0]
at, out = hole["position_mm"], [-a for a in hole["direction"]]
def path(name, aside, deepest, switch=0):
    with open(f"{work}/{name}.txt", "w") as f:
        for n in range(0, 101):
            far = 30 + (deepest - 30) * n / 100
            p = [a + o * far for a, o in zip(at, out)]
            p[1] += aside
            print(round(n / 100, 4), *p, *out, switch if n > 50 else 0, file=f)
path("first", 30, -4)
path("second", 0, -20, 1)
PY
"${servo[@]}" --record "$work/one.servo" >/dev/null
"${servo[@]}" "${second[@]}" --record "$work/both.servo" --json "$work/both.json" >"$work/text"
grep -q '^second hand: suction on trajectory$' "$work/text" || { cat "$work/text"; fail "does not say what the second hand holds"; }
[[ $(stat -c %s "$work/both.servo") == $((16 + 8192 + 1000 * 2 * 216)) ]] || fail "a recording of another size"
"$TREPHINE" replay "$work/head" "$work/both.servo" | grep -q '^replayed bit for bit$' || fail "not the same"
"$TREPHINE" export-recording "$work/both.servo" --csv "$work/both.csv" --json "$work/text.json" >/dev/null
python3 - "$SOURCE" "$work" <<'PY' || fail "the recording of both"
import csv, json, sys
source, work = sys.argv[1:]
sys.path.insert(0, source + "/examples/python_reader")
import read_recording
head = 16 + 8192
one, both = (open(f"{work}/{name}.servo", "rb").read()[head:] for name in ("one", "both"))
frames = [both[n:n + 216] for n in range(0, len(both), 216)]
assert b"".join(f[:172] for f in frames[::2]) == b"".join(one[n:n + 172] for n in range(0, len(one), 216)), "the first hand feels another force"
header, columns = read_recording.read(work + "/both.servo")
assert header["second"]["tool"]["name"] == "suction" and header["second"]["device"] == "trajectory", header["second"]
most = max(columns["second_force_n"])
said = json.load(open(work + "/both.json"))["second"]
assert most == said["most_force_n"] and most > 0.1 and max(columns["force_n"]) > 0.1, (most, said)
text = read_recording.read(work + "/text.json")[1]
rows = list(csv.DictReader(open(work + "/both.csv")))
for name in ("second_tip_x_mm", "second_proxy_z_mm", "second_touched", "second_buttons"):
    assert columns[name] == text[name] == [float(r[name]) for r in rows], name
PY
# A changed force of the second hand breaks the seal.
cp "$work/both.servo" "$work/forged.servo"
printf '\1' | dd of="$work/forged.servo" bs=1 seek=$((16 + 8192 + 216 * 1999 + 120)) conv=notrunc 2>/dev/null
expect 80 'seal_sha256: is not of these bytes' "$TREPHINE" replay "$work/head" "$work/forged.servo"

expect 64 'second-tool: burr: the second hand neither cuts nor draws; hold it with --tool' "${servo[@]}" "${second[@]:0:4}" --second-tool burr
expect 64 '--second-tool: needs --second-device' "${servo[@]}" --second-tool suction
expect 64 '--second-trajectory: is needed with --second-device trajectory' "${servo[@]}" --second-device trajectory
expect 64 'second-device: hand: must be' "${servo[@]}" --second-device hand
expect 64 'both are UDP port 20517, which one hand alone can hold' "$TREPHINE" servo "$work/head" --device udp --second-device udp
expect 64 'both are the 3D mouse' "$TREPHINE" servo "$work/head" --device spacemouse --second-device spacemouse
expect 64 'second-device-delay-ms: 2, and the device.s damping is not known: .*--second-device-own-damping' "${servo[@]}" "${second[@]}" --second-device-delay-ms 2
printf '0 0 0 nan\n' >"$work/nan.txt"
expect 65 'nan.txt' "${servo[@]}" --second-device trajectory --second-trajectory "$work/nan.txt"

# Two clients by UDP, of which the second is unplugged: its fault is named, and the first hand feels and goes on to the end.
"$TREPHINE" servo "$work/head" --no-realtime --max-step-s 3600 --seconds 4 --device udp --port 0 --timeout-ms 9000 --second-device udp \
  --second-port 0 --second-max-step-s 3600 --second-timeout-ms 50 --second-resume-s 0.1 --json "$work/lost.json" --record "$work/lost.servo" >"$work/text" 2>"$work/stderr" &
servo_pid=$!
timeout 300 python3 - "$SOURCE" "$work" <<'PY' || fail "the two clients: $(cat "$work/text" "$work/stderr")"
import re, sys, time
source, work = sys.argv[1:]
sys.path.insert(0, source + "/examples/udp_client")
import udp_client
ways = {n: [list(map(float, line.split())) for line in open(f"{work}/{n}.txt")] for n in ("first", "second")}
ports, links, at = [], [], 0.0
begin = time.monotonic()
while time.monotonic() < begin + 200:
    ports = re.findall(r"^waiting for a device on 127\.0\.0\.1:(\d+)$", open(work + "/text").read(), re.M)
    while len(links) < len(ports):
        links.append(udp_client.Link("127.0.0.1", int(ports[len(links)])))
        links[-1].session += len(links)
    served = len(links) == 2 and all(link.answers > 0 for link in links)
    at = min(100, at + 0.1) if served else 0
    for n, link in enumerate(links):
        if n == 1 and at >= 60:
            continue  # it is unplugged
        p = ways[("first", "second")[n]][int(at)]
        link.pose(p[1:4], udp_client.turn_to([-a for a in p[4:7]]))
        while link.take() is not None:
            pass
    if at >= 100:
        break
    time.sleep(0.002)
assert at >= 100, (at, ports)
sent = time.monotonic() + 100
while "ticks, " not in open(work + "/text").read() and time.monotonic() < sent:  # the first goes on to the end
    links[0].pose(ways["first"][100][1:4], udp_client.turn_to([-a for a in ways["first"][100][4:7]]))
    links[0].take()
    time.sleep(0.002)
PY
code=0
wait $servo_pid || code=$?
[[ $code == 74 ]] && grep -q '^second device: device lost' <(sed 's/^[^:]*: //' "$work/stderr") || { cat "$work/text" "$work/stderr"; fail "exit code $code"; }
grep -q '^second hand: fault after .*: device lost.*; the force stays zero$' "$work/text" || { cat "$work/text"; fail "the lost hand is not named"; }
python3 - "$work/lost.json" <<'PY' || fail "a lost second device"
import json, sys
said = json.load(open(sys.argv[1]))
assert said["faults"] & ~48 == 0 and said["most_force_n"] > 0.05 and said["touching_ratio"] > 0, said
assert "device lost" in said["second"]["fault_names"] and said["second"]["device_counts"]["poses"] > 100, said["second"]
PY
"$TREPHINE" replay "$work/head" "$work/lost.servo" | grep -q '^replayed bit for bit$' || fail "the lost one does not replay"
