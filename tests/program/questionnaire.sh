#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Questionnaires are data: checked against what is asked, without a name, and evaluated by phase.
. "$(dirname "$0")/common.sh"
: "${OFFLINE:?}"
asked=$SOURCE/examples/study/questionnaire.yaml
"$OFFLINE" questionnaire "$asked" | grep -q '^ventriculostomy: 4 questions$' || fail "what is asked"
"$OFFLINE" questionnaire "$asked" --answers "$SOURCE/examples/study/answers" --output "$work/answers.csv" >/dev/null
diff - "$work/answers.csv" <<'CSV' || fail "the table"
participant,phase,placed_before_count,confident,landmarks,realistic
p1,after,0,4,4,3
p1,before,0,2,2,
p2,after,3,4,5,4
p2,before,3,3,3,
CSV
"$TREPHINE" study "$work/answers.csv" >"$work/text"
grep -q 'before to after, 2 pairs, mean +60.0 %' "$work/text" || { cat "$work/text"; fail "the change"; }
grep -q '2 of 4 rows have no value, and are left out: p1, p2' "$work/text" || fail "what was not asked before"

mkdir "$work/bad"
answer() { printf 'questionnaire: ventriculostomy\nparticipant: %s\nphase: before\nanswers: {%s}\n' "$1" "$2" >"$work/bad/one.yaml"; }
refused() { expect 78 "$1" "$OFFLINE" questionnaire "$asked" --answers "$work/bad" --output "$work/bad.csv"; [[ ! -e $work/bad.csv ]] || fail "half a table"; }
answer p1 'confident: 6'; refused 'answers.confident: 6, must lie from 1 to 5'
answer p1 'confident: 2.5'; refused 'answers.confident: 2.5, must be a whole number'
answer p1 'sure: 2'; refused 'sure is not asked'
answer 'Anna Muster' 'confident: 2'; refused 'participant: must be 1 to 32 characters'
! grep -q Anna "$work/stderr" || fail "a name is repeated"
answer p1 'confident: 2'; cp "$work/bad/one.yaml" "$work/bad/two.yaml"
expect 65 'p1 has answered in phase before in one.yaml' "$OFFLINE" questionnaire "$asked" --answers "$work/bad" --output "$work/bad.csv"
