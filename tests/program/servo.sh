#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# trephine-sim servo and replay: a hand presses on a case, every tick is recorded, and the recording replays bit for bit.
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/sample"
# A busy machine may stand still for a second, which else ends all force.
servo=("$TREPHINE" servo "$work/sample" --max-step-s 3600)

"${servo[@]}" --seconds 0.5 --no-realtime --approach-mm 1 >"$work/text"
grep -q '^servo at 1000 Hz on hand: normal scheduling, no promise' "$work/text" || fail "does not say what it got"
grep -q '^500 ticks, ' "$work/text" || { cat "$work/text"; fail "not 500 ticks"; }
grep -q '^woken late mean ' "$work/text" || fail "no lateness"

"${servo[@]}" --seconds 6 --no-paced --approach-mm 1 --radius-mm 10 --record "$work/a.servo" --json "$work/a.json" \
  >"$work/text"
[[ $(stat -c %s "$work/a.servo") == $((16 + 8192 + 6000 * 216)) ]] || fail "a recording of another size"
python3 - "$work/a.json" "$work/a.servo" <<'PY'
import json, math, struct, sys
said = json.load(open(sys.argv[1]))
assert said["ticks"] == 6000 and said["faults"] == 0 and said["frames_lost"] == 0, said
assert said["touching_ratio"] > 0.5 and said["events"]["touch"] >= 1 and said["most_force_n"] > 0.01, said
# The documented layout, read by somebody else.
data = open(sys.argv[2], "rb").read()
magic, version, length = struct.unpack_from("<8sII", data)
assert (magic, version, length) == (b"TREPHSRV", 21, 8192)
header = json.loads(data[16:16 + length])
assert header["case"] == "sample" and header["frame_bytes"] == 216 and header["rate_hz"] == 1000, header
frames = list(struct.iter_unpack("<Q17dI4i3I40x", data[16 + length:]))
assert [f[0] for f in frames] == list(range(6000))
assert abs(frames[-1][1] - 6) < 1e-9 and all(f[2] == 0.001 for f in frames)
assert max(math.dist(f[15:18], (0, 0, 0)) for f in frames) == said["most_force_n"]
assert sum(f[19] != 0 for f in frames) == round(said["touching_ratio"] * 6000)
PY
"$TREPHINE" replay "$work/sample" "$work/a.servo" --json "$work/r.json" >"$work/text"
grep -q '^replayed bit for bit$' "$work/text" || fail "not the same"
"$TREPHINE" replay "$work/sample" "$work/a.servo" --surface nearest --walk stepped >"$work/text"
grep -Eq '^replayed: in contact [0-9.]+ %, anomaly coefficient ' "$work/text" || fail "no comparison"
# The same bytes when nothing but the clock differs.
"${servo[@]}" --seconds 6 --no-paced --approach-mm 1 --radius-mm 10 --record "$work/b.servo" >/dev/null
cmp "$work/a.servo" "$work/b.servo" || fail "two equal runs differ"

printf '0 0 0 200\n1 0 0 100\n' >"$work/path.txt"
"${servo[@]}" --device trajectory --trajectory "$work/path.txt" --seconds 1 --no-paced >"$work/text"
grep -q '^1000 ticks, ' "$work/text" || fail "no trajectory"

# Contact that is lost for good counts: as frames without force, and as the step that it was.
printf '0 1 -20 390\n1 1 -20 382\n2 1 -20 382\n2.001 1 -20 450\n4 1 -20 450\n' >"$work/lost.txt"
"${servo[@]}" --device trajectory --trajectory "$work/lost.txt" --seconds 4 --no-paced --record "$work/lost.servo" >"$work/text"
grep -q 'faults jump$' "$work/text" && grep -q '^1 jumps of the device and 0 gaps,' "$work/text" || { cat "$work/text"; fail "no jump"; }
"$TREPHINE" replay "$work/sample" "$work/lost.servo" --json "$work/lost.json" >/dev/null
python3 - "$work/lost.json" <<'PY'
import json, sys
f = json.load(open(sys.argv[1]))["recorded"]
assert f["zero_force_ratio"] > 0.5 and f["touching"] < 0.5 * f["frames"] and f["most_step_n"] > 0, f
PY
# A device with a delay, and what is felt everywhere.
"${servo[@]}" --seconds 3 --no-paced --device-delay-ms 3 --viscosity-n-s-per-mm 0.002 --weight-n 0,0.1,0 --guide line \
  --guide-point-mm 0,0,300 --record "$work/late.servo" >"$work/text"
"$TREPHINE" replay "$work/sample" "$work/late.servo" | grep -q '^replayed bit for bit$' || fail "delay and guide do not replay"
grep -aq '"guide": *"line"' "$work/late.servo" && grep -aq '"device_delay_ms": *3' "$work/late.servo" || fail "not in the header"
grep -Eq '^all that is touched has 0\.[0-9]+ of its stiffness, since the device answers after 3 ms and damps by 2 N s/m$' "$work/text" ||
  { cat "$work/text"; fail "the softer walls are not reported"; }
printf '0 0 0 2000\n1 0 0 2000\n' >"$work/air.txt"
"${servo[@]}" --device trajectory --trajectory "$work/air.txt" --seconds 1 --no-paced --record "$work/air.servo" >"$work/text"
"$TREPHINE" replay "$work/sample" "$work/air.servo" | grep -q '^recorded: no contact to judge' || fail "judges air"
# Behind a delay no wall is stable without damping.
told=("${servo[@]}" --device trajectory --trajectory "$work/air.txt" --seconds 1 --no-paced --device-delay-ms 2)
expect 64 'device-delay-ms: 2, and the device.s damping is not known: .*--device-own-damping-n-s-per-mm .*--allow-undamped' "${told[@]}"
"${told[@]}" --device-own-damping-n-s-per-mm 0.002 >"$work/text" && grep -q 'of its stiffness' "$work/text" || fail "a damping that is given"
"${told[@]}" --allow-undamped >"$work/text" && grep -q 'yields to a lasting press' "$work/text" || fail "no warning"

# Ctrl-C ends a session; what it recorded stays.
"${servo[@]}" --seconds 60 --no-realtime --record "$work/stopped.servo" --json "$work/stopped.json" >"$work/text" 2>"$work/stderr" &
stopped=$!
# After 300 ticks, which are in the file that the recording is made in.
for _ in $(seq 30000); do
  size=$(stat -c %s "$work"/.trephine-tmp-* 2>/dev/null | sort -n | tail -1) || true
  ((${size:-0} < 16 + 8192 + 300 * 216)) || break
  sleep 0.01
done
kill -INT $stopped
code=0
wait $stopped || code=$?
[[ $code == 130 ]] || fail "stopped with $code"
python3 - "$work/stopped.json" <<'PY'
import json, sys
said = json.load(open(sys.argv[1]))
assert 300 <= said["ticks"] < 60000 and said["case"] == "sample" and said["walk"] == "exact", said
PY
"$TREPHINE" replay "$work/sample" "$work/stopped.servo" >/dev/null || fail "a stopped session does not replay"

# A fault is said when it happens, and at the end.
printf '0 0 0 200\n1 0 0 1e7\n' >"$work/far.txt"
expect 74 'device: pose: the force was zero' "${servo[@]}" --device trajectory --trajectory "$work/far.txt" --seconds 1 --no-paced
grep -q 'faults pose, jump$' "$work/stdout" || fail "no fault"
expect 64 'are the same file' "${servo[@]}" --seconds 1 --no-paced --record "$work/one" --json "$work/../$(basename "$work")/one"

# A tool of many points: said at the start, named in the recording, and replayed.
"${servo[@]}" --tool burr --tool-spacing-mm 0.8 --seconds 3 --no-paced --approach-mm 1 --radius-mm 10 \
  --record "$work/tool.servo" --json "$work/tool.json" >"$work/text"
grep -q '^tool burr: [0-9]* points, 5 mm in diameter, 30 mm long$' "$work/text" || fail "does not say its tool"
"$TREPHINE" replay "$work/sample" "$work/tool.servo" >"$work/text"
grep -q '^3000 frames at 1000 Hz of device hand, tool burr, case sample$' "$work/text" || fail "replays no burr"
grep -q '^replayed bit for bit$' "$work/text" || fail "the burr is not the same"
python3 - "$work/tool.json" "$work/tool.servo" <<'PY'
import json, sys
said = json.load(open(sys.argv[1]))
assert said["touching_ratio"] > 0.5 and said["most_force_n"] > 0.01 and said["events"]["locked"] == 0, said
tool = json.loads(open(sys.argv[2], "rb").read()[16:16 + 8192])["tool"]
assert tool["tool"] == "burr" and tool["tool_tip"] == "ball" and tool["tool_spacing_mm"] == 0.8, tool
PY
# A recording that was changed has a broken seal; one whose seal was taken off is told, and so can be changed in what follows.
cp "$work/a.servo" "$work/broken.servo"
printf '\x01' | dd of="$work/broken.servo" bs=1 seek=$((16 + 8192 + 5000 * 216 + 130)) conv=notrunc status=none
expect 80 'broken\.servo: seal_sha256: is not of these bytes' "$TREPHINE" replay "$work/sample" "$work/broken.servo"
python3 - "$work/a.servo" <<'PY'
import json, sys
data = open(sys.argv[1], "rb").read()
header = json.loads(data[16:16 + 8192])
assert len(header.pop("seal_sha256")) == 64
open(sys.argv[1], "wb").write(data[:16] + json.dumps(header).encode().ljust(8192) + data[16 + 8192:])
PY
"$TREPHINE" replay "$work/sample" "$work/a.servo" | grep -q '^not sealed' || fail "does not say that it is not sealed"
# Materials that changed, a shape that is not there, ticks that do not ascend.
python3 - "$work/a.servo" "$work" <<'PY'
import json, sys
data = open(sys.argv[1], "rb").read()
def write(name, change):
    header = json.loads(data[16:16 + 8192])
    change(header)
    open(f"{sys.argv[2]}/{name}", "wb").write(data[:16] + json.dumps(header).encode().ljust(8192) + data[16 + 8192:])
write("material.servo", lambda h: h.update(feel_sha256="0" * 64))
write("shape.servo", lambda h: h.update(felt_shape="liver"))
write("lacks.servo", lambda h: h.pop("case_sha256"))
frame = 16 + 8192 + 100 * 216
open(f"{sys.argv[2]}/ticks.servo", "wb").write(data[:frame] + bytes(8) + data[frame + 8:])
cut = 16 + 8192 + 1000 * 216
open(f"{sys.argv[2]}/cut.servo", "wb").write(data[:-500 * 216])
header = json.loads(data[16:16 + 8192])
assert header["frames"] == 6000, header
header["frames"] = 5500
open(f"{sys.argv[2]}/gap.servo", "wb").write(data[:16] + json.dumps(header).encode().ljust(8192) + data[16 + 8192:cut] + data[cut + 500 * 216:])
write("wide.servo", lambda h: h["tool"].update(tool="catheter", tool_length_mm=400, tool_spacing_mm=0.01))
PY
expect 65 'wide\.servo: tool_spacing_mm: gives more than' "$TREPHINE" replay "$work/sample" "$work/wide.servo"
expect 65 'cut\.servo: frames: the file holds 5500, and 6000 were recorded: the file was cut short or added to; take it' "$TREPHINE" replay "$work/sample" "$work/cut.servo"
expect 65 'feel_sha256: the case.s materials are not' "$TREPHINE" replay "$work/sample" "$work/material.servo"
expect 65 'felt_shape: liver' "$TREPHINE" replay "$work/sample" "$work/shape.servo"
expect 65 'case_sha256: is missing' "$TREPHINE" replay "$work/sample" "$work/lacks.servo"
expect 65 'frames: tick and time_s of frame 100 must be above' "$TREPHINE" replay "$work/sample" "$work/ticks.servo"
expect 80 'differ when replayed' "$TREPHINE" replay "$work/sample" "$work/gap.servo"
grep -q '^500 frames are missing' "$work/stdout" || fail "does not say that frames are missing"
# A recording of another version is refused, and both are named.
cp "$work/a.servo" "$work/other.servo"
printf '\x09' | dd of="$work/other.servo" bs=1 seek=8 conv=notrunc status=none
expect 65 'version: 9, this program reads version 21: record it anew' "$TREPHINE" replay "$work/sample" "$work/other.servo"
expect 64 '[-]-tool-spacing-mm: gives more than 2048 points' "${servo[@]}" --tool catheter --tool-spacing-mm 0.01

# A tool of somebody's own points; its recording holds a replay to the same file.
printf '# a small rake\n0 0 4\n1.5 0 0.5\n-1.5 0 0.5\n' >"$work/rake.txt"
"${servo[@]}" --seconds 1 --no-paced --approach-mm 1 --radius-mm 5 --tool points --tool-points "$work/rake.txt" \
  --record "$work/rake.servo" >"$work/text" || { cat "$work/text"; fail "own points are not felt"; }
"$TREPHINE" replay "$work/sample" "$work/rake.servo" >"$work/text"
grep -q '^replayed bit for bit$' "$work/text" || fail "own points are not replayed"
echo '0 0 6' >>"$work/rake.txt"
expect 65 'rake\.servo: tool_points_sha256: is not that of the file' "$TREPHINE" replay "$work/sample" "$work/rake.servo"
echo '0 0' >>"$work/rake.txt"
expect 65 'rake\.txt: line 6: must be three numbers' "${servo[@]}" --tool points --tool-points "$work/rake.txt"
rm "$work/rake.txt"
expect 66 'rake\.txt' "${servo[@]}" --tool points --tool-points "$work/rake.txt"
expect 64 '[-]-shaft-rigidity-n-mm2: a shaft bends where --line-lock-in' "${servo[@]}" --tool needle --shaft-rigidity-n-mm2 2300
expect 64 '[-]-tool-points: is missing' "${servo[@]}" --tool points
expect 64 '[-]-tool-points: is for --tool points' "${servo[@]}" --tool needle --tool-points "$work/a.servo"

# One bit of one frame.
cp "$work/a.servo" "$work/c.servo"
printf '\x01' | dd of="$work/c.servo" bs=1 seek=$((16 + 8192 + 5000 * 216 + 130)) conv=notrunc status=none
expect 80 'c\.servo: frames: [0-9]+ of 6000 differ' "$TREPHINE" replay "$work/sample" "$work/c.servo"
truncate -s -1 "$work/c.servo"
expect 65 'c\.servo: frames: the last one is incomplete: the file was cut short' "$TREPHINE" replay "$work/sample" "$work/c.servo"
expect 65 'path\.txt: is no recording' "$TREPHINE" replay "$work/sample" "$work/path.txt"
expect 64 '--shape: the case has none of that name, but outer, inner' "${servo[@]}" --shape skull
expect 64 '--trajectory: is needed' "${servo[@]}" --device trajectory
expect 66 'nowhere' "${servo[@]}" --device trajectory --trajectory "$work/nowhere"
expect 64 '[-]-from: no surface' "${servo[@]}" --radius-mm 200
expect 64 '[-]-from: must have a length' "${servo[@]}" --from 0,0,0
printf '0 0 0\n' >"$work/bad.txt"
expect 65 'bad\.txt: line 1: ' "${servo[@]}" --device trajectory --trajectory "$work/bad.txt"
expect 73 'nowhere' "${servo[@]}" --record "$work/nowhere/a.servo"
[[ -z $(ls -A "$work" | grep trephine-tmp || true) ]] || fail "temporaries are left"
