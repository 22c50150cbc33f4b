#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Results are evaluated: a table with known answers, Table XVI of the dissertation, what is refused and what is said; R's numbers are
# what the stored ones say.
. "$(dirname "$0")/common.sh"
study=("$TREPHINE" study)

"${study[@]}" "$SOURCE/examples/study/table_sixteen.csv" --count screws --acceptable acceptable --measures errors \
  --out "$work/xvi" >"$work/text"
grep -Eq '^B +20 \(83\.3 %\) +4 \(16\.7 %\) .* 17\.9 points' "$work/text" || { cat "$work/text"; fail "Table XVI, group B"; }
grep -Eq '^C +24 \(92\.3 %\) +2 \(7\.7 %\) .* 26\.9 points' "$work/text" || { cat "$work/text"; fail "Table XVI, group C"; }
for p in 0.1505 0.0005 0.0078; do grep -q "Kruskal-Wallis: .* p = $p" "$work/text" || fail "Table XVI, p $p"; done
for file in study.html study.json tests.csv table.csv plots/errors-group-box.svg plots/errors-group-histogram.svg; do
  [[ -s $work/xvi/$file ]] || fail "no $file"
done
! grep -qiE '<script|https?://' "$work/xvi/study.html" || fail "the page asks for something else"
"${study[@]}" "$SOURCE/examples/study/table_sixteen.csv" --count screws --acceptable acceptable --measures errors \
  --threads 1 --out "$work/again" >/dev/null
diff -r "$work/xvi" "$work/again" || fail "the same table gives other bytes"

# Two attempts of each participant, as figures 46 to 48; one dropped out, one value is missing.
{
  echo participant,level,attempt,error_mm
  for n in {1..12}; do
    level=$((n % 2)) first=$((10 + n * 7 % 11)) second=$((7 + n * 5 % 9))
    echo "p$n,l$level,1,$first.5"
    ((n == 12)) || echo "p$n,l$level,2,$([[ $n == 3 ]] || echo "$second.25")"
  done
} >"$work/attempts.csv"
"${study[@]}" "$work/attempts.csv" --group level --out "$work/two" >"$work/text"
grep -q 'note: 1 of 23 rows has no value, and is left out: p3' "$work/text" || { cat "$work/text"; fail "a missing value is not said"; }
grep -q 'make no pair: p12, p3' "$work/text" || { cat "$work/text"; fail "who makes no pair is not said"; }
grep -q '1 to 2, 10 pairs' "$work/text" || fail "the pairs"
[[ -s $work/two/plots/error_mm-curve.svg && -s $work/two/plots/error_mm-attempt-histogram.svg ]] || fail "no learning curve"

printf 'participant,points\nr-1,3\nAnna Muster,4\n' >"$work/named.csv"
expect 65 'line 3, participant: must be a token' "${study[@]}" "$work/named.csv"
! grep -q Anna "$work/stderr" || fail "a name is repeated"
printf 'participant,point\nr-1,3\n' >"$work/point.csv"
expect 64 'points is no column of the table; did you mean point\?' "${study[@]}" "$work/point.csv" --measures points
printf 'a,a\n1,2\n' >"$work/twice.csv"
expect 65 'column a is named twice' "${study[@]}" "$work/twice.csv"
mkdir "$work/empty"
expect 66 'holds no report of a lesson' "${study[@]}" "$work/empty"
printf 'participant,points\nr-1,3\nr-2,3\n' >"$work/equal.csv"
"${study[@]}" "$work/equal.csv" | grep -q 'all values are equal (3): there is nothing to compare' || fail "equal values are not said"
# What is not finite is refused where it stands, and not left out without a word.
printf 'participant,points\nr-1,3\nr-2,inf\nr-3,NaN\n' >"$work/infinite.csv"
expect 65 'line 3, points: is no finite number' "${study[@]}" "$work/infinite.csv"
# Acceptable or not before and after, by McNemar; one against one says nothing of others.
printf 'participant,group,phase,points,fine\n' >"$work/phases.csv"
for n in 1 2 3 4 5 6; do printf 'r-%d,a,before,%d,0\nr-%d,a,after,%d,1\n' $n $n $n $((n + 2)); done >>"$work/phases.csv"
printf 'r-7,b,before,5,1\n' >>"$work/phases.csv"
"${study[@]}" "$work/phases.csv" --acceptable fine >"$work/text"
grep -q 'before to after, 6 pairs: 6 became acceptable, 0 no more, 0 as before; McNemar: p = 0.031[23]' "$work/text" &&
  grep -q 'signed rank: 21, p = 0.0312, .*(exact, given the ties)' "$work/text" &&
  grep -q 'note: b has 1 value: this says nothing of others like it' "$work/text" || { cat "$work/text"; fail "six tied pairs"; }

# R itself, where it is installed.
command -v Rscript >/dev/null || skip "R is not installed (Debian: r-base-core)"
data=$SOURCE/tests/data/study
Rscript "$data/expected.R" "$data/samples.csv" >"$work/expected.csv"
python3 - "$work/expected.csv" "$data/expected.csv" <<'PY'
import csv, sys
now, stored = ({r["name"]: float(r["value"]) for r in csv.DictReader(open(f))} for f in sys.argv[1:])
assert now.keys() == stored.keys(), now.keys() ^ stored.keys()
for name, value in stored.items():
    assert abs(now[name] - value) <= 1e-10 * max(1, abs(value)), (name, now[name], value)
PY
