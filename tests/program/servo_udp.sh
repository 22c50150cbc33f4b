#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# trephine-sim servo --device udp with the reference client: both ends of a closed loop on a case, the forces that the client
# got are those that were recorded, torque and events come back, its pedal drills, a client that is killed, and a second one.
. "$(dirname "$0")/common.sh"
"${CC:-cc}" -std=c99 -pedantic -Wall -Wextra -Werror -O1 -o "$work/client" "$SOURCE/examples/udp_client/udp_client.c" -lm
[[ $(wc -l <"$SOURCE/examples/udp_client/udp_client.c") -lt 210 ]] || fail "210 lines or more"
"$WRITE_CASE" "$work/sample"

begin() {  # FLAGS...: a servo in the background; port is where it listens
  rm -f "$work/text"
  "$TREPHINE" servo "$case" --device udp --port 0 --no-realtime --max-step-s 3600 "$@" >"$work/text" 2>"$work/stderr" &
  servo=$!
  for _ in $(seq 15000); do
    port=$(sed -n 's/^waiting for a device on 127\.0\.0\.1:\([0-9]*\)$/\1/p' "$work/text" 2>/dev/null || true)
    [[ -z $port ]] || return 0
    kill -0 $servo 2>/dev/null || fail "the servo ended: $(cat "$work/stderr")"
    sleep 0.02
  done
  fail "no port"
}
# Down on the sample's outer surface, 1.3 mm below the start; on top of the bone of the case to drill.
client() ( exec "$work/client" 127.0.0.1 "$port" "$1" 1 -20 384 0 0 -1 3 "${@:2}" )
on_bone() ( exec "$work/client" 127.0.0.1 "$port" "$1" 1 -20 317 0 0 -1 "${@:2}" )
"$WRITE_CASE" "$work/drill" drill

case=$work/drill

# The client in C, and that in Python.
for language in c python; do
begin --timeout-ms 10000 --seconds 2 --tool ball --tool-diameter-mm 2 --record "$work/a.servo" --json "$work/a.json"
on_bone 5 5 "$work/log" >"$work/client_text" || fail "the client in $language: $(cat "$work/client_text")"
wait $servo || fail "the servo: $(cat "$work/stderr")"
grep -Eq '^udp: [0-9]+ poses, [0-9]+ answers, 0 malformed, 0 late, 0 strangers, [0-9]+ gaps$' "$work/text" || { cat "$work/text"; fail "counts"; }
python3 - "$work/a.json" "$work/a.servo" "$work/log" <<'PY'
import json, math, struct, sys
said = json.load(open(sys.argv[1]))
assert said["device"] == "udp" and said["faults"] == 0, said
assert said["touching_ratio"] > 0.1 and said["most_force_n"] > 0.1, said
data = open(sys.argv[2], "rb").read()
ticks = {}
assert b'"frame_bytes":240' in data[:8192].replace(b" ", b""), "the client said how the tool is turned"
for f in struct.iter_unpack("<Q17dI4i3I40x3d", data[16 + 8192:]):
    ticks.setdefault(f[3:6], set()).add(f[15:18])
    assert abs(math.hypot(*f[26:29]) - 1) < 1e-6, f
answers = [[float.fromhex(v) if "x" in v else int(v) for v in line.split()] for line in open(sys.argv[3])]
assert len(answers) == said["device_counts"]["answers"] > 50, (len(answers), said["device_counts"])
sequences = [a[0] for a in answers]
assert sequences == sorted(set(sequences))
assert all(tuple(a[4:7]) in ticks[tuple(a[1:4])] for a in answers), "a force that was not recorded"
assert max(a[6] for a in answers) > 0.3, "the client felt nothing"
assert any(a[7:10] != [0, 0, 0] for a in answers), "no torque came back"
assert any(a[10] & 1 for a in answers), "no touch was told"
across = [f[26:29] for f in struct.iter_unpack("<Q17dI4i3I40x3d", data[16 + 8192:])]
assert min(sum(map(lambda a, b: a * b, across[0], x)) for x in across) < math.cos(0.5), "the hand did not turn the tool"
PY
"$TREPHINE" replay "$work/drill" "$work/a.servo" >/dev/null || fail "the recording does not replay"
on_bone() { /usr/bin/python3 "$SOURCE/examples/udp_client/udp_client.py" 127.0.0.1 "$port" "$1" 1 -20 317 0 0 -1 "${@:2}"; }
done
on_bone() ( exec "$work/client" 127.0.0.1 "$port" "$1" 1 -20 317 0 0 -1 "${@:2}" )

# With its pedal down it drills.
begin --timeout-ms 10000 --seconds 3 --tool ball --tool-diameter-mm 4 --drill --record "$work/d.servo" --json "$work/d.json"
on_bone 4 6 "$work/log" 1 >"$work/client_text" || fail "the client: $(cat "$work/client_text")"
wait $servo || fail "the servo: $(cat "$work/stderr")"
python3 - "$work/d.json" <<'PY'
import json, sys
said = json.load(open(sys.argv[1]))
assert said["faults"] == 0 and said["drilled"]["removed_mm3"]["skull"] > 1, said
PY
"$TREPHINE" replay "$work/drill" "$work/d.servo" >"$work/said" || fail "the drilled recording does not replay"
grep -q '^the drilled volume is the same$' "$work/said" || fail "another volume"
case=$work/sample

# Killed while it presses.
begin --timeout-ms 200 --resume-s 0 --seconds 4 --record "$work/b.servo"
"$work/client" 127.0.0.1 "$port" 60 1 -20 384 0 0 -1 3 >"$work/client_text" &
first=$!
for _ in $(seq 30000); do grep -q '^servo at ' "$work/text" && break; sleep 0.01; done
sleep 1
kill -9 $first 2>/dev/null || fail "the client ended before it was killed: $(cat "$work/client_text")"
wait $first 2>/dev/null || true
code=0
wait $servo || code=$?
[[ $code == 74 ]] || fail "the servo ended with $code: $(cat "$work/stderr")"
grep -Eq '^fault after [0-9.]+ s: device lost; the force stays zero$' "$work/text" || { cat "$work/text"; fail "not said"; }
grep -q 'faults device lost$' "$work/text" || { cat "$work/text"; fail "the client was not missed"; }
python3 - "$work/b.servo" <<'PY'
import struct, sys
frames = list(struct.iter_unpack("<Q17dI4i3I40x3d", open(sys.argv[1], "rb").read()[16 + 8192:]))
last = max(n for n, f in enumerate(frames) if n and f[3:6] != frames[n - 1][3:6])  # the last new pose
lost = next(n for n, f in enumerate(frames) if f[24] == 8)
assert all(f[15:18] == (0, 0, 0) for f in frames[lost:]) and all(f[24] == 8 for f in frames[lost:])
# The tick before was still in time; one that woke late saw the clock, which was further than the loop's time.
assert frames[lost - 1][1] - frames[last][1] < 0.3 + 1e-6 * frames[last][25], (frames[lost - 1][1], frames[last])
PY

# Two at once: the second is refused, and the first does not feel it.
begin --timeout-ms 10000 --seconds 3
client 5 >"$work/client_text" &
first=$!
for _ in $(seq 30000); do grep -q '^servo at ' "$work/text" && break; sleep 0.01; done
code=0
client 1 >"$work/second" || code=$?
[[ $code == 2 ]] || fail "the second client ended with $code"
grep -q ' 0 answers.*force at most 0\.000 N, another client is there' "$work/second" || { cat "$work/second"; fail "second"; }
wait $first || fail "the first client: $(cat "$work/client_text")"
wait $servo || fail "the servo: $(cat "$work/stderr")"
grep -Eq '^udp: .* [1-9][0-9]* strangers, ' "$work/text" || { cat "$work/text"; fail "no stranger"; }
grep -q 'faults none$' "$work/text" || { cat "$work/text"; fail "a fault"; }

# What either client refuses, by one line.
for client in "$work/client" "/usr/bin/python3 $SOURCE/examples/udp_client/udp_client.py"; do
  expect 64 '^udp_client ADDRESS PORT ' $client
  expect 64 '^udp_client: nohost\.invalid: is no IPv4 address in numbers$' $client nohost.invalid 20517 1 1 -20 384 0 0 -1 3
  expect 64 '^udp_client: DX DY DZ: must have a length$' $client 127.0.0.1 20517 1 1 -20 384 0 0 0 3
  expect 64 '^udp_client: far: is no number$' $client 127.0.0.1 20517 1 1 -20 far 0 0 -1 3
  expect 64 '^udp_client: 4: are no pedals' $client 127.0.0.1 20517 1 1 -20 384 0 0 -1 3 "$work/log" 4
  expect 64 '^udp_client: 65536: is no port' $client 127.0.0.1 65536 1 1 -20 384 0 0 -1 3
  expect 73 '^udp_client: .*none/log: No such file' $client 127.0.0.1 20517 1 1 -20 384 0 0 -1 3 "$work/none/log"
done

servo=("$TREPHINE" servo "$work/sample" --device udp --port 0)
expect 66 'device: no pose came to 127\.0\.0\.1:[0-9]+' "${servo[@]}" --wait-s 0.05
expect 64 'no-paced' "${servo[@]}" --no-paced
expect 64 'address: example is no address' "${servo[@]}" --address example
expect 64 'trajectory' "${servo[@]}" --trajectory "$work/log"
