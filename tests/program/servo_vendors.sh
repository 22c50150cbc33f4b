#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The adaptors for Force Dimension's and 3D Systems' libraries, with fakes of these (dhd_fake.c, hd_fake.c say what they model):
# found, held, felt with the right sign, axis and unit, and every misbehaviour has its end.
. "$(dirname "$0")/common.sh"
: "${DHD_ADAPTOR:?}" "${HD_ADAPTOR:?}" "${DHD_FAKE:?}" "${HD_FAKE:?}"
export TREPHINE_DHD_LIBRARY=$DHD_FAKE TREPHINE_HD_LIBRARY=$HD_FAKE
unset TREPHINE_FAKE TREPHINE_FAKE_LATE_MS
"$WRITE_CASE" "$work/sample" drill
servo=("$TREPHINE" servo "$work/sample" --device adaptor --adaptor-timeout-ms 1000 --no-realtime --max-step-s 3600 --seconds 1.5)
# Both fakes sink from 316 to 311 mm above the case's 1, -20, onto what lies there.
dhd=("${servo[@]}" --adaptor "$DHD_ADAPTOR" --workspace-axes omega --workspace-offset-mm -4,-10,296)
hd=("${servo[@]}" --adaptor "$HD_ADAPTOR" --workspace-axes touch --workspace-offset-mm -2,-13,296)
failed=0
wrong() { echo "FAILED: $*" >&2; failed=1; }  # goes on, so that one run says all that is wrong

# run VENDOR FAKE [OPTIONS...]: into `code`, $work/stdout, $work/stderr (without the fake's lines), $work/fake (these).
run() {
  local -n command=$1
  local fake=$2
  shift 2
  code=0
  rm -f "$work/run.json"
  TREPHINE_FAKE=$fake timeout 120 "${command[@]}" --json "$work/run.json" "$@" >"$work/stdout" 2>"$work/both" || code=$?
  grep '^{"fake"' "$work/both" >"$work/fake" || true
  grep -v '^{"fake"' "$work/both" >"$work/stderr" || true
}
# holds NAME EXPRESSION: of f, what the fake says of the device that was read, fs, all that it says, and d, the program's JSON.
holds() {
  python3 - "$work/fake" "$work/run.json" "$2" <<'PY' || wrong "$1: $2"
import json, math, os, sys
fs = [json.loads(line) for line in open(sys.argv[1])]
f = max(fs, key=lambda x: x["reads"]) if fs else {}
last = {(x["fake"], x.get("id", x.get("name"))): x for x in fs}
d = json.load(open(sys.argv[2])) if os.path.exists(sys.argv[2]) else {}
size = lambda v: math.sqrt(sum(x * x for x in v))
try:
    good = eval(sys.argv[3])
except Exception as e:
    good, f = False, repr(e)
if not good:
    print(f, file=sys.stderr)
    sys.exit(1)
PY
}
# never VENDOR WHAT: no run may do these.
never() {
  if [[ $1 == dhd ]]; then
    holds "$2" 'all(x["wrong_id"] == x["after_close"] == x["before_enable"] == x["after_disable"] == x["not_finite"] == 0 for x in fs)'
  else
    holds "$2" 'all(x["outside_frame"] == x["outside_callback"] == x["reads_outside_frame"] == x["frames_open"] == x["frames_twice"] == x["device_not_current"] == x["wrong_handle"] == x["before_enable"] == x["not_finite"] == x["over_most"] == x["wrong_type"] == 0 for x in fs)'
    holds "$2" 'not any(x["scheduler_left_running"] or x["enabled_after_start"] or x["callbacks_left"] for x in fs)'
  fi
  holds "$2" 'not any(x["left_open"] for x in fs)'
  holds "$2" 'all(size(x["last_n"]) == 0 for x in last.values())'
}
# runs VENDOR FAKE [OPTIONS...]: ends with 0 and was felt.
runs() {
  run "$@"
  ((code == 0)) || wrong "$1 $2: exit code $code: $(cat "$work/stderr")"
  [[ ! -s $work/stderr ]] || wrong "$1 $2: says $(cat "$work/stderr")"
  never "$1" "$1 $2"
  holds "$1 $2" 'd["faults"] == 0 and d["touching_ratio"] > 0.3 and d["device_counts"]["poses"] > 100'
}
# ends CODE PATTERN VENDOR FAKE [OPTIONS...]: as expect.
ends() {
  local want=$1 pattern=$2
  shift 2
  run "$@"
  [[ $code == "$want" ]] || wrong "$1 $2: exit code $code instead of $want: $(cat "$work/stderr")"
  [[ $(wc -l <"$work/stderr") == 1 ]] || wrong "$1 $2: not one line on stderr: $(cat "$work/stderr")"
  grep -Eiq -- "$pattern" "$work/stderr" || wrong "$1 $2: stderr does not match '$pattern': $(cat "$work/stderr")"
  never "$1" "$1 $2"
}

# Called straight: units, axes, and that the forces are of the device's frame.
cat >"$work/straight.py" <<'PY'
import ctypes as C, json, math, os, sys, time
what, fake, adaptor, vendor = sys.argv[1:5]
said = os.open(sys.argv[5], os.O_RDWR | os.O_CREAT | os.O_TRUNC)
screen = os.dup(2)
os.dup2(said, 2)
class Pose(C.Structure):
    _fields_ = [("tip", C.c_double * 3), ("axis", C.c_double * 3), ("across", C.c_double * 3), ("buttons", C.c_uint32)]
class Limits(C.Structure):
    _fields_ = [("force", C.c_double), ("damping", C.c_double), ("box", C.c_double * 3)]
a = C.CDLL(adaptor)
a.trephine_adaptor_open.restype = C.c_void_p
a.trephine_adaptor_error.restype = C.c_char_p
V3 = C.c_double * 3
bad = []
def must(good, *why):
    if not good:
        bad.append(" ".join(str(w) for w in why) + ": " + (a.trephine_adaptor_error() or b"NULL").decode())
near = lambda x, y: all(abs(p - q) < 1e-6 for p, q in zip(x, y))
size = lambda v: math.sqrt(sum(x * x for x in v))
must(a.trephine_adaptor_version() == 1, "version")
count = a.trephine_adaptor_count()
index = count - 1 if fake == "two" else 0
if what == "dhd": must(count == (2 if fake == "two" else 1), "count", count)
else: must(count >= 1, "count", count)
must(a.trephine_adaptor_count() == count, "counted again")
names = []
for n in range(count):
    text = C.create_string_buffer(64)
    must(a.trephine_adaptor_name(n, text, 64) == 0 and text.value, "name", n)
    names.append(text.value.decode())
must(len(set(names)) == count, "names differ", names)
small = C.create_string_buffer(b"xxxxxxxx", 9)
must(a.trephine_adaptor_name(0, small, 4) != 0 or (len(small.value) <= 3 and small.raw[4:8] == b"xxxx"), "name of size 4")
# opened and closed without a start, and a second time
for start in (False, True):
    d = C.c_void_p(a.trephine_adaptor_open(index))
    must(d.value, "open")
    if not d.value: break
    if start: break
    a.trephine_adaptor_close(d)
if d.value:
    limits = Limits()
    must(a.trephine_adaptor_limits(d, C.byref(limits)) == 0 and 0 < limits.force < 40 and 0 <= limits.damping < 0.1, "limits",
         limits.force, limits.damping)
    if what == "hd":
        must(abs(limits.force - 2.1) < 1e-9, "the force that the device holds continuously is 2.1 N, not", limits.force)
        must(limits.damping != 0.003, "HD_NOMINAL_MAX_DAMPING is not the device's own damping")
    must(a.trephine_adaptor_start(d) == 0, "start")
    pose = Pose()
    begin, reads, first = time.monotonic(), 0, None
    while time.monotonic() - begin < 0.8:
        must(a.trephine_adaptor_read(d, C.byref(pose)) == 0, "read", reads)
        if bad: break
        if first is None: first = (list(pose.tip), pose.buttons)
        a.trephine_adaptor_send(d, V3(0, 0, 0), V3(0, 0, 0))
        reads += 1
        time.sleep(0.001)
    if first:
        goal = (10, 5, 15) if what == "dhd" else (3, 15, 7)
        must(near(pose.tip, goal), "the tip rests at", list(pose.tip), "mm instead of", goal)
        must(first[1] == 0 and pose.buttons == 1, "buttons", first[1], pose.buttons)
        axis, across = list(pose.axis), list(pose.across)
        if what == "dhd":
            t = 0 if fake == "falcon" else math.pi / 6
            columns = [(math.cos(t), math.sin(t), 0), (-math.sin(t), math.cos(t), 0), (0, 0, 1)]
        else:
            t, u = math.radians(20), math.radians(-50)
            columns = [(math.cos(t), 0, -math.sin(t)), (math.sin(t) * math.sin(u), math.cos(u), math.cos(t) * math.sin(u)),
                       (math.sin(t) * math.cos(u), -math.sin(u), math.cos(t) * math.cos(u))]
            must(near(axis, columns[2]), "from the tip to the tail is the transform's z column", columns[2], "not", axis)
        either = [tuple(s * x for x in c) for c in columns for s in (1, -1)]
        must(any(near(axis, c) for c in either), "axis", axis, "is no column of the frame")
        if fake == "falcon":
            must(size(across) == 0, "a device without a wrist does not know across:", across)
        else:
            must(any(near(across, c) for c in either) and abs(sum(x * y for x, y in zip(axis, across))) < 1e-6, "across", across,
                 "is no other column of the frame")
        up = V3(0, 0, 1.5) if what == "dhd" else V3(0, 1.5, 0)
        for n in range(60):
            a.trephine_adaptor_read(d, C.byref(pose))
            must(a.trephine_adaptor_send(d, up, V3(10, 20, 30)) == 0, "send")
            time.sleep(0.001)
        if what == "hd" and fake == "":
            now = V3()
            C.CDLL(vendor).fake_last_n(now)
            must(near(now, up), "the force is there at once:", list(now))
            time.sleep(0.4)
            C.CDLL(vendor).fake_last_n(now)
            if size(now) > 0:
                os.write(screen, b"note: HD goes on with the last force where nobody sends one for 0.4 s\n")
        must(a.trephine_adaptor_send(d, V3(0, 0, 0), V3(0, 0, 0)) == 0, "send of none")
        a.trephine_adaptor_read(d, C.byref(pose))
    a.trephine_adaptor_close(d)
os.lseek(said, 0, 0)
lines = [json.loads(l) for l in os.read(said, 1 << 20).decode().splitlines() if l.startswith('{"fake"')]
f = max(lines, key=lambda x: x["sends"]) if lines else {}
if f:
    must(near(f["largest_n"], (0, 0, 1.5) if what == "dhd" else (0, 1.5, 0)), "force", f["largest_n"])
    must(size(f["last_n"]) == 0, "last force", f["last_n"])
    if what == "dhd" and fake == "two":
        must(f["id"] == 5, "device", f["id"])
        must(near(f["largest_nm"], (0.01, 0.02, 0.03)), "torque in Nm", f["largest_nm"])
    open_now = {}
    for x in lines: open_now[x.get("id", x.get("name"))] = x["left_open"]
    must(not any(open_now.values()), "left open", open_now)
else:
    must(False, "the fake closed nothing")
for b in bad[:8]: os.write(screen, f"FAILED: {what} {fake}: {b}\n".encode())
sys.exit(1 if bad else 0)
PY
((LONG)) && fakes=(two falcon timeguard) || fakes=()
for fake in '' "${fakes[@]}"; do
  TREPHINE_FAKE=$fake timeout 120 python3 "$work/straight.py" dhd "$fake" "$DHD_ADAPTOR" "$DHD_FAKE" "$work/said" || failed=1
done
((LONG)) && fakes=(two update)
for fake in '' "${fakes[@]}"; do
  TREPHINE_FAKE=$fake timeout 120 python3 "$work/straight.py" hd "$fake" "$HD_ADAPTOR" "$HD_FAKE" "$work/said" || failed=1
done

# Force Dimension: up is +z
runs dhd ''
grep -Eq '^holding .*omega' "$work/stdout" || wrong "dhd: does not say what it holds: $(cat "$work/stdout")"
up='f["largest_n"][2] > 0.3 and abs(f["largest_n"][0]) < 0.05 * f["largest_n"][2] and abs(f["largest_n"][1]) < 0.05 * f["largest_n"][2]'
as_given='0.9 * d["most_force_n"] <= size(f["largest_n"]) <= 1.001 * d["most_force_n"]'
holds 'dhd' 'f["enabled"] and f["id"] == 0'
holds 'dhd' "$up"
holds 'dhd' "$as_given"
holds 'dhd' 'f["sends"] >= d["device_counts"]["forces"]'
if ((LONG)); then
for fake in timeguard saturated falcon; do
  runs dhd $fake
  holds "dhd $fake" "$up"
  holds "dhd $fake" "$as_given"
done
holds 'dhd falcon' 'size(f["largest_nm"]) == 0'
for index in 0 1; do
  runs dhd two --adaptor-index $index
  ((index == 0)) && name=omega id=0 || name=sigma id=5
  grep -Eq "^holding .*$name" "$work/stdout" || wrong "dhd two: holds another one than $name: $(cat "$work/stdout")"
  holds "dhd two $index" "f['id'] == $id and all(x['sends'] == 0 for x in fs if x['id'] != $id)"
  holds "dhd two $index" "$up"
done
ends 66 'the devices that are there: 0 .*omega.*, 1 .*sigma' dhd two --adaptor-index 2
ends 66 'no device is there' dhd none
ends 74 'in use' dhd noopen
ends 74 'device not ready' dhd unenabled
ends 74 'device lost' dhd unsent
ends 74 'pose|device lost' dhd nan
TREPHINE_FAKE_LATE_MS=1500 ends 74 'device lost' dhd late
fi
ends 74 'device lost' dhd unplugged
TREPHINE_DHD_LIBRARY=/nonexistent.so run dhd ''
[[ $code == 74 || $code == 66 ]] && [[ $(wc -l <"$work/stderr") == 1 ]] && grep -q '/nonexistent\.so' "$work/stderr" &&
  grep -Eiq 'force ?dimension' "$work/stderr" || wrong "dhd without its library: exit code $code: $(cat "$work/stderr")"

# 3D Systems: up is +y
runs hd ''
grep -Eq '^holding .*(Touch|Default Device)' "$work/stdout" || wrong "hd: does not say what it holds: $(cat "$work/stdout")"
up='f["largest_n"][1] > 0.3 and abs(f["largest_n"][0]) < 0.05 * f["largest_n"][1] and abs(f["largest_n"][2]) < 0.05 * f["largest_n"][1]'
as_given='0.9 * min(d["most_force_n"], 2.1) <= size(f["largest_n"]) <= 1.001 * min(d["most_force_n"], 2.1)'
holds 'hd' 'f["enabled"] and f["frames"] > 500'
holds 'hd' "$up"
holds 'hd' "$as_given"
if ((LONG)); then
for fake in warm exceeded update; do
  runs hd $fake
  holds "hd $fake" "$up"
  holds "hd $fake" "$as_given"
done
holds 'hd update' 'f["calibrated"]'
runs hd limit
holds 'hd limit' "$up"
holds 'hd limit' '0.8 < size(f["largest_n"]) <= 0.880001'
runs hd two
holds 'hd two' 'all(x["sends"] == 0 for x in fs if x["name"] != f["name"])'
ends 66 'adaptor_index: 63' hd two --adaptor-index 63
ends 66 'no device is there' hd none
ends 74 'calibrat' hd uncalibrated
ends 74 'timer' hd unscheduled
ends 74 'pose|device lost' hd nan
run hd stalled  # callbacks come no more: no frame can take the force away, but what is held must be let go
((code == 74)) && grep -q 'device lost' "$work/stderr" || wrong "hd stalled: exit code $code: $(cat "$work/stderr")"
holds 'hd stalled' 'not any(x["left_open"] or x["scheduler_left_running"] for x in fs)'
fi
ends 74 'device lost' hd unplugged
TREPHINE_HD_LIBRARY=/nonexistent.so run hd ''
[[ $code == 74 || $code == 66 ]] && [[ $(wc -l <"$work/stderr") == 1 ]] && grep -q '/nonexistent\.so' "$work/stderr" &&
  grep -Eiq '3d ?systems|openhaptics' "$work/stderr" || wrong "hd without its library: exit code $code: $(cat "$work/stderr")"
((failed == 0)) || exit 1
