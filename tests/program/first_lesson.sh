#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The first lesson of docs/tutorials/first-lesson.md by its keys: it begins straight before the open hole, which lies in the middle of the window, and
# ends as a success.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/window.sh"
lesson=ventriculostomy
. "$(dirname "$0")/lesson_window.sh"
"$WRITE_CASE" "$work/head_drilled" head_drilled

begin head_drilled --out "$work/out" --advance-mm-per-s 12 --remote-tells-all
until_lesson 'tool catheter step 1 passes_count 0'
xdotool mousemove 240 180
sleep 0.3
moves xdotool key g
xdotool key Home
sleep 1
xdotool keydown ctrl keydown Down; sleep 0.5; xdotool keyup Down keyup ctrl
xdotool keydown w
until_is state 'in ventricles'
xdotool keyup w
xdotool key Return; sleep 0.3; xdotool key Return
until_lesson 'end finished points [0-9]+ of 25'
xdotool key Escape
finish 0
grep -q '^completed$' "$work/said" || { cat "$work/said"; fail "the first lesson as it is written is no success"; }
