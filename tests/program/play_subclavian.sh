#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A subclavian line in a chest, done in the window: the needle turns green with blood, and only then. The recording is judged the same
# by `score`.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/window.sh"
lesson=subclavian
. "$(dirname "$0")/lesson_window.sh"
"$WRITE_CASE" "$work/chest" chest
begin chest --out "$work/out" --advance-mm-per-s 6 --remote-tells-all
moves ok 'place -79.7 -60.2 -5.7 -0.645 -0.753 -0.129'
press_on w
for try in {1..400}; do [[ $answer == *' in vein '* ]] && break; step 0.323 0.377 0.065; done
((try < 400)) || fail "the needle never comes to the vein: $answer"
ask lesson
[[ $answer != *green* && $answer == *'syringe -'* ]] || fail "blood without aspiration: $answer"
xdotool key a
until_lesson 'passes_count 1 aspirations_count 1 syringe blood .*green'
ok finish
until_lesson 'end finished green points [0-9]+ of 30'
ok quit
finish 0
judged "$work/out/r-01-subclavian-01-chest.lesson" "$work/chest"
grep -q 'green: success at the first pass$' "$work/said" || { cat "$work/said"; fail "the end is not said"; }
