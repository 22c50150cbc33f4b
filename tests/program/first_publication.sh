#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A case appears whole: whoever looks while the first run publishes sees nothing, or all of it; a run that is killed at any moment
# leaves nothing under the case's name, and what it leaves is hidden, and the next run and `library gc` remove it. LONG=1: 60 kills.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/library_common.sh"
"$TREPHINE" phantom "$work/l/one" $tiny_flags --seed 7 --quiet >/dev/null
sed -i 's/^trephine: 1$/&\ncase: head\nseries: one\/dicom/' "$work/l/c.yaml"
out=$work/out
run=("$TREPHINE" run "$work/l/c.yaml" --out "$out" --quiet)

# Somebody looks all the time.
python3 - "$out/head" "${run[@]}" <<'PY'
import json, os, pathlib, subprocess, sys
case = pathlib.Path(sys.argv[1])
looks = hidden = 0
run = subprocess.Popen(sys.argv[2:], stderr=subprocess.DEVNULL)
while run.poll() is None and not case.exists():
    looks += 1
    hidden += any(p.name == ".head.new" for p in case.parent.iterdir()) if case.parent.exists() else 0
there = sorted(str(p.relative_to(case)) for p in case.rglob("*")) if case.exists() else []
assert run.wait() == 0 and looks > 10, (run.returncode, looks)
assert hidden > 0, "nothing was under way in a hidden folder"
assert "case.json" in there and "run.json" in there and any(n.startswith("report/") for n in there), there
names = {f["name"] for f in json.loads((case / "case.json").read_text())["files"]}
assert names <= set(there), names - set(there)
assert not [p.name for p in case.parent.iterdir() if p.name.endswith(".new")]
PY
first=$(case_digest "$out/head")

# An update stays in its place: the old case is whole until the new one is.
inode=$(stat -c %i "$out/head")
"${run[@]}" --set skull.smooth.iterations_count=3 2>/dev/null
[[ $(stat -c %i "$out/head") == "$inode" && $first != "$(case_digest "$out/head")" ]] || fail "an update replaced the folder, or did nothing"

# Killed at each rename, write and sync of a first run in turn.
[[ -n ${FAULT:-} ]] || fail "no FAULT"
count() {  # FUNCTION: how many calls of it a run makes
  rm -rf "$out/head"; : >"$work/count"
  LD_PRELOAD=$FAULT TREPHINE_FAULT="$1:1:0" TREPHINE_FAULT_COUNT="$work/count" TREPHINE_FAULT_IN=run "${run[@]}" >/dev/null 2>&1 || true
  awk '{ if ($NF > n) n = $NF } END { print n + 0 }' "$work/count"
}
for function in rename fsync open; do
  n=$(count $function)
  ((n > 0)) || fail "$function is never called"
  for ((i = 1; i <= n; i += LONG ? 1 : 1 + n / 6)); do
    rm -rf "$out/head"
    code=0
    LD_PRELOAD=$FAULT TREPHINE_FAULT="$function:$i:5" TREPHINE_FAULT_IN=run "${run[@]}" >/dev/null 2>"$work/said" || code=$?
    if [[ -e $out/head ]]; then
      case_digest "$out/head" >/dev/null || fail "$function $i: a part of a case"
    else
      [[ $code != 0 ]] || fail "$function $i: no case, and no word"
      [[ ! -e $out/.head.new ]] || fail "$function $i: what was under way is left after a refusal"
    fi
  done
done

# Killed at random moments.
kills=$((LONG ? 60 : 8)) met=0
rm -rf "$out/head"
start=$EPOCHREALTIME
"${run[@]}" --no-use-cache 2>/dev/null
took_us=$((${EPOCHREALTIME/[.,]/} - ${start/[.,]/}))
for ((i = 0; i < kills; ++i)); do
  rm -rf "$out/head"
  "${run[@]}" --no-use-cache 2>/dev/null &
  pid=$!
  sleep "$(python3 -c "import random; random.seed($i); print(random.uniform(0.2, 1.05) * $took_us / 1e6)")"
  kill -KILL $pid 2>/dev/null && met=$((met + 1))
  wait $pid 2>/dev/null || true
  if [[ -e $out/head ]]; then case_digest "$out/head" >/dev/null || fail "kill $i: a part of a case stands there"; fi
done
((met > 0)) || fail "no run was met"
rm -rf "$out/head"
"${run[@]}" 2>/dev/null
[[ $first == "$(case_digest "$out/head")" && ! -e $out/.head.new ]] || fail "after kills: another case, or remains"

# gc knows what a killed run left, and leaves alone what a run works on.
mkdir -p "$out/.gone.new/meshes" && touch "$out/.gone.new/.lock" "$out/.gone.new/meshes/skull-0123456789abcdef.glb"
"$TREPHINE" library gc "$out" --dry-run >"$work/said" && [[ -e $out/.gone.new ]] && grep -q '1 folders without' "$work/said" || { cat "$work/said"; fail "gc --dry-run"; }
flock "$out/.gone.new/.lock" "$TREPHINE" library gc "$out" >"$work/said"
[[ -e $out/.gone.new ]] && grep -q '1 cases are being built' "$work/said" || { cat "$work/said"; fail "gc beside a run"; }
"$TREPHINE" library gc "$out" >/dev/null
[[ ! -e $out/.gone.new && -e $out/head/case.json ]] || fail "gc"

# Somebody's files in the case's place stay, and the case comes to them with case.json last, as an update does.
rm -rf "$out/head"; mkdir "$out/head"; echo mine >"$out/head/notes.txt"
"${run[@]}" 2>/dev/null
[[ $(cat "$out/head/notes.txt") == mine && $first == "$(case_digest "$out/head")" ]] || fail "a folder with notes"
echo "killed $met of $kills"
