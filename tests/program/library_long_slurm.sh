#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A real Slurm of two nodes builds 40 tiny cases while a node dies, a task is killed, the controller is restarted and the library's
# disk is full for a while: at the end all are there, byte for byte as a build on this machine makes them.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/library_common.sh"
. "$(dirname "$0")/slurm_cluster.sh"
cd "$work/l"
cases=${CASES:-40}
for n in {0..7}; do "$TREPHINE" phantom "$work/l/DOE_$n" $tiny_flags --seed "$n" --quiet >/dev/null; done
{
  printf 'trephine: 1\nconfig: c.yaml\nengine: {name: slurm, partition: all, lease_s: 20, resubmissions_count: 5, sbatch: [--nice=0]}\ncases:\n'
  for ((n = 0; n < cases; n++)); do
    echo "  - {case: c$n, series: DOE_$((n % 8))/dicom, set: {skull.smooth.iterations_count: $((1 + n / 8))}}"
  done
} >l.yaml
sleep 0.2
# What it shall become: the same with Ninja.
"$TREPHINE" library build l.yaml --engine ninja --out "$work/local" --quiet --no-pictures
want=$(for c in "$work"/local/*/case.json; do c=${c%/case.json}; echo "${c##*/} $(case_digest "$c")"; done)
[[ $(wc -l <<<"$want") == "$cases" ]] || fail "the local build"

cluster_start
sbatch --version
mkdir -p "$work/out"
mount -t tmpfs -o size=400m tmpfs "$work/out" 2>/dev/null && disk=1 || { disk=0; echo "no tmpfs can be mounted: the full disk is left out"; }
"$TREPHINE" library build l.yaml --out "$work/out" --no-pictures --no-wait | tee said
grep -q "$cases on the cluster" said || fail "not submitted"
batch=$(ls -d "$work"/out/.library/slurm/*)
[[ $(stat -c %a "$batch/jobs.jsonl") == 600 && $(stat -c %a "$batch") == 700 ]] || fail "others may read the words of the jobs"
expect 75 'a cluster works on this library' "$TREPHINE" library build l.yaml --engine ninja --out "$work/out" --quiet --no-pictures
# No word of any process is a series' path.
watch_words() { while :; do cat /proc/[0-9]*/cmdline 2>/dev/null | tr '\0' '\n' | grep -a 'D[O]E_' >>"$work/told" || true; sleep 0.05; done; }
watch_words & watcher=$!
trap 'set +e; kill $watcher 2>/dev/null; cluster_stop; umount "$work/out" 2>/dev/null; rm -rf "$work"' EXIT

built() { ls "$batch"/ended 2>/dev/null | wc -l; }
until_true 300 bash -c "[[ \$(ls '$batch/begun' | wc -l) -ge 2 ]]" || fail "nothing began: $(squeue; cat "$batch"/*.log)"
"$TREPHINE" library status "$work/out" | head -3
# A task is killed: its whole job, as the kernel does that lacks memory.
until_true 300 pgrep -f "library task $batch" && pid=$(pgrep -f "library task $batch" | head -1) && kill_tree "$pid"
echo "killed a task, $(built) ended"
# A node dies, and comes back later.
until_true 300 bash -c "[[ \$(ls '$batch/ended' | wc -l) -ge 6 ]]"
node_kill n2
echo "node n2 died, $(built) ended"
until_true 300 bash -c "[[ \$(ls '$batch/ended' | wc -l) -ge 12 ]]" || fail "stuck: $(squeue; "$TREPHINE" library status "$work/out")"
# The controller is restarted; meanwhile status says that it does not answer.
controller_stop
"$TREPHINE" library status "$work/out" | grep -q 'does not answer' || fail "status without a controller"
sleep 2
controller_start
echo "controller restarted, $(built) ended"
node_start n2
# The disk is full for a while.
if ((disk)); then
  until_true 300 bash -c "[[ \$(ls '$batch/ended' | wc -l) -ge 16 ]]" || fail "stuck: $(squeue)"
  dd if=/dev/zero of="$work/out/.filler" bs=4k 2>/dev/null || true
  echo "disk full, $(built) ended"
  sleep 3
  rm "$work/out/.filler"
fi
# Who submitted it comes back: the build stays until all is done, and submits again what was lost.
"$TREPHINE" library build l.yaml --out "$work/out" --no-pictures >again 2>&1 || { cat again; "$TREPHINE" library status "$work/out"; tail "$batch"/*.log; fail "the build that went on"; }
cat again
kill $watcher
[[ ! -s $work/told ]] || fail "a process was given a series' path: $(sort -u "$work/told" | head -3)"
have=$(for c in "$work"/out/*/case.json; do c=${c%/case.json}; echo "${c##*/} $(case_digest "$c")"; done)
[[ $have == "$want" ]] || fail "other cases: $(diff <(echo "$want") <(echo "$have"))"
"$TREPHINE" library verify "$work/out" --quiet
[[ -s $work/out/index.html ]] || fail "no index"
"$TREPHINE" library status "$work/out" | tee said
grep -q 'no cluster works' said || fail "a batch is left open"
! compgen -G "$work/out/.library/slurm/*/*.jsonl" >/dev/null || fail "words of jobs are left"
! grep -rl DOE_ "$work/out" --exclude-dir=.trephine-cache || fail "a series' folder is told"
python3 - "$work"/out/.library/slurm/*/batch.json <<'PY'
import json, sys
tries = [j["tries"] for f in sys.argv[1:] for j in json.load(open(f))["jobs"]]
print(f"{len(tries)} jobs, {sum(tries)} submissions, at most {max(tries)} of one")
assert max(tries) > 1, "nothing was ever lost: the test shows nothing"
PY
"$TREPHINE" library timeline "$work/out" --output "$work/timeline.svg"
[[ -z ${KEEP:-} ]] || cp "$work/timeline.svg" "$KEEP"
# Nothing to do: nothing is submitted. One parameter of one case changed: one task.
"$TREPHINE" library build l.yaml --out "$work/out" --no-pictures 2>/dev/null | grep -q "^$cases cases: 0 built" || fail "not up to date"
sed -i 's/case: c3, \(.*\)count: 1/case: c3, \1count: 9/' l.yaml
"$TREPHINE" library build l.yaml --out "$work/out" --no-pictures 2>/dev/null | grep -q "^$cases cases: 1 built" || fail "one stale case"
# Cancelled: published cases stay.
before=$(case_digest "$work/out/c5")
"$TREPHINE" library build l.yaml --out "$work/out" --no-pictures --no-wait --rebuild >/dev/null
"$TREPHINE" library cancel "$work/out"
until_true 60 bash -c '[[ -z $(squeue -h) ]]'
[[ $(case_digest "$work/out/c5") == "$before" ]] || fail "cancelling changed a case"
"$TREPHINE" library verify "$work/out" --quiet
# What a task of a build costs beside the bare command and `srun true` in arrays of the same size and memory: OVERHEAD=1000.
if [[ -n ${OVERHEAD:-} ]]; then
  seconds_of() {
    local start
    start=$(date +%s.%N)
    "${@:2}" >/dev/null
    python3 -c "import sys; n, a, b = map(float, sys.argv[2:]); print(f'{int(n)} tasks of {sys.argv[1]}: {(b - a) / n:.3f} s a task')" \
      "$1" "$OVERHEAD" "$start" "$(date +%s.%N)"
  }
  bare() {
    printf '#!/bin/sh\n%s\n' "$1" >"$work/job.sh"
    sbatch --wait --array="0-$((OVERHEAD - 1))" --mem=256 --output=/dev/null "$work/job.sh"
  }
  {
    printf 'trephine: 1\nconfig: c.yaml\nengine: {name: slurm, partition: all}\ncases:\n'
    for ((n = 0; n < OVERHEAD; n++)); do
      echo "  - {case: o$n, series: DOE_$((n % 8))/dicom, set: {skull.smooth.iterations_count: $((1 + n / 8))}}"
    done
  } >o.yaml
  seconds_of 'true' bare true
  seconds_of 'srun -n1 true' bare 'srun -n1 true'
  run="$TREPHINE run $work/l/c.yaml --series $work/l/DOE_1/dicom --case o --out \$(mktemp -d) --quiet --no-pictures --no-page --threads 1"
  seconds_of 'trephine run' bare "$run"
  seconds_of 'library build' "$TREPHINE" library build o.yaml --out "$work/overhead" --no-pictures
fi
echo ok
