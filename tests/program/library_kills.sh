#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds of a library that are ended from outside: eight at once, killed at random moments, by Ctrl-C, by their time limit, and in a
# folder that cannot be written: whole cases, a line of why, no process left, and the next build makes it good. LONG=1: 100 kills.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/library_common.sh"
cd "$work/l"
"$TREPHINE" phantom "$work/l/one" $tiny_flags --seed 7 --quiet >/dev/null
printf 'trephine: 1\nconfig: c.yaml\ncases: [{case: a, series: one/dicom}, {case: b, series: one/dicom, set: {skull.smooth.iterations_count: 3}}]\n' >l.yaml
new=(--set skull.smooth.iterations_count=7)

# Eight builds at once: one works, the others are told so.
build l.yaml
before=$(digests)
rm -rf "$work/out"
pids=()
for i in {1..8}; do
  "$TREPHINE" library build l.yaml --out "$work/out" --quiet --no-pictures 2>"$work/said$i" &
  pids+=($!)
done
won=0 busy=0
for p in "${pids[@]}"; do
  code=0; wait "$p" || code=$?
  case $code in 0) won=$((won + 1)) ;; 75) busy=$((busy + 1)) ;; *) cat "$work"/said?; fail "one of eight ends with $code" ;; esac
done
[[ $won -ge 1 && $((won + busy)) == 8 ]] || fail "$won of eight built"
build l.yaml
[[ $before == "$(digests)" ]] || fail "eight at once: other cases"

# Killed at random moments, builder or all: whole cases, no process left, and the next build makes it good.
kills=$((LONG ? 100 : 4)) met=0
start=$EPOCHREALTIME
build l.yaml --rebuild "${new[@]}"
took_us=$((${EPOCHREALTIME/[.,]/} - ${start/[.,]/}))
for ((i = 0; i < kills; ++i)); do
  set=("${new[@]}"); ((i % 2)) && set=()
  "$TREPHINE" library build l.yaml --out "$work/out" --quiet --no-pictures --rebuild --jobs 2 "${set[@]}" >said 2>&1 &
  pid=$!
  sleep "$(python3 -c "import random; random.seed($i); print(random.uniform(0, 1.1e-6 * $took_us))")"
  kill -KILL $pid 2>/dev/null && met=$((met + 1))
  wait $pid 2>/dev/null || true
  for c in a b; do case_digest "$work/out/$c" >/dev/null || fail "kill $i: case $c is torn"; done
done
# In this test's own folder: beside it others build cases of the same names.
for try in {1..3000}; do
  left=
  for pid in $(pgrep -f "library job case\.[ab]\$|$work/out" || true); do
    [[ $(readlink /proc/$pid/cwd 2>/dev/null) != "$work"* ]] || left+=" $pid"
  done
  [[ -n $left ]] || break
  sleep 0.1
done
[[ -z $left ]] || { ps -fp $left; fail "processes are left"; }
build l.yaml
[[ $before == "$(digests)" ]] || fail "after $kills kills: other cases"
[[ -z $(find "$work/out" -name '.trephine-tmp-*') ]] || fail "kill: temporary files are left: $(find "$work/out" -name '.trephine-tmp-*')"
echo "killed $met of $kills"

# Ctrl-C: 130, soon, nothing left. The cache keeps nothing, so that there is work to interrupt.
interrupted "$TREPHINE" library build l.yaml --out "$work/out" --quiet --no-pictures --rebuild --cache-limit-mb 0 "${new[@]}"
[[ $code == 130 ]] || { cat "$work/said"; fail "Ctrl-C: $code"; }
[[ -z $(find "$work/out" -name '.trephine-tmp-*') ]] || fail "Ctrl-C: temporary files are left"
for c in a b; do case_digest "$work/out/$c" >/dev/null || fail "Ctrl-C: case $c is torn"; done

# A case beyond its time is stopped: 70, no process left.
code=0; build l.yaml --rebuild --case-limit-s 0.001 --case a --set skull.smooth.iterations_count=9 >said 2>&1 || code=$?
[[ $code == 70 ]] && grep -q 'time limit' said || { cat said; fail "time limit: $code"; }

# A library that cannot be written: refused before any work, but looked at.
as=()
if [[ $(id -u) == 0 ]]; then
  as=(setpriv --reuid 65534 --regid 65534 --clear-groups)
  chmod -R a+rX "$work"
fi
chmod -R a-w "$work/out"
if "${as[@]}" "$TREPHINE" --version >/dev/null 2>&1 && "${as[@]}" test -r "$work/l.yaml"; then
  expect 73 'not writable' "${as[@]}" "$TREPHINE" library build "$work/l.yaml" --out "$work/out"
  "${as[@]}" "$TREPHINE" library build "$work/l.yaml" --out "$work/out" --dry-run --quiet >said || fail "--dry-run of a read-only library"
  grep -q ' would be built' said || { cat said; fail "--dry-run of a read-only library says nothing"; }
  "${as[@]}" "$TREPHINE" library build "$work/l.yaml" --out "$work/out" --why a --quiet >said || fail "--why of a read-only library"
fi
echo ok
