#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A participant is led through a library: only approved cases, in a kept order, resumed, with a table of results.
. "$(dirname "$0")/common.sh"
: "${OFFLINE:?}" "${WRITE_CASE:?}"
library=$work/library
mkdir "$library"
"$WRITE_CASE" "$library/head-drilled" head_drilled
cp -r "$library/head-drilled" "$library/copy"
"$WRITE_CASE" "$library/head" head
"$OFFLINE" rubric "$SOURCE/configs/rubrics/ventriculostomy.yaml" --output "$work/rubric.json" >/dev/null
cat >"$work/script.json" <<'JSON'
{"module": "ventriculostomy", "steps": [{"take": {"tool": "marker"}},
  {"trace": {"from": {"at": "nasion"}, "to": {"at": "nasion", "along_mm": 110}}}, {"take": {"tool": "catheter"}},
  {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish"]}
JSON
exercise=("$TREPHINE" exercise "$library" --participant r-01 --out "$work/results")

expect 66 'holds no approved case' "${exercise[@]}"
# What the case cannot serve is accepted lesson by lesson, with a reason, which is kept.
approve=("$OFFLINE" library approve "$library/head" --by prof-1 --difficulty-level 4)
expect 80 '[-]-accept: the case cannot serve pedicle_finder,pedicle_screw,spine_needle,subclavian; where that is right, say why' "${approve[@]}"
expect 80 '[-]-accept: the case cannot serve pedicle_finder,pedicle_screw,subclavian; ' "${approve[@]}" --accept 'spine_needle=a head'
expect 64 '[-]-accept: subclavian: the reason is missing' "${approve[@]}" --accept 'spine_needle=a head' --accept 'subclavian= '
expect 64 '[-]-accept: ventriculostomy: the case can serve' "${approve[@]}" --accept 'ventriculostomy=a head'
expect 64 '[-]-accept: needle, there is no such lesson' "${approve[@]}" --accept 'needle=a head'
expect 64 '[-]-accept: must be LESSON=REASON' "${approve[@]}" --accept needle
[[ ! -e $library/head/approved.json ]] || fail "a refused approval was written"
head=(--accept 'pedicle_finder,pedicle_screw,spine_needle=a head' --accept 'subclavian=no chest')
"${approve[@]}" "${head[@]}" >"$work/approved"
python3 - "$library/head/approved.json" <<'PY'
import json, sys
accepted = {a["lesson"]: a["reason"] for a in json.load(open(sys.argv[1]))["accepted"]}
assert accepted == {"pedicle_finder": "a head", "pedicle_screw": "a head", "spine_needle": "a head", "subclavian": "no chest"}, accepted
PY
grep -qx 'ventriculostomy: serves: right, left' "$work/approved" &&
  grep -q '^spine_needle: cannot serve: landmarks: the lesson needs a pedicle' "$work/approved" || { cat "$work/approved"; fail "lessons that the case serves"; }
"$OFFLINE" library approve "$library/head-drilled" --by prof-1 --difficulty-level 2 "${head[@]}" >/dev/null
cp "$library/head-drilled/approved.json" "$library/copy"
# What is approved is what was checked: a case.json that takes its place meanwhile is not, here while the simulator is asked.
mkdir "$work/bin"
cp "$(dirname "$OFFLINE")"/{trephine,trephine-sim} "$work/bin" && mv "$work/bin/trephine-sim" "$work/bin/asked"
"$WRITE_CASE" "$work/other" spine
cat >"$work/bin/trephine-sim" <<SH
#!/bin/sh
[ "\$SWAP" = before ] && cp "$work/other/case.json" "$work/swapped/case.json"
"$work/bin/asked" "\$@"
cp "$work/other/case.json" "$work/swapped/case.json"
SH
chmod 755 "$work/bin/trephine-sim"
for SWAP in before after; do
  export SWAP
  rm -rf "$work/swapped" && cp -r "$library/head" "$work/swapped" && rm -f "$work/swapped/approved.json"
  checked=$(sha256sum <"$work/swapped/case.json")
  code=0
  "$work/bin/trephine" library approve "$work/swapped" --by prof-1 "${head[@]}" --quiet 2>"$work/fault" || code=$?
  if [[ $SWAP == before ]]; then
    [[ $code == 65 && ! -e $work/swapped/approved.json ]] && grep -q 'case.json: changed while it was read' "$work/fault" ||
      fail "the simulator was asked of another case: $code: $(cat "$work/fault")"
  else
    [[ $code == 0 ]] && grep -q "\"case_sha256\": \"${checked%% *}\"" "$work/swapped/approved.json" || fail "approved: $code: $(cat "$work/swapped/approved.json")"
  fi
done
# Not while a run may publish another case there.
expect 75 'another run builds this case' flock "$library/head/.lock" "$OFFLINE" library approve "$library/head" --by prof-2
grep -q prof-1 "$library/head/approved.json" || fail "the approval changed under a run"
expect 64 '[-]-by: must be' "$OFFLINE" library approve "$library/head" --by "Prof. A"
expect 64 '[-]-participant: must be' "$TREPHINE" exercise "$library" --participant "A B" --out "$work/results"
expect 64 'uncertain is no class' "${exercise[@]}" --classes normal,uncertain
expect 64 'is needed with --script or --play' "${exercise[@]}" --script "$work/script.json"

"${exercise[@]}" >"$work/text"
grep -Eq '^left out: copy: its folder has another name' "$work/text" || { cat "$work/text"; fail "a copy is taken for a case"; }
grep -Eq '^1 +head-drilled +normal +2 +right +- +to do$' "$work/text" || { cat "$work/text"; fail "the easier case is not first"; }
grep -Eq '^2 +head +normal +4 +right +- +to do$' "$work/text" || { cat "$work/text"; fail "the harder case is not second"; }
expect 64 'has a plan by other parameters' "${exercise[@]}" --cases-count 1

# One case, then the others; what is done stays as it is.
"${exercise[@]}" --script "$work/script.json" --rubric "$work/rubric.json" --no-all >"$work/text"
grep -Eq '^1 +head-drilled .* 25 of 25 points: - - 5 5 5 5 5, completed$' "$work/text" || { cat "$work/text"; fail "the first case is not done"; }
grep -Eq '^2 +head .* to do$' "$work/text" || fail "the second is done already"
first=$(sha256sum "$work"/results/r-01-ventriculostomy-01-*)
"${exercise[@]}" --script "$work/script.json" --rubric "$work/rubric.json" >"$work/text"
grep -Eq '^goes on with ' "$work/text" || fail "it begins again"
grep -Eq '^2 +head .* [0-9]+ of 35 points: 3 1 1 1 1 1 1, not completed$' "$work/text" || { cat "$work/text"; fail "the second case is not done"; }
[[ $first == "$(sha256sum "$work"/results/r-01-ventriculostomy-01-*)" ]] || fail "what was done is changed"
[[ $(wc -l <"$work/results/attempts-ventriculostomy.csv") == 3 ]] || fail "the log does not hold two attempts"
[[ -s $work/results/r-01-ventriculostomy-02-head.html ]] || fail "no page"

# A teacher signs what he saw; the table says which attempts are signed, and one that was replaced since is refused.
openssl genpkey -algorithm ed25519 -out "$work/teacher.key" 2>/dev/null
openssl pkey -in "$work/teacher.key" -pubout -out "$work/teacher.pub"
openssl genpkey -algorithm ed25519 -out "$work/other.key" 2>/dev/null
seen=$work/results/r-01-ventriculostomy-01-head-drilled.lesson
unseen=$work/results/r-01-ventriculostomy-02-head.lesson
score=("$TREPHINE" score "$seen" --case "$library/head-drilled" --rubric "$work/rubric.json" --signed-by "$work/teacher.pub")
"${score[@]}" --log "$work/log.csv" | grep -qx 'not signed' || fail "it is signed by nobody"
"$TREPHINE" sign "$seen" --key "$work/teacher.key" | grep -qx "$seen.sig" || fail "it does not say where the signature is"
"${score[@]}" --log "$work/log.csv" --json "$work/signed.json" | grep -qx signed || fail "it is not signed"
grep -q '"signature": "signed"' "$work/signed.json" || fail "the result does not say that it is signed"
[[ $(cut -d, -f3 "$work/log.csv") == $'attempt\n1\n1' ]] || fail "signed it is another attempt"
[[ $(tail -1 "$work/log.csv") == *,signed ]] || fail "the log does not say that it is signed"
expect 64 'is given with --script, --play or --signed-by' "${exercise[@]}" --rubric "$work/rubric.json"
"${exercise[@]}" --signed-by "$work/teacher.pub" >"$work/text"
grep -Eq '^1 +head-drilled .*, recording signed, points not compared$' "$work/text" || { cat "$work/text"; fail "points that nobody compared are signed"; }
signed=("${exercise[@]}" --signed-by "$work/teacher.pub" --rubric "$work/rubric.json")
"${signed[@]}" >"$work/text"
grep -Eq '^1 +head-drilled .*, signed$' "$work/text" || { cat "$work/text"; fail "the table does not say what is signed"; }
grep -Eq '^2 +head .*, not signed$' "$work/text" || { cat "$work/text"; fail "the table does not say what is not"; }
# Points are signed where they are those of the signed recording: not of an edited report, nor of another's recording and report.
report=${seen%.lesson}.json
cp "$report" "$work/report.json"
sed -i '0,/"points": 25/s//"points": 24/' "$report"
expect 80 'head-drilled.json: points: is not what the signed recording gives' "${signed[@]}"
sed '0,/"score": 5/s//"score": 3/' "$work/report.json" >"$report"
expect 80 'head-drilled.json: rows: is not what the signed recording gives' "${signed[@]}"
sed 's/"participant": "r-01"/"participant": "r-02"/' "$work/report.json" >"$report"
expect 80 'head-drilled.json: participant: is not what' "${signed[@]}"
cp "$work/report.json" "$report"
sed 's/kocher_mm: {limit: 10,/kocher_mm: {limit: 9,/' "$SOURCE/configs/rubrics/ventriculostomy.yaml" >"$work/strict.yaml"
"$OFFLINE" rubric "$work/strict.yaml" --output "$work/strict.json" >/dev/null
expect 80 'rubric_sha256: is of another rubric' "${exercise[@]}" --signed-by "$work/teacher.pub" --rubric "$work/strict.json"
"$TREPHINE" exercise "$library" --participant r-09 --out "$work/results" >/dev/null
for ending in lesson lesson.sig json; do cp "${seen%.lesson}.$ending" "$work/results/r-09-ventriculostomy-01-head-drilled.$ending"; done
for key in "" "--rubric=$work/rubric.json"; do
  expect 80 'r-09-.*lesson: participant: is r-01, and the attempt is of r-09' "$TREPHINE" exercise "$library" --participant r-09 \
    --out "$work/results" --signed-by "$work/teacher.pub" $key
done
rm "$work"/results/r-09-*
expect 65 'teacher.pub: private key: is none of Ed25519' "$TREPHINE" sign "$seen" --key "$work/teacher.pub"
expect 65 'other.key: public key: is none of Ed25519' "${score[@]/teacher.pub/other.key}"
chmod 640 "$work/teacher.key"
expect 65 "teacher.key: private key: can be read or written by others.*chmod 600 '.*teacher.key'" "$TREPHINE" sign "$seen" --key "$work/teacher.key"
chmod 600 "$work/teacher.key"
# A participant who plants a link in place of the signature does not choose what the teacher overwrites.
echo marks >"$work/marks"
mv "$seen.sig" "$work/seen.sig" && ln -s "$work/marks" "$seen.sig"
"$TREPHINE" sign "$seen" --key "$work/teacher.key" >/dev/null
[[ $(cat "$work/marks") == marks && ! -L $seen.sig ]] && cmp "$seen.sig" "$work/seen.sig" || fail "sign writes through a link"
cp "$seen.sig" "$unseen.sig"
expect 80 'head.lesson.sig: recording_sha256: is not of the recording' "${exercise[@]}" --signed-by "$work/teacher.pub"
"$TREPHINE" sign "$unseen" --key "$work/other.key" >/dev/null
expect 80 'head.lesson.sig: signature: is not by the owner' "${exercise[@]}" --signed-by "$work/teacher.pub"
rm "$unseen.sig"

# Scored anew from the recordings, a report that says more than its recording is refused; so is a mixture of rubrics.
group=("$TREPHINE" group "$work/results" --page "$work/group.html")
study=("$TREPHINE" study "$work/results" --measures points)
anew=(--cases "$library" --rubric "$work/rubric.json" --scores-cache "$work/scores")
report=$work/results/r-01-ventriculostomy-02-head.json
expect 64 '[-]-rubric: is missing' "${group[@]}" --cases "$library"
expect 64 'scores-cache: needs --cases' "${study[@]}" --scores-cache "$work/scores"
"${group[@]}" "${anew[@]}" >/dev/null 2>&1 || fail "what is as it was is refused"
kept=$(cd "$work/scores" && sha256sum -- *)
[[ $(wc -l <<<"$kept") == 2 ]] || fail "the scores are not kept: $kept"
"${study[@]}" "${anew[@]}" >/dev/null 2>&1 || fail "the study refuses what is as it was"
[[ $(cd "$work/scores" && sha256sum -- *) == "$kept" ]] || fail "it is scored another time"
cp "$report" "$work/report.json"
python3 - "$report" <<'PY'
import json, sys
j = json.load(open(sys.argv[1]))
j["outcome"], j["points"], j["critical"] = "completed", j["most_points"], []
for row in j["rows"]: row["score"] = 5
json.dump(j, open(sys.argv[1], "w"))
PY
"${group[@]}" >/dev/null 2>&1 || fail "without the cases nothing tells that it was edited"
for program in group study; do
  declare -n one=$program
  expect 80 'head.json: outcome: says completed, and its recording gives not completed: it was changed' "${one[@]}" "${anew[@]}"
done
# The page, the table and the notes say which points come from a recording that the teacher signed: of two attempts one, whatever
# signature the other borrows.
for borrowed in none other_bytes other_key; do
  case $borrowed in
    other_bytes) cp "$seen.sig" "$unseen.sig" ;;
    other_key) "$TREPHINE" sign "$unseen" --key "$work/other.key" >/dev/null ;;
  esac
  cp "$work/report.json" "$report"
  "${group[@]}" "${anew[@]}" --signed-by "$work/teacher.pub" --csv "$work/signed.csv" >/dev/null 2>"$work/notes" || { cat "$work/notes"; fail "$borrowed: the group"; }
  grep -q '<p class="large bad">Not signed: 1 of 2 attempts.</p>' "$work/group.html" || fail "$borrowed: the page does not say that one is not signed"
  python3 - "$work/signed.csv" <<'PY' || fail "$borrowed: the table"
import csv, sys
rows = {r["case"]: r["signature"] for r in csv.DictReader(open(sys.argv[1]))}
assert rows == {"head-drilled": "signed", "head": "not signed"}, rows
PY
  case $borrowed in
    none) ! grep -q signature "$work/notes" ;;
    other_bytes) grep -q '02-head: its signature is of another recording: not signed' "$work/notes" ;;
    other_key) grep -q '02-head: its signature is not by the owner of the public key: not signed' "$work/notes" ;;
  esac || { cat "$work/notes"; fail "$borrowed: the note"; }
done
rm "$unseen.sig"
# One recording is one attempt, however often it is copied, and whatever the copy's report leaves out.
copy=$work/results/r-01-ventriculostomy-03-head-drilled
for ending in lesson lesson.sig; do cp "${seen%.lesson}.$ending" "$copy.$ending"; done
sed '/"motion_sha256"/d' "${seen%.lesson}.json" >"$copy.json"
expect 80 'motion_sha256: says nothing, and its recording gives' "${group[@]}" "${anew[@]}"
sed 's/"rubric_sha256": "[0-9a-f]*"/"rubric_sha256": ""/' "$copy.json" >"$work/x" && mv "$work/x" "$copy.json"
"${group[@]}" "${anew[@]}" --csv "$work/signed.csv" >/dev/null 2>"$work/notes" || { cat "$work/notes"; fail "a copy of another rubric"; }
[[ $(wc -l <"$work/signed.csv") == 3 ]] && grep -q '03-head-drilled: its motion is that of r-01-ventriculostomy-01-head-drilled' "$work/notes" ||
  { cat "$work/notes" "$work/signed.csv"; fail "a copy is an attempt of its own"; }
rm "$copy".*
expect 64 'signed-by: needs --cases' "${group[@]}" --signed-by "$work/teacher.pub"
# A rubric of which the critical errors were deleted is another one.
python3 - "$SOURCE/configs/rubrics/ventriculostomy.yaml" "$work/soft.yaml" <<'PY'
import sys
text = open(sys.argv[1]).read()
open(sys.argv[2], "w").write(text[:text.index("critical_errors:")])
PY
"$OFFLINE" rubric "$work/soft.yaml" --output "$work/soft.json" >/dev/null
"$TREPHINE" score "$unseen" --case "$library/head" --rubric "$work/soft.json" --json "$report" >/dev/null
for program in group study; do
  declare -n one=$program
  expect 65 'were scored by different rubrics' "${one[@]}"
done
"${group[@]}" "${anew[@]}" >/dev/null 2>"$work/notes" || fail "by one rubric they stand together"
grep -q 'r-01-ventriculostomy-02-head: was scored by another rubric, and is scored anew' "$work/notes" || { cat "$work/notes"; fail "it is not told"; }
cp "$work/report.json" "$report"

# Sides that are exchanged in a case, with its checksum mended, make another case: of that nothing recorded before is scored.
other_sides() {
  python3 - "$1/case.json" <<'PY'
import hashlib, re, sys
text = open(sys.argv[1]).read()
text = re.sub(r'"monro_(left|right)"', lambda m: '"monro_%s"' % {"left": "right", "right": "left"}[m[1]], text)
body = text[:text.rindex(',\n "checksum"')]
open(sys.argv[1], "w").write(body + ',\n "checksum": "' + hashlib.sha256(body.encode()).hexdigest() + '"\n}\n')
PY
}
cp -r "$library" "$work/others"
other_sides "$work/others/head"
"$TREPHINE" check "$work/others/head" >/dev/null || fail "the other case is none"
expect 65 'head.lesson: case_sha256: the recording is of another case.json' "$TREPHINE" score "$unseen" --case "$work/others/head" --rubric "$work/rubric.json"
expect 65 'head.lesson: case_sha256: the recording is of another case.json' "${group[@]}" --cases "$work/others" --rubric "$work/rubric.json"
# Nor is a lesson scored whose case was exchanged since it was found approved. Its first line comes after that; the program then waits in
# the middle of what it prints until the other case has taken the place.
mkdir "$work/late" && cp -r "$library/head" "$work/late/head"
for n in $(seq 100); do
  folder=$work/late/$(printf 'damaged%0180d' "$n")
  mkdir "$folder" && echo '{}' >"$folder/case.json"
done
code=0
python3 - "$work" "$TREPHINE" >"$work/text" 2>"$work/fault" <<'PY' || code=$?
import fcntl, os, shutil, subprocess, sys
work, program = sys.argv[1:]
out, into = os.pipe()
fcntl.fcntl(into, fcntl.F_SETPIPE_SZ, 4096)
run = subprocess.Popen([program, "exercise", work + "/late", "--participant", "r-05", "--out", work + "/late-results", "--script",
                        work + "/script.json", "--rubric", work + "/rubric.json"], stdout=into)
os.close(into)
os.read(out, 1)
shutil.copy(work + "/others/head/case.json", work + "/late/head/case.json")
while os.read(out, 4096):
    pass
sys.exit(run.wait())
PY
[[ $code == 80 ]] && grep -q 'late/head: case.json: was exchanged while the lesson ran' "$work/fault" || fail "an exchanged case is scored: $code: $(cat "$work/fault")"
[[ -z $(find "$work/late-results" -name '*head.json') ]] || fail "an exchanged case has a report"

# A report that was lost is made again of the recording; an approval is void once the case is another.
rm "$work/results/r-01-ventriculostomy-02-head.json"
"${exercise[@]}" --script "$work/script.json" --rubric "$work/rubric.json" >/dev/null
[[ $(wc -l <"$work/results/attempts-ventriculostomy.csv") == 3 ]] || fail "scored again it is another attempt"
"$WRITE_CASE" "$library/head-drilled" head
"$TREPHINE" exercise "$library" --participant r-02 --out "$work/results" >"$work/text"
grep -Eq '^left out: head-drilled: changed since prof-1 approved it$' "$work/text" || { cat "$work/text"; fail "a void approval holds"; }
"$OFFLINE" library approve "$library/head" --by prof-1 --withdraw >/dev/null
expect 66 'holds no approved case' "$TREPHINE" exercise "$library" --participant r-03 --out "$work/results"
