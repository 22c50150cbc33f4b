#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Twelve simulated participants in three levels do a test, practise, and do the test again; their teacher sees it on one page. PAGE=FILE
# keeps the page.
. "$(dirname "$0")/common.sh"
: "${OFFLINE:?}" "${WRITE_CASE:?}"
library=$work/library results=$work/results
mkdir "$library"
for n in 1 2; do  # the same head under two names
  "$WRITE_CASE" "$library/case-$n" head_drilled
  python3 - "$library/case-$n/case.json" "case-$n" <<'PY'
import hashlib, sys
path, token = sys.argv[1:]
text = open(path).read().replace('"head-drilled"', f'"{token}"')
body = text[:text.rindex(',\n "checksum"')]
open(path, "w").write(body + ',\n "checksum": "' + hashlib.sha256(body.encode()).hexdigest() + '"\n}\n')
PY
  "$OFFLINE" library approve "$library/case-$n" --by prof-1 --difficulty-level "$n" \
    --accept 'pedicle_finder,pedicle_screw,spine_needle,subclavian=a head' >/dev/null
done
"$OFFLINE" rubric "$SOURCE/configs/rubrics/ventriculostomy.yaml" --output "$work/rubric.json" >/dev/null
cat >"$work/script.json" <<'JSON'
{"module": "ventriculostomy", "steps": [{"take": {"tool": "catheter"}},
  {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish"]}
JSON
exercise() { "$TREPHINE" exercise "$library" --out "$results" --participant "$@"; }

# Experts miss little, students much; after practice everybody misses less.
for level in student resident expert; do
  case $level in student) noise=14 ;; resident) noise=8 ;; expert) noise=4 ;; esac
  for n in 1 2 3 4; do
    first=(--level "$level" --group "g$((n % 2))" --test-cases-count 1)
    for attempt in 1 2 3; do
      exercise "$level-$n" "${first[@]}" --script "$work/script.json" --rubric "$work/rubric.json" --no-all \
        --aim-noise-mm "$(python3 -c "print($noise * (1.15 - 0.15 * $attempt))")" --seed "$((100 * n + 10 * attempt + noise))" >/dev/null
      first=()
    done
  done
done
exercise student-1 >"$work/text"
grep -Eq '^1 +case-2 .* before +[0-9]+ of 25 points' "$work/text" || { cat "$work/text"; fail "the test before is not done"; }
grep -Eq '^2 +case-1 .* practice +[0-9]+ of 25 points' "$work/text" || { cat "$work/text"; fail "the withheld case is practised"; }
grep -Eq '^3 +case-2 .* after +[0-9]+ of 25 points' "$work/text" || fail "the test after is not done"
expect 64 "the participant's plan says student" "$TREPHINE" exercise "$library" --out "$results" --participant student-1 --level expert

# A recording is deleted: that is told, and the plan goes on, once more through the practice and to the later test.
rm "$results/student-1-ventriculostomy-02-case-1.lesson"
exercise student-1 --again --retention >"$work/text"
grep -Eq '^2 .* points: .*\(its recording is gone' "$work/text" || { cat "$work/text"; fail "a deleted recording is not told"; }
grep -Eq '^4 +case-1 .* practice +to do$' "$work/text" || { cat "$work/text"; fail "no further round"; }
grep -Eq '^5 +case-2 .* retention +to do$' "$work/text" || { cat "$work/text"; fail "no later test"; }
exercise student-1 --script "$work/script.json" --rubric "$work/rubric.json" --aim-noise-mm 6 --seed 7 >"$work/text"
grep -Eq '^5 +case-2 .* retention +[0-9]+ of 25 points' "$work/text" || { cat "$work/text"; fail "the plan does not go on"; }

"$TREPHINE" group "$results" --page "$work/group.html" --csv "$work/group.csv" --less-level student --more-level expert \
  >"$work/text" 2>"$work/notes"
grep -q '^ventriculostomy: 12 participants, 37 attempts$' "$work/text" || { cat "$work/text" "$work/notes"; fail "who did what"; }
grep -q 'student-1-ventriculostomy-02-case-1: the recording is gone' "$work/notes" || fail "the deleted recording"
grep -q 'Pass mark, by contrasting groups' "$work/group.html" && ! grep -q 'not set:' "$work/group.html" || fail "no pass mark"
grep -Eq 'contact force, N<td class="n">[0-9.]+ to [0-9.]+<' "$work/group.html" && grep -q 'smoothness sparc' "$work/group.html" || fail "no motion beside experts"
! grep -qiE '<script|https?://' "$work/group.html" || fail "the page asks for something else"
[[ -z ${PAGE:-} ]] || cp "$work/group.html" "$PAGE"

# The same as a study, by level and phase; from the folder and from the table it is the same.
"$TREPHINE" study "$results" --group level --measures points,path_mm --out "$work/study" >"$work/text" 2>/dev/null
grep -q 'expert to student' "$work/text" && grep -q 'before to after, 12 pairs' "$work/text" || { cat "$work/text"; fail "the study"; }
cmp "$work/group.csv" "$work/study/table.csv" || fail "group and study read other tables"
"$TREPHINE" study "$work/group.csv" --group level --measures points,path_mm >"$work/again"
cmp "$work/text" "$work/again" || { diff "$work/text" "$work/again"; fail "the table gives another study than the folder"; }

# A report beside those of experts: a sentence where the hand was outside of their band.
one=$results/student-2-ventriculostomy-01-case-2
"$TREPHINE" score "$one.lesson" --case "$library/case-2" --rubric "$work/rubric.json" --json "$work/one.json" --page "$work/one.html" \
  --expert "$results/expert-1-ventriculostomy-03-case-2.json" --expert "$results/expert-2-ventriculostomy-03-case-2.json" >/dev/null
grep -q '"experts"' "$work/one.json" && grep -q 'How the hand moved' "$work/one.html" || fail "no figures of motion"
