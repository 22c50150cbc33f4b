#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A thousand tiny cases of ten series: built, then found up to date in less than three seconds, one of them stale after a change.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/library_common.sh"
cd "$work/l"
for n in {0..9}; do "$TREPHINE" phantom "$work/l/s$n" $tiny_flags --seed "$n" --quiet >/dev/null; done
{
  printf 'trephine: 1\nconfig: c.yaml\ncases:\n'
  for n in {0..999}; do echo "  - {case: c$n, series: s$((n % 10))/dicom, set: {skull.smooth.iterations_count: $((1 + n % 3))}}"; done
} >l.yaml
sleep 0.2
build l.yaml --json first.json
python3 - "$TREPHINE" "$work/out" <<'PY'
import json, os, resource, subprocess, sys, time
first = json.load(open("first.json"))
assert first["built"] == 1000, first["failures"]
print(f"1,000 cases: {first['wall_s']:.0f} s, {sum(j['cpu_s'] for j in first['jobs'].values()):.0f} s CPU, {first['jobs_at_once']} at once")
def build(*more):
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.time()
    table = subprocess.run([sys.argv[1], "library", "build", "l.yaml", "--out", sys.argv[2], "--no-pictures", *more], check=True,
                           stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return table, time.time() - start, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
table, wall, cpu = build()
print(f"nothing to do: {wall:.2f} s, {cpu:.2f} s CPU")
assert table.startswith("1000 cases: 0 built, 1000 as they were"), table
assert cpu < 3 and (wall < 3 or os.getloadavg()[0] > os.cpu_count()), (wall, cpu)
text = open("l.yaml").read()
open("l.yaml", "w").write(text.replace("case: c517, series: s7/dicom, set: {skull.smooth.iterations_count: 2}",
                                       "case: c517, series: s7/dicom, set: {skull.smooth.iterations_count: 6}"))
table, wall, cpu = build("--dry-run")
assert table.startswith("1 of 1000 cases would be built") and "c517: skull.smooth.iterations_count: 6, was 2" in table, table[:400]
table, wall, cpu = build()
print(f"one stale: {wall:.2f} s, {cpu:.2f} s CPU")
assert table.startswith("1000 cases: 1 built, 999 as they were"), table
PY
"$TREPHINE" library verify "$work/out" --quiet
echo ok
