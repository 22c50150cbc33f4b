# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced, after common.sh and window.sh, by the scripts that do a lesson in a window. `lesson` is its name.
: "${OFFLINE:?}" "${lesson:?}"
questions=--no-questions  # but where a script is about them
"$OFFLINE" rubric "$SOURCE/configs/rubrics/$lesson.yaml" --output "$work/$lesson.json" >/dev/null

# begin CASE ARGUMENTS...: opens a window on a lesson.
begin() {
  open_window "$TREPHINE" play "$work/$1" --lesson "$lesson" --rubric "$work/$lesson.json" --participant r-01 --no-realtime $questions \
    --max-step-s 3600 --window-width 480 --window-height 360 --no-panels "${@:2}"
}
# until_lesson PATTERN: waits until the lesson is there.
until_lesson() {
  until_is lesson "$1"
}
# judged RECORDING: `score` says of it what the window said.
judged() {
  "$TREPHINE" score "$1" --case "$2" --rubric "$work/$lesson.json" --json "$work/again.json" >"$work/text"
  cmp "$work/again.json" "${1%.lesson}.json" || fail "judged again it is not the same"
  grep -qF "$(tail -1 "$work/text")" "$work/said" || { cat "$work/said" "$work/text"; fail "the window says otherwise"; }
  [[ -s ${1%.lesson}.html ]] || fail "no page"
}
