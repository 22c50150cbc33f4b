#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The sample library: 15 phantoms as 30 cases, at 256 x 256 x 96, or as SIZE says (SIZE= for the size that it declares); each of
# its patient's class, the work spread over all places, a second build that does nothing, and one parameter of one anatomy that
# makes only that anatomy anew. KEEP names a folder in which to build it, and to find it afterwards.
. "$(dirname "$0")/common.sh"
out=${KEEP:-$work/out}
size=${SIZE-columns_count=256 rows_count=256 slices_count=96 slice_step_mm=2 slice_thickness_mm=2}
flags=()
for s in $size; do flags+=(--phantom "$s"); done
build() { "$TREPHINE" library build "$SOURCE/configs/library.yaml" --out "$out" --quiet "${flags[@]}" "$@"; }

build --json "$work/first.json" || fail "the build"
"$TREPHINE" library list "$out" --json "$work/list.json"
python3 - "$work/first.json" "$work/list.json" <<'PY'
import json, sys
built, cases = (json.load(open(f)) for f in sys.argv[1:])
assert built["failed"] == 0 and built["built"] + built["fresh"] == 30, built["failures"]
assert len(cases) == 30 and not any("fault" in c for c in cases)
for c in cases:
    variant = c["case"].rsplit("-", 2)[0]
    if c["class"] != variant:
        print(f"{c['case']}: found {c['class']}")
wrong = sum(c["class"] != c["case"].rsplit("-", 2)[0] for c in cases)
assert wrong <= 2, f"{wrong} cases are of another class than their phantom"
assert all(c["burr_holes_count"] == (1 if c["case"].endswith("drilled") else 0) for c in cases)
jobs = built["jobs"].values()
if len(jobs) == 45:
    work, cpu = sum(j["seconds"] for j in jobs), sum(j["cpu_s"] for j in jobs)
    used = work / (built["jobs_at_once"] * built["wall_s"])
    print(f"{built['wall_s']:.0f} s, {cpu:.0f} s CPU, {built['jobs_at_once']} at once, {100 * used:.0f} % of the places at work")
    assert used >= 0.85, used
PY

# Nothing to do: under a second, where the machine does nothing else.
python3 - "$TREPHINE" "$SOURCE/configs/library.yaml" "$out" "${flags[@]}" <<'PY'
import os, resource, subprocess, sys, time
start = time.time()
table = subprocess.run([sys.argv[1], "library", "build", sys.argv[2], "--out", sys.argv[3], *sys.argv[4:]],
                       check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
wall = time.time() - start
usage = resource.getrusage(resource.RUSAGE_CHILDREN)
cpu = usage.ru_utime + usage.ru_stime
print(f"nothing to do: {wall:.2f} s, {cpu:.2f} s CPU; {table.strip()}")
assert table.startswith("30 cases: 0 built, 30 as they were"), table
assert cpu < 1 and (wall < 1 or os.getloadavg()[0] > os.cpu_count()), (wall, cpu)
PY

# One parameter of one anatomy: only its surface and its picture are other files, and beside its stages and the comparison of what is
# felt with what is seen nothing is computed but what is made again faster than it is read.
surfaces() { python3 - "$out" <<'PY'
import json, pathlib, sys
for case in sorted(pathlib.Path(sys.argv[1]).glob("*/case.json")):
    manifest = json.load(open(case))
    for a in manifest["anatomies"]:
        print(case.parent.name, a["name"], a.get("file"))
    print(case.parent.name, "haptic", manifest["haptic"]["file"])
PY
}
surfaces >"$work/surfaces"
build --set ventricles.smooth.iterations_count=7 --json "$work/changed.json"
python3 - "$work/changed.json" "$out" <<'PY'
import collections, json, pathlib, sys
built = json.load(open(sys.argv[1]))
assert built["built"] == 30 and built["failed"] == 0, built["failures"]
cases = collections.Counter()
for run in pathlib.Path(sys.argv[2]).glob("*/run.json"):
    stages = {name: s["seconds"] for name, s in json.load(open(run))["stages"].items() if s["state"] == "computed"}
    again = {n: s for n, s in stages.items() if not n.startswith("ventricles.") and n != "haptic.mismatch"}
    assert set(again) <= {"import", "skin.normals", "brain.normals"}, (run, again)
    cases.update(stages)
print(f"one parameter of the ventricles in 30 cases: {built['wall_s']:.0f} s; computed in so many cases:", dict(cases))
PY
surfaces | diff "$work/surfaces" - | grep '^>' | cut -d' ' -f3 | sort | uniq -c >"$work/moved" || true
[[ $(cat "$work/moved") =~ ^\ *30\ ventricles$ ]] || fail "other files than the ventricles': $(cat "$work/moved")"
build --json "$work/back.json"

"$TREPHINE" library verify "$out" --quiet
"$TREPHINE" library gc "$out" --dry-run
[[ -s $out/index.html && -s $out/contact_sheet.png ]] || fail "no contact sheet"
"$TREPHINE" library list "$out"
echo ok
