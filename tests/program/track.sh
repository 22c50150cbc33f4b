#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Two tools and a print before a fake tracker (track_fake_server.cpp): calibrated, registered, checked, and held in a case; what is
# lost comes again, and what cannot be is refused with what to do.
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/head" head
token=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["case"])' "$work/head/case.json")
hash=$(sha256sum <"$work/head/case.json" | head -c 64)
"$SERVER" print "$work/print.json" "$token" "$hash"
"$SERVER" print "$work/other.json" another "$hash"

. "$(dirname "$0")/tracker.sh"

# Tips.
pivot=("$TREPHINE" track pivot "${link[@]}" --reference-body Head)
for tool in Pointer Catheter; do
  steps 'pivot 1 2 3' 'spin 1 2 3' -- "${pivot[@]}" --tool-body $tool --lesson-tool "$([[ $tool == Pointer ]] || echo catheter)" --out "$work/$tool.json"
  well "pivot of $tool"
done
python3 - "$work" <<'PY'
import json, math, sys
for name, tip in (("Pointer", (3, -2, -151)), ("Catheter", (1, 6, -118))):
    t = json.load(open(f"{sys.argv[1]}/{name}.json"))
    off = math.dist(t["tip_mm"], tip)
    assert off < 0.3 and 0 < t["tip_error_mm"] < 0.3 and t["spread_deg"] > 10 and t["body"] == name, (t, off)
    axis = (-0.02, 0.03, 1)
    turned = math.degrees(math.acos(min(1, sum(a * b for a, b in zip(t["axis"], axis)) / math.hypot(*axis))))
    assert turned < 1, (t, turned)
PY
steps 'at 1 2 3' -- "${pivot[@]}" --tool-body Pointer --out "$work/none.json"
refused_as 80 'tip: the tool was turned by .*least_spread_deg.*tilt it farther'
steps 'pivot 1 2 3' 'at 1 2 3' -- "${pivot[@]}" --tool-body Pointer --out "$work/none.json"
refused_as 80 'axis: .*turn the tool about its own axis'
[[ ! -e $work/none.json ]] || fail "a refused tool is written"
tracker good
expect 64 '[-]-tool-body: is needed' "${pivot[@]}" --out "$work/none.json"
steps 'pivot 1 2 3' -- "$TREPHINE" track pivot --tracker-port "$port" --tracker-wait-s 2 --reference-body Head --tool-body Stylus --out "$work/none.json"
refused_as 66 'no pose of Stylus before Head came .*it sends other bodies: '
steps mirrored -- "$TREPHINE" track pivot --tracker-port "$port" --tracker-wait-s 2 --reference-body Head --tool-body Pointer --out "$work/none.json"
refused_as 66 'its poses are mirrored; set the server to a right-handed frame'
tracker good

# The print.
register=("$TREPHINE" track register "${link[@]}" --print "$work/print.json" --reference-body Head --tool "$work/Pointer.json" --tool "$work/Catheter.json")
marks=('mark 1' 'mark 2' 'mark 3' 'mark 4' 'mark 5' 'mark 6' 'mark 7' 'mark 8')
steps "${marks[@]}" 'hold 2' 'hold 7' -- "${register[@]}" --out "$work/head.tracking.json"
well register
grep -q '^8 of 8 marks, 0\.[0-9]* mm off' "$work/said" || fail "$(cat "$work/said")"
grep -q '^expected error at monro_right: 0\.[0-9]* mm' "$work/said" || fail "$(cat "$work/said")"
# Another mark than the one that was asked for is recognised.
steps 'mark 1' 'mark 4' 'mark 3' 'mark 2' 'mark 8' 'hold 1' 'hold 1' -- "${register[@]}" --marks 1,2,3,4,8 --out "$work/swapped.json"
well 'exchanged marks'
[[ $(grep -c '^warning: another mark than [24] was touched' "$work/said") == 2 ]] || fail "$(cat "$work/said")"
# Two bodies that were exchanged after they were calibrated.
steps "${marks[@]}" 'hold 2' 'swapped' -- "${register[@]}" --out "$work/none.json"
refused_as 80 'tools: Catheter is .*two bodies were exchanged'
tracker good
steps 'mark 1' 'mark 1' 'mark 1' 'mark 1' -- "${register[@]}" --marks 1,2,3,4 --out "$work/none.json"
refused_as 80 'marks: '
expect 64 '[-]-marks: 9: there is no such mark' "${register[@]}" --marks 1,2,3,9 --out "$work/none.json"
expect 64 '[-]-marks: 3 are given, at least 4' "${register[@]}" --marks 1,2,3 --out "$work/none.json"
check=("$TREPHINE" track check "${link[@]}" --tracking "$work/head.tracking.json")
steps 'hold 3' 'hold 5' -- "${check[@]}" --print "$work/print.json"
well check
tracker swapped
steps 'hold 3' 'hold 5' -- "${check[@]}" --print "$work/print.json"
refused_as 80 'tools: Pointer is '
tracker good
expect 65 'print_sha256: another print' "${check[@]}" --print "$work/other.json"
[[ ! -e $work/none.json ]] || fail "a refused registration is written"

# In a case: the tip comes down onto the skin, and is felt where it is.
servo=("$TREPHINE" servo "$work/head" --device openigtlink --tracking "$work/head.tracking.json" "${link[@]}" --no-realtime --max-step-s 3600)
tracker 'at 0 0 90'
"${servo[@]}" --seconds 2 --record "$work/one.servo" --json "$work/one.json" >"$work/said" 2>"$work/stderr" || fail "$(cat "$work/stderr")"
grep -q "^waiting for the tracker at 127.0.0.1:$port" "$work/said" || fail "$(cat "$work/said")"
python3 - "$work/one.json" <<'PY'
import json, sys
j = json.load(open(sys.argv[1]))
c = j["device_counts"]
assert j["device"] == "openigtlink" and c["poses"] > 10 and c["connections"] == 1 and c["broken"] == c["mirrored"] == 0, j
PY
"$TREPHINE" replay "$work/head" "$work/one.servo" | grep -q '^replayed bit for bit$' || fail "not bit for bit"

# lost HOW BACK: while it runs the tracker is lost, the session says so, and it goes on when it comes back.
lost() {
  : >"$work/said"  # else what the session before printed may be read
  "${servo[@]}" --seconds 600 --record "$work/lost.servo" >"$work/said" 2>"$work/stderr" &
  local pid=$!
  until grep -q '^servo at' "$work/said"; do sleep 0.02; [[ -e /proc/$pid ]] || fail "$(cat "$work/stderr")"; done
  tracker "$1"
  until grep -q '^fault after .*gap.*the force is zero until the device is back' "$work/said"; do sleep 0.05; [[ -e /proc/$pid ]] || fail "$(cat "$work/said")"; done
  tracker "$2"
  [[ $2 == good ]] || tracker good
  sleep 1  # it goes on meanwhile; nothing is expected of how long that is
  kill -INT $pid
  code=0; wait $pid || code=$?
  [[ $code == 130 ]] || fail "$1: exit code $code: $(cat "$work/stderr")"
  grep -Eq 'of the device and [1-9][0-9]* gaps' "$work/said" || fail "$1: $(cat "$work/said")"
  "$TREPHINE" replay "$work/head" "$work/lost.servo" | grep -q '^replayed bit for bit$' || fail "$1: not bit for bit"
}
for how in silent unwell mirrored; do lost $how good; done
lost gone back

# What does not go together.
python3 - "$work/head.tracking.json" "$work/elsewhere.json" <<'PY'
import sys
open(sys.argv[2], "w").write(open(sys.argv[1]).read().replace('"case": "', '"case": "x'))
PY
no=("$TREPHINE" servo "$work/head" --device openigtlink)
expect 65 'elsewhere.json: case: x.*the print of another case' "${no[@]}" --tracking "$work/elsewhere.json" "${link[@]}"
sed -E 's/("case_sha256": ")[0-9a-f]{8}/\100000000/' "$work/head.tracking.json" >"$work/again.json"
expect 65 'again.json: case_sha256: the case was made again since it was printed' "${no[@]}" --tracking "$work/again.json" "${link[@]}"
expect 65 'print.json: ' "${no[@]}" --tracking "$work/print.json" "${link[@]}"
expect 64 '[-]-tracking: is needed' "${no[@]}"
expect 64 'workspace-.*do not go together' "${servo[@]}" --workspace-scale 2
expect 64 '[-]-no-paced' "${servo[@]}" --no-paced
echo quit >&"$tracker_in"
expect 66 'tracker: no pose of Pointer before Head came from 127.0.0.1:1: nobody answers' "${no[@]}" --tracking "$work/head.tracking.json" --tracker-port 1 --tracker-wait-s 0.5
