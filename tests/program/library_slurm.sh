#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A library build by Slurm whose programs are played here: two tasks are lost and submitted again, one fails for good, the controller
# does not answer at first, and who submitted leaves and comes back. The cases are those of a build on this machine. The plans for
# other engines build the same. LongLibrary_slurm does it with a real Slurm.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/library_common.sh"
cd "$work/l"
export FAKE=$work/fake
mkdir -p "$FAKE/bin" "$FAKE/jobs"
cat >"$FAKE/bin/sbatch" <<'S'
#!/usr/bin/env bash
array= dependency=
for word; do
  case $word in
    --job-name=*) name=${word#*=} ;;
    --array=0-*) array=${word#--array=0-} ;;
    --dependency=afterany:*) dependency=${word#*afterany:} ;;
    -*) ;;
    *) script=$word ;;
  esac
done
if [[ " $* " == *" --partition=nopart "* || ( -e $FAKE/few && $(ls "$FAKE/jobs" | wc -l) -gt $(cat "$FAKE/few") ) ]]; then
  echo "sbatch: error: no such partition, or too many jobs" >&2
  exit 1
fi
if [[ -e $FAKE/down ]]; then
  rm "$FAKE/down"
  echo "sbatch: error: Batch job submission failed: Unable to contact slurm controller (connect failure)" >&2
  exit 1
fi
id=$(($(ls "$FAKE/jobs" | wc -l) + 1))
job=$FAKE/jobs/$id
mkdir -p "$job/tasks" "$job/ended"
echo "$*" >"$job/words"
echo "$name" >"$job/name"
for ((i = 0; i <= ${array:-0}; i++)); do touch "$job/tasks/$i"; done
cat >"$job/run" <<R
cd /
for before in ${dependency//:/ }; do until [[ -e $FAKE/jobs/\$before/done ]]; do sleep 0.05; done; done
for ((i = 0; i <= ${array:-0}; i++)); do
  while [[ -e $FAKE/held && ! -e $job/done ]]; do sleep 0.05; done
  [[ ! -e $job/done ]] || exit
  if [[ -n "$array" ]] && read -r left <$FAKE/lose && ((left > 0)); then
    echo \$((left - 1)) >$FAKE/lose
  elif [[ -n "$array" ]] && read -r how left <$FAKE/starve && ((left > 0)); then
    echo \$how \$((left - 1)) >$FAKE/starve
    echo \$how >$job/ended/\$i
  else
    [[ -z "$array" ]] || export SLURM_ARRAY_TASK_ID=\$i
    SLURMD_NODENAME=played sh "$script" >>$job/said 2>&1
  fi
  rm -f $job/tasks/\$i
done
touch $job/done
R
setsid bash "$job/run" </dev/null >/dev/null 2>&1 &
echo "sbatch: warning: something that a cluster says" >&2
echo "$id;played"
S
cat >"$FAKE/bin/squeue" <<'S'
#!/usr/bin/env bash
for word; do [[ $word != --name=* ]] || name=${word#*=}; done
touch "$FAKE/asked"
[[ ! -e $FAKE/silent ]] || { echo "slurm_load_jobs error: Unable to contact slurm controller (connect failure)" >&2; exit 1; }
for job in "$FAKE"/jobs/*/; do
  [[ $(cat "$job/name") == "$name" ]] || continue
  for task in "$job"/ended/*; do
    [[ ! -e $task || " $* " != *" --states=all "* ]] || echo "$(basename "$job")|$(basename "$task")|$(cat "$task")|played"
  done
  [[ ! -e $job/done ]] || continue
  for task in "$job"/tasks/*; do
    [[ -e $task ]] || continue
    index=$(basename "$task")
    [[ $(cat "$job/words") == *--array=* ]] || index=N/A
    how='RUNNING|played|None'
    [[ ! -e $FAKE/held ]] || how='PENDING||JobHeldUser'
    echo "$(basename "$job")|$index|$how"
  done
done
S
cat >"$FAKE/bin/scancel" <<'S'
#!/usr/bin/env bash
for job in "$FAKE"/jobs/*/; do [[ --name=$(cat "$job/name") != "$1" ]] || touch "$job/done"; done
S
printf '#!/bin/sh\necho "MaxArraySize            = 4"\n' >"$FAKE/bin/scontrol"
printf '#!/bin/sh\necho "Slurm accounting storage is disabled" >&2\nexit 1\n' >"$FAKE/bin/sacct"
chmod +x "$FAKE"/bin/*
echo 0 >"$FAKE/lose"
echo none 0 >"$FAKE/starve"
export PATH=$FAKE/bin:$PATH

"$TREPHINE" phantom "$work/l/DOE_1" $tiny_flags --seed 7 --quiet >/dev/null
"$TREPHINE" phantom "$work/l/DOE_2" $tiny_flags --seed 8 --quiet >/dev/null
cat >l.yaml <<Y
trephine: 1
config: c.yaml
engine: {name: slurm, account: lab, sbatch: [--qos=low], resubmissions_count: 2, classes: [{memory_mb: 9000, time_limit_s: 3000, partition: big}, {memory_mb: 1024, time_limit_s: 600}]}
cases:
  - {case: a, series: DOE_1/dicom}
  - {case: b, series: DOE_2/dicom}
  - {case: c, series: DOE_1/dicom, set: {skull.smooth.iterations_count: 2}}
  - {case: bad, series: DOE_2/dicom, set: {skull.segment.lower_hu: 3000}}
  - {case: e, series: DOE_2/dicom, set: {skull.smooth.iterations_count: 3}}
phantoms: {shared: {$tiny}, list: [{name: first, seed: 3}]}
Y
sleep 0.2
local_code=0
"$TREPHINE" library build l.yaml --engine ninja --out "$work/local" --quiet --no-pictures 2>/dev/null || local_code=$?
want=$(for c in "$work"/local/*/case.json; do c=${c%/case.json}; echo "${c##*/} $(case_digest "$c")"; done)
[[ $(wc -l <<<"$want") == 5 && $local_code == 80 ]] || fail "the local build: $local_code $want"

# Submitted, the first time in vain; the first two tasks are lost as a node's that dies.
touch "$FAKE/down" "$FAKE/held"  # held: the batch does not end before the next build has joined it, however long that takes
echo 2 >"$FAKE/lose"
build l.yaml --no-wait >said 2>&1 || fail "not submitted: $(cat said)"
expect 75 'a cluster works on this library' "$TREPHINE" library build l.yaml --engine ninja --out "$work/out" --quiet
words=$(cat "$FAKE"/jobs/*/words)
for word in --account=lab --qos=low --mem=1024M --time=13 --no-requeue --dependency=afterany:; do
  grep -q -- "$word" <<<"$words" || fail "sbatch was not told $word: $words"
done
! grep -q 'DOE\|big' <<<"$words" || fail "sbatch was told: $words"
[[ $(stat -c %a "$work"/out/.library/slurm/*/jobs.jsonl) == 600 ]] || fail "others may read the jobs' words"
# A controller that does not answer is said, and waited for.
touch "$FAKE/silent"
"$TREPHINE" library status "$work/out" --json status.json >said
grep -q 'does not answer' said || fail "status: $(cat said)"
rm "$FAKE/silent"
rm "$FAKE/asked"
build l.yaml --json built.json >said 2>&1 & builder=$!
until [[ -e $FAKE/asked ]] || ! kill -0 $builder 2>/dev/null; do sleep 0.05; done
rm "$FAKE/held"
code=0
wait $builder || code=$?
[[ $code == 80 ]] || { cat said; "$TREPHINE" library status "$work/out"; cat "$FAKE"/jobs/*/said; fail "exit code $code"; }
have=$(digests)
[[ $have == "$want" ]] || fail "other cases: $(diff <(echo "$want") <(echo "$have"))"
"$TREPHINE" library verify "$work/out" --quiet >/dev/null
[[ -s $work/out/index.html ]] || fail "no index"
! compgen -G "$work/out/.library/slurm/*/*.jsonl" >/dev/null || fail "words of jobs are left"
! grep -rl DOE_ "$work/out" --exclude-dir=.trephine-cache || fail "a series' folder is told"
[[ -e $work/out/a/.lease/free ]] || fail "a case was published without a lease"
python3 - "$work"/out/.library/slurm/*/batch.json status.json <<'PY'
import json, sys
batch, status = (json.load(open(f)) for f in sys.argv[1:])
tries = sorted(j["tries"] for j in batch["jobs"])
assert batch["finished"] and tries == [1, 1, 1, 1, 1, 2, 2] or tries == [1, 1, 1, 1, 2, 2, 2], tries  # the lost phantom's case too
assert all(len(a["names"]) <= 4 for a in batch["arrays"]), batch["arrays"]
assert not status["answers"], status
PY
"$TREPHINE" library status "$work/out" --config l.yaml >said
grep -q 'case.bad .*failed .*80' said && grep -q 'case.bad .*stale' said || fail "status: $(cat said)"
"$TREPHINE" library timeline "$work/out" --output t.svg
grep -q '<title>case\.[a-z]*: .* s; [a-z]' t.svg && python3 -c 'import xml.dom.minidom; xml.dom.minidom.parse("t.svg")' || fail "timeline"

# One scan that is gone stops no other case.
cp l.yaml all.yaml
sed -i '/case: bad/d' l.yaml
sed 's|case: b, series: DOE_2|case: b, series: gone|' l.yaml >gone.yaml
"$TREPHINE" library plan gone.yaml --out "$work/out" --no-pictures --rebuild --format json >plan.json 2>said || fail "a plan with a scan that is gone: $(cat said)"
grep -q 'warning: b: .*no such file' said || fail "which scan is gone: $(cat said)"
python3 - <<'PY'
import json
jobs = {j["name"]: j for j in json.load(open("plan.json"))["jobs"]}
assert {"case.a", "case.b", "case.c", "case.e"} <= set(jobs) and jobs["case.c"]["after"] == ["case.a"], jobs
PY
expect 66 'no such file' "$TREPHINE" library one gone.yaml --out "$work/out" case.b --quiet
expect 64 'no such job' "$TREPHINE" library one l.yaml --out "$work/out" phantom.other --quiet
"$TREPHINE" library list "$work/out" --metrics >metrics
grep -qx 'trephine_library_cases{state="published"} 5' metrics && grep -q '^trephine_stage_seconds{stage="skull.segment"} ' metrics || fail "metrics: $(cat metrics)"
python3 - <<'PY'
import re
for line in open("metrics"):
    assert re.fullmatch(r'# (HELP \w+ .*|TYPE \w+ gauge)|\w+(\{\w+="[^"]*"\})? -?[0-9.e+-]+', line.rstrip("\n")), line
PY
# Lines as objects, and levels.
"$TREPHINE" library build l.yaml --out "$work/out" --rebuild --engine ninja --no-pictures --json-log >/dev/null 2>lines
python3 - <<'PY'
import json
lines = [json.loads(line) for line in open("lines")]
assert any(l["text"].startswith("a: ") for l in lines) and all(set(l) == {"time", "level", "program", "text"} for l in lines), lines
assert {l["program"] for l in lines} == {"trephine library build"}, lines
PY
"$TREPHINE" library build l.yaml --out "$work/out" --rebuild --engine ninja --no-pictures --log-level warning >/dev/null 2>lines
[[ ! -s lines ]] || fail "lines below their level: $(cat lines)"
"$TREPHINE" library verify /nowhere --json-log 2>lines && fail "verify" || true
python3 -c 'import json; l = json.loads(open("lines").read()); assert "nowhere" in l["text"]' || fail "$(cat lines)"
cp all.yaml l.yaml

long_only

# What Slurm ended for want of memory or time gets the next class that grants more of it, until there is none.
submitted() { ls "$FAKE/jobs" | wc -l; }
words_since() { for ((n = $1 + 1; n <= $(submitted); n++)); do cat "$FAKE/jobs/$n/words"; done; }
first=$(ls "$work/out/.library/slurm")
before=$(submitted)
echo OUT_OF_MEMORY 1 >"$FAKE/starve"
again() { "$TREPHINE" library build l.yaml --case a --out "$work/out" --no-pictures >said 2>&1; }
rm -r "$work/out/a"
again || { cat said; fail "a case that lacked memory once"; }
grep -qh 'case.a: took more than the 1024 MB that Slurm grants it; again with 9000 MB, 3000 s' "$FAKE"/jobs/*/said said ||
  fail "the larger class is not told: $(cat said "$FAKE"/jobs/*/said | tail)"
grep -e '--mem=9000M' <<<"$(words_since "$before")" | grep -e '--time=53' | grep -e '--partition=big' >/dev/null || fail "no larger class: $(words_since "$before")"
[[ $(case_digest "$work/out/a") == "$(grep '^a ' <<<"$want" | cut -d' ' -f2-)" ]] || fail "another case a"
echo TIMEOUT 9 >"$FAKE/starve"
rm -r "$work/out/a"
code=0
again || code=$?
[[ $code == 70 ]] && grep -q '^a *70  took more than the 3000 s that Slurm grants it, in 2 tries; no class of the engine grants more' said ||
  fail "no class grants more: $code $(cat said)"
[[ $(cat "$FAKE/starve") == 'TIMEOUT 7' ]] || fail "tried otherwise than twice: $(cat "$FAKE/starve")"
[[ ! -e $work/out/a/case.json ]] || fail "a case that was never built is there"
echo none 0 >"$FAKE/starve"
again || { cat said; fail "a case that failed for want of time is not built again"; }
for batch in "$work"/out/.library/slurm/*; do [[ $batch == */$first ]] || rm -r "$batch"; done

# What sbatch refuses leaves nothing behind: put right, the same command builds. Of a user who may have few jobs at once the rest follows.
sed 's/account: lab/partition: nopart/' l.yaml >nopart.yaml
code=0
"$TREPHINE" library build nopart.yaml --case b --out "$work/out" --no-pictures --rebuild >said 2>&1 || code=$?
[[ $code == 70 ]] && grep -q 'refused the jobs: .*no such partition' said || fail "a partition that is none: $code $(cat said)"
"$TREPHINE" library status "$work/out" >said
grep -q 'no cluster works' said || fail "a refused batch is left open: $(cat said)"
before=$(submitted)
"$TREPHINE" library build l.yaml --case b --out "$work/out" --no-pictures --rebuild >said 2>&1 || { cat said; fail "the partition put right"; }
! grep -q nopart <<<"$(words_since "$before")" || fail "the options of before: $(words_since "$before")"
submitted >"$FAKE/few"
"$TREPHINE" library build l.yaml --case a --case b --case c --case e --out "$work/out" --no-pictures --no-wait --rebuild >said 2>&1 && grep -q 'the rest is submitted when' said ||
  fail "too many jobs: $(cat said)"
rm "$FAKE/few"
"$TREPHINE" library build l.yaml --out "$work/out" --case a --case b --case c --case e --no-pictures >said 2>&1 || { cat said; fail "the rest of them"; }
[[ $(digests) == "$want" ]] || fail "after refusals: $(diff <(echo "$want") <(digests))"
for option in -qlow -Jmine --arr=0-2 --wait --mem=1M --clusters=other --partition=mine; do
  sed "s/--qos=low/$option/" l.yaml >option.yaml
  expect 78 "engine.sbatch\[0\]: $option" "$TREPHINE" library build option.yaml --out "$work/out" --no-pictures --quiet
done
for batch in "$work"/out/.library/slurm/*; do [[ $batch == */$first ]] || rm -r "$batch"; done

# A batch that is cancelled is no hindrance any more.
touch "$FAKE/held"  # so none of its jobs begins, however long the submission takes
build l.yaml --no-wait --rebuild >/dev/null 2>&1
grep -q 'case.a .*waits .*JobHeldUser' <<<"$("$TREPHINE" library status "$work/out")" || fail "why it waits: $("$TREPHINE" library status "$work/out")"
"$TREPHINE" library cancel "$work/out" | grep -q '1 batch cancelled' || fail "cancel"
rm "$FAKE/held"
"$TREPHINE" library status "$work/out" >said
grep -q 'no cluster works' said || fail "status after cancel: $(cat said)"
until [[ -z $(pgrep -f "$FAKE/jobs" || true) ]]; do sleep 0.1; done

# gc removes batches an hour after they ended, and none that is open.
mapfile -t batches < <(ls -d "$work"/out/.library/slurm/*/)
[[ ${#batches[@]} == 2 ]] || fail "batches: ${batches[*]}"
"$TREPHINE" library gc "$work/out" | grep -q ' 0 ended batches' || fail "gc removes a batch that ended just now"
touch -d '2 hours ago' "${batches[0]}batch.json" "${batches[1]}batch.json"
rm "${batches[1]}cancelled"  # as if it were open
touch -d '2 hours ago' "${batches[1]}batch.json"
mkdir "$work/out/.library/slurm/broken"  # a submission that was broken off before it had a batch.json
echo '{}' >"$work/out/.library/slurm/broken/jobs.jsonl"
touch -d '2 hours ago' "$work/out/.library/slurm/broken"
"$TREPHINE" library gc "$work/out" --dry-run | grep -q ' 2 ended batches' || fail "gc --dry-run does not count them"
[[ -e ${batches[0]} ]] || fail "gc --dry-run removes a batch"
"$TREPHINE" library gc "$work/out" | grep -q ' 2 ended batches' || fail "gc does not count them"
[[ ! -e ${batches[0]} && ! -e $work/out/.library/slurm/broken && -e ${batches[1]}batch.json ]] || fail "gc: $(ls "$work/out/.library/slurm")"
"$TREPHINE" library verify "$work/out" --quiet >/dev/null

# The same by the plans for other engines.
sed -i '/case: bad/d' l.yaml
want=$(grep -v '^bad ' <<<"$want")
for format in ninja make; do
  rm -rf "$work/out"
  "$TREPHINE" library plan l.yaml --out "$work/out" --no-pictures --format $format --output plan.$format --quiet
  ! grep -q DOE_ plan.$format || fail "the plan tells a series' folder"
  if [[ $format == ninja ]]; then ninja -f plan.ninja -j 2 >said 2>&1; else make -f plan.make -j 2 >said 2>&1; fi || { cat said; fail "$format"; }
  [[ $(digests) == "$want" ]] || fail "$format: $(digests)"
  "$TREPHINE" library plan l.yaml --out "$work/out" --no-pictures --quiet >plan.json
  python3 -c 'import json; assert json.load(open("plan.json"))["jobs"] == []' || fail "a plan of nothing: $(cat plan.json)"
done
echo ok
