#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The adaptor for Haply's Inverse Service, with a fake of it (haply_fake.py says what it models): found, held where its cursor is,
# turned as its grip is, felt with the right sign, axis and unit, and every misbehaviour has its end.
. "$(dirname "$0")/common.sh"
: "${HAPLY_ADAPTOR:?}"
unset TREPHINE_HAPLY_SERVICE
"$WRITE_CASE" "$work/sample" drill
servo=("$TREPHINE" servo "$work/sample" --device adaptor --adaptor "$HAPLY_ADAPTOR" --workspace-axes haply --no-realtime --max-step-s 3600)
# The cursor goes forward from -120 to -60 mm and back in 4 s, beside 20 and above 150: on the case's front, which is at 1, -34, 300,
# to 5 mm within it. A fault comes after 30 mm: there it presses by 3 mm then.
press=(--workspace-offset-mm -19,31,150 --seconds 5)
early=(--workspace-offset-mm -19,59,150 --seconds 3)
failed=0 fake='' timeout_ms=1000
trap '[[ -z $fake ]] || kill "$fake" 2>/dev/null || true; chmod -R u+w "$work" 2>/dev/null; rm -rf "$work"' EXIT
wrong() { echo "FAILED: $*" >&2; failed=1; }  # goes on, so that one run names all that is wrong

# run FAULT [OPTIONS...]: into `code`, `port`, $work/stdout, $work/stderr, $work/run.json, $work/run.servo, $work/log.json.
run() {
  local fault=$1
  shift
  code=0
  rm -rf "$work/fake" "$work/run.json" "$work/run.servo" "$work/log.json"
  mkdir "$work/fake"
  python3 "$SOURCE/tests/program/haply_fake.py" "$work/fake" --fault "$fault" &
  fake=$!
  for _ in $(seq 3000); do
    [[ ! -e $work/fake/port ]] || break
    kill -0 $fake 2>/dev/null || fail "the fake ended"
    sleep 0.01
  done
  port=$(cat "$work/fake/port")
  TREPHINE_HAPLY_SERVICE=127.0.0.1:$port timeout 60 "${servo[@]}" --adaptor-timeout-ms "$timeout_ms" --json "$work/run.json" \
    --record "$work/run.servo" "$@" >"$work/stdout" 2>"$work/stderr" || code=$?
  for _ in $(seq 100); do  # until the fake has seen the end
    grep -q '"end": ""' "$work/fake/log.json" || break
    sleep 0.05
  done
  kill $fake 2>/dev/null || wrong "$fault: the fake ended"
  wait $fake || wrong "$fault: the fake ended with $?"
  fake=''
  mv "$work/fake/log.json" "$work/log.json"
}
# holds NAME EXPRESSION: of c, what the fake saw of the connection with most messages, cs, all of them, f, the forces on the first
# device, d, the program's JSON, and rows, the recording's frames; `size` and `near` are of vectors.
holds() {
  python3 - "$work" "$2" <<'PY' || wrong "$1: $2"
import json, math, os, statistics, struct, sys
work = sys.argv[1]
cs = json.load(open(work + "/log.json"))["connections"]
c = max(cs, key=lambda x: x["messages"]) if cs else {}
f = c.get("forces", {}).get("04BA", {"count": 0, "not_zero": 0, "largest_n": [0, 0, 0], "last_n": None})
d = json.load(open(work + "/run.json")) if os.path.exists(work + "/run.json") else {}
size = lambda v: math.sqrt(sum(x * x for x in v))
near = lambda v, w, by=1e-5: all(abs(x - y) < by for x, y in zip(v, w))
rows, frame_bytes = [], 0
if os.path.exists(work + "/run.servo"):
    data = open(work + "/run.servo", "rb").read()
    frame_bytes = json.loads(data[16:16 + 8192])["frame_bytes"]
    for r in struct.iter_unpack("<Q17dI4i3I40x" + ("3d" if frame_bytes == 240 else ""), data[16 + 8192:]):
        rows.append({"time_s": r[1], "tip": r[3:6], "axis": r[6:9], "force": r[15:18], "buttons": r[18] & 0x7fffffff, "across": r[26:]})
def columns():
    """Of Rz(25 degrees) Rx(-40) Ry(30): where the grip's own axes point."""
    def turned(v, a, b, degrees):  # from axis a to axis b
        s, c, w = math.sin(math.radians(degrees)), math.cos(math.radians(degrees)), list(v)
        w[a], w[b] = c * v[a] - s * v[b], s * v[a] + c * v[b]
        return w
    return [turned(turned(turned(e, 2, 0, 30), 1, 2, -40), 0, 1, 25) for e in ([1, 0, 0], [0, 1, 0], [0, 0, 1])]
def speeds_mm_per_s():
    """Of quarters of a second, forwards: the median of those that go back, and of those that go forwards."""
    parts, begin = [], rows[0]
    for r in rows:
        if r["time_s"] - begin["time_s"] >= 0.25:
            parts.append((r["tip"][1] - begin["tip"][1]) / (r["time_s"] - begin["time_s"]))
            begin = r
    return statistics.median(p for p in parts if p < 0), statistics.median(p for p in parts if p > 0)
def buttons():
    """One after the other."""
    return [r["buttons"] for n, r in enumerate(rows) if n == 0 or r["buttons"] != rows[n - 1]["buttons"]]
try:
    good = eval(sys.argv[2], globals())
except Exception as e:
    good, c = False, repr(e)
if not good:
    print(c, d.get("faults"), d.get("device_counts"), rows[:1], rows[-1:], file=sys.stderr)
    sys.exit(1)
PY
}
# never NAME [closed]: no run may do these; `closed`: the service closed the connection, whose last force it did not get then.
never() {
  holds "$1" 'all(x["bad"] == [] and x["unmodelled"] == [] for x in cs)'
  [[ ${2:-} == closed ]] || holds "$1" 'all(x["last_zero"] for x in cs)'
}
# runs FAULT [OPTIONS...]: ends with 0.
runs() {
  timeout_ms=10000 run "$@"  # on a machine under load the fake may be late by more than a second
  ((code == 0)) || wrong "$1: exit code $code: $(cat "$work/stderr")"
  [[ ! -s $work/stderr ]] || wrong "$1: writes to stderr $(cat "$work/stderr")"
  grep -Eiq '^holding .*(haply|inverse)' "$work/stdout" || wrong "$1: does not name what it holds: $(cat "$work/stdout")"
  never "$1"
  holds "$1" 'd["faults"] == 0 and d["device_counts"]["poses"] > 30'
  holds "$1" 'all(x["end"] == "closed by the client" and x["close_code"] in (1000, 1001, 1005) for x in cs)'
}
# ends CODES PATTERN FAULT [OPTIONS...]: with one of these codes, such as "66 74", and one line on stderr.
ends() {
  local want=$1 pattern=$2 fault=$3
  shift 2
  run "$@"
  [[ " $want " == *" $code "* ]] || wrong "$fault: exit code $code, not $want: $(cat "$work/stderr")"
  [[ $(wc -l <"$work/stderr") == 1 ]] || wrong "$fault: not one line on stderr: $(cat "$work/stderr")"
  grep -Eiq -- "$pattern" "$work/stderr" || wrong "$fault: stderr does not match '$pattern': $(cat "$work/stderr")"
  never "$fault" "$([[ $fault != close ]] || echo closed)"
}
felt='f["largest_n"][1] < -0.3 and abs(f["largest_n"][0]) < 0.15 * -f["largest_n"][1] and abs(f["largest_n"][2]) < 0.15 * -f["largest_n"][1]'
as_given='0.5 * d["most_force_n"] <= size(f["largest_n"]) <= 1.001 * d["most_force_n"]'
# The patient faces the operator: the device's right, forward and up are the patient's left, back and head.
where='all(near((r["tip"][0], r["tip"][2]), (1, 300)) and -89.001 < r["tip"][1] < -28.999 for r in rows)'
turns='min(r["tip"][1] for r in rows) < -87.5 and max(r["tip"][1] for r in rows) > -30.5'

runs none "${press[@]}"
holds none "$where"
holds none "$turns"
holds none 'near(speeds_mm_per_s(), (-30, 30), 1.5)'
holds none 'all(near(r["axis"], [-x for x in columns()[1]]) for r in rows)'
holds none 'frame_bytes == 240 and all(near(r["across"], rows[0]["across"]) for r in rows)'
holds none 'any(near(rows[0]["across"], [s * x for x in columns()[n]]) for n in (0, 2) for s in (1, -1))'
holds none 'set(buttons()) == {0, 1, 2, 4} and all(sum(r["buttons"] == b for r in rows) > 0.1 * len(rows) for b in (0, 1, 2, 4))'
holds none 'sum((a, b) in ((0, 1), (1, 2), (2, 4), (4, 0)) for a, b in zip(buttons(), buttons()[1:])) > 0.8 * (len(buttons()) - 1)'
holds none 'list(c["forces"]) == ["04BA"] and f["count"] > 100 and f["not_zero"] > 20'
holds none 'max(rows, key=lambda r: size(r["force"]))["force"][1] < -0.3 and d["touching_ratio"] > 0.02'
holds none "$felt"
holds none "$as_given"
holds none 'c["pings"] > 5 and c["pongs"] >= c["pings"] - 1'
ends 74 'device lost' unplugged "${early[@]}"
holds unplugged 'c["messages"] > 100'
ends 66 'no device is there' no_device "${early[@]}"

# Nobody listens there.
TREPHINE_HAPLY_SERVICE=127.0.0.1:$port timeout 60 "${servo[@]}" --seconds 1 >"$work/stdout" 2>"$work/stderr" && code=0 || code=$?
[[ $code == 74 || $code == 66 ]] && [[ $(wc -l <"$work/stderr") == 1 ]] && grep -q "127\.0\.0\.1:$port" "$work/stderr" &&
  grep -Eiq 'haply|inverse service' "$work/stderr" || wrong "without the service: exit code $code: $(cat "$work/stderr")"

if ((LONG)); then
  for index in 0 1; do
    x=$((index == 0 ? 1 : -69)) id=$( ((index == 0)) && echo 04BA || echo 1B3F)
    runs two_devices --adaptor-index $index "${press[@]}"
    holds "two_devices $index" "all(near((r['tip'][0], r['tip'][2]), ($x, 300)) for r in rows)"
    holds "two_devices $index" "[k for k, v in c['forces'].items() if v['count'] > 0] == ['$id']"
    grep -Eq "^holding .*$id" "$work/stdout" || wrong "two_devices: holds another one than $id: $(cat "$work/stdout")"
  done
  ends 66 'the devices that are there: 0 .*04BA.*, 1 .*1B3F' two_devices --adaptor-index 2 "${early[@]}"
  # Without a grip it is a device without a wrist: its tool has one direction, and nobody presses its buttons.
  runs no_grip "${press[@]}"
  holds no_grip "$where"
  holds no_grip "$felt"
  holds no_grip 'all(near(r["axis"], rows[0]["axis"]) and abs(size(r["axis"]) - 1) < 1e-6 and r["buttons"] == 0 for r in rows)'
  holds no_grip 'frame_bytes == 216'
  for fault in late fragments; do
    runs $fault "${press[@]}"
    holds $fault "$where"
    holds $fault "$turns"
    holds $fault "$felt"
  done
  timeout_ms=20 ends 74 'device lost' late "${early[@]}"
  for fault in silent half garbage close; do ends 74 'device lost' $fault "${early[@]}"; done
  for fault in nan null; do ends 74 'pose|device lost' $fault "${early[@]}"; done
  for fault in http mute; do ends '66 74' 'haply|inverse' $fault "${early[@]}"; done
  # A message that no state needs: it may be read, or be the end, but not hang.
  run big "${early[@]}"
  if ((code == 0)); then
    [[ ! -s $work/stderr ]] || wrong "big: writes to stderr $(cat "$work/stderr")"
  else
    ((code == 74)) && [[ $(wc -l <"$work/stderr") == 1 ]] && grep -q 'device lost' "$work/stderr" ||
      wrong "big: exit code $code: $(cat "$work/stderr")"
  fi
  never big
fi
((failed == 0)) || exit 1
