#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The first lesson of docs/tutorials/first-lesson.md by its keys: it begins straight before the open hole, which lies in the middle of the window, and
# ends as a success.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/window.sh"
lesson=ventriculostomy
. "$(dirname "$0")/lesson_window.sh"
"$WRITE_CASE" "$work/head_drilled" head_drilled

# A teacher's station records and signs it as well. Without one no lesson begins that should be recorded there.
openssl genpkey -algorithm ed25519 -out "$work/teacher.key" 2>/dev/null
openssl pkey -in "$work/teacher.key" -pubout -out "$work/teacher.pub"
chmod 600 "$work/teacher.key"
server=("$TREPHINE" record-server "$work/head_drilled" --rubric "$work/ventriculostomy.json" --participant r-01 --no-realtime --max-step-s 3600)
key=(--key "$work/teacher.key")
expect 64 '[-]-no-paced' "${server[@]}" "${key[@]}" --record "$work/none.lesson" --no-paced
expect 65 'teacher.pub: private key' "${server[@]}" --record "$work/none.lesson" --key "$work/teacher.pub"
expect 66 'no pose came to 127.0.0.1' "${server[@]}" "${key[@]}" --record "$work/none.lesson" --wait-s 0.2
[[ ! -e $work/none.lesson ]] || fail "a recording of nothing"
expect 64 'none.json: --record: ends as a file that is written beside it' "${server[@]}" "${key[@]}" --record "$work/none.json"
touch "$work/none.html"
expect 73 'none.html: is there already' "${server[@]}" "${key[@]}" --record "$work/none.lesson"
"${server[@]}" "${key[@]}" --record "$work/seen.lesson" >"$work/server" 2>&1 &
feeder=$!
for try in {1..600}; do port=$([[ ! -e $work/server ]] || sed -nE 's/.*127\.0\.0\.1:([0-9]+).*/\1/p' "$work/server"); [[ -n $port ]] && break; sleep 0.1; done
[[ -n $port ]] || { cat "$work/server"; fail "the server does not say where it is"; }

expect 74 'the record server .* is for another participant, task, case, rubric or second hand' "$TREPHINE" play "$work/head_drilled" --lesson ventriculostomy \
  --rubric "$work/ventriculostomy.json" --record "$work/late.lesson" --participant r-02 --record-server-port "$port"

questions=
begin head_drilled --out "$work/out" --advance-mm-per-s 12 --remote-tells-all --record-server-port "$port"
until_lesson 'question patient'
ok 'answer head-drilled'
for asked in side:right indication:csf_pressure imaging:this_ct; do
  until_lesson "question ${asked%:*} "
  ok "answer ${asked#*:}"
done
until_lesson 'tool catheter step 1 passes_count 0'
xdotool mousemove 240 180
sleep 0.3
moves xdotool key g
xdotool key Home
sleep 1
xdotool keydown ctrl keydown Down; sleep 0.5; xdotool keyup Down keyup ctrl
xdotool keydown w
until_is state 'in ventricles'
until_lesson 'tool catheter step 2 '  # CSF comes: what is left is the end
xdotool keyup w
xdotool key Return; sleep 0.3; xdotool key Return
until_lesson 'question outlet '
ok 'answer cm_15'
until_lesson 'question proof '
ok 'answer ct'
xdotool key Return; sleep 0.3; xdotool key Return
until_lesson 'end finished points [0-9]+ of 30'
xdotool key Escape
finish 0
grep -q '^completed$' "$work/said" || { cat "$work/said"; fail "the first lesson as it is written is no success"; }

# What the server recorded by itself is signed, whole and a success; the window's own recording is signed by nobody.
wait $feeder || { cat "$work/server"; fail "the server fails"; }
feeder=
grep -q 'head_drilled: is not approved' "$work/server" || { cat "$work/server"; fail "the server does not say that nobody approved the case"; }
grep -q '^seen.lesson.sig$\|/seen.lesson.sig$' "$work/server" && grep -q '^completed$' "$work/server" || { cat "$work/server"; fail "the server's lesson"; }
signed() { "$TREPHINE" score "$1" --case "$work/head_drilled" --rubric "$work/ventriculostomy.json" --signed-by "$work/teacher.pub" >"$work/text" && grep -x 'signed\|not signed' "$work/text"; }
[[ $(signed "$work/seen.lesson") == signed ]] || { cat "$work/text"; fail "what the server saw is not signed"; }
grep -q '^Time-out and decisions *5 ' "$work/text" || { cat "$work/text"; fail "the answers did not come to the server"; }
[[ $(signed "$work"/out/r-01-*.lesson) == 'not signed' ]] || { cat "$work/text"; fail "the window's own recording is signed"; }
"$TREPHINE" replay "$work/head_drilled" "$work/seen.lesson" | grep -q '^replayed bit for bit$' || fail "what the server saw does not replay"
expect 74 'record-server-port: nobody answers' "$TREPHINE" play "$work/head_drilled" --lesson ventriculostomy --rubric "$work/ventriculostomy.json" \
  --record "$work/late.lesson" --participant r-01 --record-server-port "$port"
