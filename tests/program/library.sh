#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A library is built, and built again: only what is stale, for the reason that --why tells; a bad case stops no other and
# keeps its last good state; damage is found; nothing that somebody names is removed.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/library_common.sh"
cd "$work/l"
"$TREPHINE" phantom "$work/l/one" $tiny_flags --seed 7 --quiet >/dev/null
mkdir scans
mv one/dicom scans/a
cp -r scans/a scans/copy
cat >l.yaml <<Y
trephine: 1
config: c.yaml
cases: [{case: listed, series: scans/a, set: {skull.smooth.iterations_count: 3}}]
series: [found/*]
phantoms: {shared: {$tiny}, list: [{name: first, seed: 3}, {name: second, variant: small, seed: 4}]}
Y
mkdir found
"$TREPHINE" phantom "$work/l/two" $tiny_flags --seed 8 --quiet >/dev/null
mv two/dicom found/DOE_JOHN
cp -r found/DOE_JOHN found/again

sleep 0.2  # files that changed just now are not trusted
# Nothing is written by a dry run.
build l.yaml --dry-run >said 2>&1
grep -q '^4 of 4 cases would be built' said || { cat said; fail "dry run"; }
[[ ! -e $work/out ]] || fail "a dry run wrote something"

build l.yaml --json first.json 2>said || { cat said; cat "$work"/out/.library/logs/*; fail "the first build"; }
grep -q 'left out' said || fail "the series that is there twice is not told"
before=$(digests)
[[ $(wc -l <<<"$before") == 4 ]] || fail "cases: $before"
! grep -rlE "DOE|JOHN|scans" "$work/out" --include='*.json' --include='*.log' --include='*.html' --include=build.ninja || fail "a folder's name is told"
[[ -s $work/out/index.html && -s $work/out/contact_sheet.png ]] || fail "no contact sheet"
grep -q "default-src 'none'" "$work/out/index.html" || fail "the list may fetch something"
[[ $(stat -c %a "$work/out/.library") == 700 ]] || fail "mode of .library"

# Nothing changed: nothing is built, and no file of the library changes.
stamp() { (cd "$work/out" && find . -type f -not -name .lock -printf '%p %T@ %i\n' | sort); }
files=$(stamp)
build l.yaml --json again.json 2>/dev/null
python3 - first.json again.json <<'PY'
import json, sys
first, again = (json.load(open(f)) for f in sys.argv[1:])
assert first["built"] == 4 and first["failed"] == 0, first
assert again["built"] == 0 and again["fresh"] == 4 and not again["jobs"], again
PY
[[ $files == "$(stamp)" ]] || fail "a build with nothing to do wrote: $(diff <(echo "$files") <(stamp))"

# A byte is changed and the file's time restored: its ctime tells. Then the memory is made to say another content of the same
# files, as if ctime had been restored too: --rehash reads them.
slice=$(ls scans/a/* | sed -n 5p)
touch -r "$slice" "$work/time"
cp -p "$slice" "$work/slice"
python3 - "$slice" <<'PY'
import sys
with open(sys.argv[1], "r+b") as f:
    b = f.read()
    at = b.find(b"\x28\x00\x52\x10")  # RescaleIntercept: -1024 becomes -1023
    at = b.find(b"-1024", at)
    assert at > 0
    f.seek(at); f.write(b"-1023")
PY
touch -r "$work/time" "$slice"
[[ $(build l.yaml --why listed | tail -1) == *"its series changed"* ]] || fail "a changed byte: $(build l.yaml --why listed)"
build l.yaml 2>/dev/null
changed=$(digests)
[[ $(diff <(echo "$before") <(echo "$changed") | grep -c '^>') == 1 ]] || fail "a changed byte changed: $changed"
cp -p "$work/slice" "$slice"
build l.yaml 2>/dev/null
[[ $before == "$(digests)" ]] || fail "the restored series gives other cases"
python3 - "$work/out/.library/series.json" <<'PY'
import hashlib, json, sys
j = json.load(open(sys.argv[1]))
for key, value in j["series"].items():
    value[0] = "0" * 64
j["checksum"] = hashlib.sha256(json.dumps(j["series"], separators=(",", ":"), sort_keys=True).encode()).hexdigest()
json.dump(j, open(sys.argv[1], "w"))
PY
build l.yaml --dry-run | grep -q '^[1-4] of' || fail "the memory of series is not used"
build l.yaml --rehash --json rehash.json
python3 -c 'import json; j = json.load(open("rehash.json")); assert j["fresh"] == 4, j'

# One parameter of every case, and of one; comments do not count; a stage that does not depend on it stays.
sed -i '1i # a comment' s.yaml p.yaml
build l.yaml --dry-run | grep -q '^0 of 4' || fail "a comment makes cases stale"
build l.yaml --set skull.smooth.iterations_count=4 --why first >said
grep -q 'skull.smooth.iterations_count: 4, was ' said || { cat said; fail "--why"; }
build l.yaml --set skull.smooth.iterations_count=4 2>/dev/null
[[ $(diff <(echo "$before") <(digests) | grep -c '^>') == 4 ]] || fail "a parameter of every case"
build l.yaml
[[ $before == "$(digests)" ]] || fail "set and set back gives other cases"

# One bad case: the others are built, it keeps its last good state, the summary names it.
printf 'x' >"$slice"
code=0; build l.yaml --set skull.smooth.iterations_count=5 --json bad.json 2>said || code=$?
[[ $code == 65 ]] || { cat said; fail "a bad case ends with $code"; }
grep -q 'listed *65 ' said || { cat said; fail "the bad case is not named"; }
! grep -qE 'listed *65 .*(trephine run|listed:)' said || { cat said; fail "the reason holds who gives it"; }
[[ -z $(find "$work/out/.library" -name '*.status') ]] || fail "a job that has ended is still at work"
[[ $(grep '^listed' <<<"$before") == "$(digests | grep '^listed')" ]] || fail "the bad case lost its last good state"
[[ $(diff <(echo "$before") <(digests) | grep -c '^>') == 3 ]] || fail "the others were not built"
"$TREPHINE" library list "$work/out" --failed | grep -q '^listed .*65' || fail "list --failed"
cp -p "$work/slice" "$slice"
build l.yaml
[[ $before == "$(digests)" ]] || fail "not as before"
! "$TREPHINE" library list "$work/out" --failed | grep -q '^listed' || fail "a mended case still counts as failed"

# Who starts a run reads how far it is, and why it ended, as values.
status() { TREPHINE_JOB_STATUS=$work/status "$TREPHINE" run c.yaml --out "$work/alone" --case one --quiet "$@" 2>/dev/null; }
status --series scans/a
python3 - "$work/status" <<'PY'
import json, sys
s = json.load(open(sys.argv[1]))
assert 0 <= s["fraction"] < 1 and not s["errors"] and not s["out_of_memory"], s
assert all(0 <= t["fraction"] <= 1 and t["name"] for t in s["stages"]), s
PY
! status --series scans/a --set skull.decimate.max_triangles=1 || fail "a skull of one triangle"
python3 - "$work/status" <<'PY'
import json, sys
s = json.load(open(sys.argv[1]))
assert len(s["errors"]) == 1 and "max_triangles" in s["errors"][0], s
assert "one:" not in s["errors"][0] and "trephine" not in s["errors"][0], s
PY

# What is missing or damaged is built again; what only its bytes tell is for verify.
rm "$work/out/first/case.json"
rm "$work"/out/second/meshes/*
build l.yaml --dry-run >said
grep -q 'first: case.json is missing' said && grep -q 'second: meshes/skull.* is missing' said || { cat said; fail "missing files"; }
build l.yaml
[[ $before == "$(digests)" ]] || fail "missing files are not made again"
"$TREPHINE" library verify "$work/out" --quiet | grep -q '^4 cases, 8 files' || fail "verify"
mesh=$(ls "$work"/out/first/meshes/*)
printf '\377' | dd of="$mesh" bs=1 seek=2000 conv=notrunc status=none
code=0; "$TREPHINE" library verify "$work/out" --quiet >said || code=$?
[[ $code == 65 ]] && grep -q '^first  first/meshes/skull.*checksum' said || { cat said; fail "verify of a damaged case: $code"; }
build l.yaml --rebuild --case first
[[ $before == "$(digests)" ]] || fail "a damaged file is not made again"

# Everything that a build remembers is lost, or damaged: the cases are as before.
for f in $(find "$work/out/.library" -name '*.json'); do head -c 20 "$f" >"$f.x" && mv "$f.x" "$f"; done
build l.yaml
[[ $before == "$(digests)" ]] || fail "a damaged memory changed a case"
rm -rf "$work/out/.library"
build l.yaml
[[ $before == "$(digests)" ]] || fail "a lost memory changed a case"

# A damaged cache is no cache: every entry loses a byte, or its end.
n=0
for f in "$work"/out/.trephine-cache/*; do
  n=$((n + 1)) size=$(stat -c %s "$f")
  if ((n % 2)); then printf '\252' | dd of="$f" bs=1 seek=$((size / 2)) conv=notrunc status=none; else truncate -s $((size / 2)) "$f"; fi
done
((n > 10)) || fail "there is no cache to damage"
build l.yaml --rebuild
[[ $before == "$(digests)" ]] || fail "a damaged cache changed a case"

# gc: what no case.json names, and nothing else.
touch "$work/out/first/meshes/skull-0123456789abcdef.glb" "$work/out/first/notes.txt" "$work/out/.trephine-tmp-999999-1-x"
mkdir -p "$work/out/killed/meshes" && touch "$work/out/killed/.lock"
mkdir "$work/out/mine" && touch "$work/out/mine/letter.txt"
"$TREPHINE" library gc "$work/out" --dry-run | grep -q '^would remove 1 files of cases, 1 folders' || fail "gc --dry-run"
[[ -e $work/out/killed ]] || fail "gc --dry-run removed something"
"$TREPHINE" library gc "$work/out" | grep -q '^removed 1 files of cases, 1 folders' || fail "gc"
[[ ! -e $work/out/killed && ! -e $work/out/first/meshes/skull-0123456789abcdef.glb && ! -e $work/out/.trephine-tmp-999999-1-x ]] || fail "gc left something"
[[ -e $work/out/mine/letter.txt && -e $work/out/first/notes.txt ]] || fail "gc removed what is not ours"
[[ $before == "$(digests)" ]] || fail "gc harmed a case"
# What the desk left: scans that were dropped and that nobody uses, and what it kept of a case that is gone.
mkdir -p "$work/l/dropped/0123456789abcdef" "$work/out/.library/desk"
echo scan >"$work/l/dropped/1123456789abcdef.zip"
echo painted | tee "$work/out/.library/desk/first.paint" >"$work/out/.library/desk/away.paint"
cp "$work/out/.library/cases/first.built.json" "$work/out/.library/cases/away.built.json"
touch -d '2 hours ago' "$work/l/dropped/"* "$work/out/.library/desk/"* "$work/out/.library/cases/away.built.json"
"$TREPHINE" library gc "$work/out" --config "$work/l/l.yaml" | grep -q '2 unused scans of the desk, 1 drafts of cases that are gone' || fail "gc of what the desk left"
[[ -z $(ls "$work/l/dropped") && -e $work/out/.library/desk/first.paint && ! -e $work/out/.library/desk/away.paint ]] || fail "gc of what the desk left: other files"
build l.yaml --dry-run | grep -q '^0 of 4' || fail "gc made cases stale"

# A case that is made beside the build is in the overview at once.
cp -r "$work/out" "$work/beside"
"$TREPHINE" run c.yaml --series scans/a --out "$work/beside" --case by_hand --no-pictures --no-page --quiet 2>/dev/null
grep -q by_hand "$work/beside/index.html" || fail "index.html does not show the case that a run made"

# list and show.
"$TREPHINE" library list "$work/out" --json list.json >said
grep -q '^4 cases$' said || { cat said; fail "list"; }
"$TREPHINE" library list "$work/out" --max-deviation-mm 0.0001 | grep -q '^0 cases' || fail "list --max-deviation-mm"
"$TREPHINE" library list "$work/out" --class unknown | grep -q '^4 cases' || fail "list --class"
"$TREPHINE" library show "$work/out" first | grep -q 'skull .* triangles' || fail "show"
expect 66 'library show: .*frist: .*did you mean first' "$TREPHINE" library show "$work/out" frist
python3 -c 'import json; j = json.load(open("list.json")); assert len(j) == 4 and all(c["anatomies"]["skull"]["triangles"] > 100 for c in j), j'

# Refused: by the configuration, with line and column; a disk that is too small is for library_faults.
bad() { printf 'trephine: 1\n%s\n' "$1" >bad.yaml; }
bad $'config: c.yaml\ncaes: []\ncases: [{case: a, series: scans/a}]'
expect 78 'bad.yaml:3:1: caes: .*cases' build bad.yaml
bad $'config: c.yaml\ncases: [{case: A b, series: scans/a}]'
expect 78 'bad.yaml:3:16: cases\[0\].case: .*token' build bad.yaml
bad $'config: c.yaml\ncases: [{case: a, series: scans/a}, {case: a, series: scans/copy}]'
expect 78 'bad.yaml:3:.*a, the case is there already' build bad.yaml
bad $'config: c.yaml\nseries: [../../*]'
expect 78 'bad.yaml:3:10: series: .*leads out of the root' build bad.yaml
bad $'config: c.yaml\nphantoms: {list: [{name: a, varaint: small}]}'
expect 78 'varaint.*variant' build bad.yaml
bad $'config: c.yaml'
expect 78 'cases: is missing' build bad.yaml
expect 64 '--phantom seeed=1: .*seed' build l.yaml --phantom seeed=1
expect 64 '--set nothing.at: no such' build l.yaml --set nothing.at=1
expect 64 'frist: .*first' build l.yaml --case frist
expect 64 'library: needs one of these after it: approve, build' "$TREPHINE" library
expect 64 'library biuld: .*library build' "$TREPHINE" library biuld
expect 64 'is started by' "$TREPHINE" library job x
echo >file
expect 73 'file' "$TREPHINE" library build l.yaml --out file
find "$work" -name '.trephine-tmp-*' | grep . && fail "temporary files are left"
echo ok
