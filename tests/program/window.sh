# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced, after common.sh, by the scripts that open a window: a screen of Xvfb, and a session that is worked by its remote.
command -v Xvfb >/dev/null || skip "no Xvfb"
command -v xdotool >/dev/null || skip "no xdotool"
: "${WRITE_CASE:?}"
export LP_NUM_THREADS=1
# The longest wait for anything: a window on a busy machine draws a picture in seconds.
longest_s=300
sim= feeder=  # what the trap ends: the session, and a process of the script that feeds it

Xvfb -displayfd 3 -screen 0 480x360x24 3>"$work/display" >/dev/null 2>&1 &
screen=$!
trap 'for p in $sim $feeder $screen; do kill $p 2>/dev/null || true; done; chmod -R u+w "$work"; rm -rf "$work"' EXIT
for try in {1..600}; do [[ -s $work/display ]] && break; sleep 0.1; done
[[ -s $work/display ]] || fail "Xvfb does not start"
DISPLAY=:$(cat "$work/display")
export DISPLAY

# fail_with_session WHY: what the session said, and the failure.
fail_with_session() { cat "$work/said" "$work/fault" >&2; fail "$1"; }
# until_said PATTERN: waits until a line on the session's stdout matches.
until_said() {
  local end=$((SECONDS + longest_s))
  while ((SECONDS < end)); do
    grep -Eqs -- "$1" "$work/said" && return 0
    kill -0 $sim 2>/dev/null || break
    sleep 0.1
  done
  fail_with_session "it never says: $1"
}
# open_window COMMAND...: starts a session with a remote and waits for its first picture.
open_window() {
  rm -f "$work/said"
  "$@" --remote 0 >"$work/said" 2>"$work/fault" &
  sim=$!
  until_said '^first picture'
  local port token
  read -r port token < <(sed -nE 's/^remote on port ([0-9]+), token ([0-9a-f]{32})$/\1 \2/p' "$work/said")
  exec 4<>"/dev/tcp/127.0.0.1/$port"
  ok "token $token"
}
# ask LINE: what the remote answers, into `answer`.
ask() {
  echo "$1" >&4
  IFS= read -r -t $longest_s -u 4 answer || fail_with_session "no answer to: $1"
}
ok() { ask "$1"; [[ $answer == ok ]] || fail "$1: $answer"; }
# until_is LINE PATTERN: waits until that line's answer matches.
until_is() {
  local end=$((SECONDS + longest_s))
  while ((SECONDS < end)); do
    ask "$1"
    [[ $answer =~ $2 ]] && return 0
    sleep 0.1
  done
  fail "$1 never matches $2: $answer"
}
# moves COMMAND...: runs it, and waits until the tool has left its place and rests: picture, hand and servo follow one by one.
moves() {
  local end=$((SECONDS + longest_s)) first= last= rested=0
  ask state
  first=$(triple tool_at)
  "$@"
  while ((SECONDS < end)); do
    ask state
    if [[ $(triple tool_at) == "$first" || $(triple tool_at) != "$last" ]]; then
      rested=$(field time)
    elif awk -v a="$rested" -v b="$(field time)" 'BEGIN { exit b - a < 0.2 }'; then
      return 0
    fi
    last=$(triple tool_at)
    sleep 0.05
  done
  fail "the tool does not move, or never rests, after: $*: $answer"
}
# step DX DY DZ: moves the tool by so much, and waits until it has begun to follow. What is held down moves on for as long as a busy
# machine takes to hear that it is released; steps go no further than they are asked to.
step() {
  local end=$((SECONDS + longest_s)) before=
  ask state
  before=$(triple tool_at)
  ok "move $1 $2 $3"
  while ask state && [[ $(triple tool_at) == "$before" ]]; do
    ((SECONDS < end)) || fail "the tool does not follow: $answer"
  done
}
# press_on KEY: holds a key down until the tool moves.
press_on() {
  local end=$((SECONDS + longest_s)) before=
  ask state
  before=$(triple tool_at)
  xdotool keydown "$1"
  while ask state && [[ $(triple tool_at) == "$before" ]]; do
    ((SECONDS < end)) || fail "$1 does not move the tool: $answer"
  done
  xdotool keyup "$1"
}
# until_file FILE: waits until it is there.
until_file() {
  local end=$((SECONDS + longest_s))
  while ((SECONDS < end)); do [[ -s $1 ]] && return 0; sleep 0.1; done
  fail "it was never written: $1"
}
# field NAME, triple NAME: the word, or the three numbers, after that name in the answer.
field() { sed -E "s/.*\b$1 ([^ ]+).*/\1/" <<<"$answer"; }
triple() { sed -E "s/.* $1 ([^ ]+) ([^ ]+) ([^ ]+).*/\1 \2 \3/" <<<"$answer"; }
# ended: waits for the session's end; its exit code into `code`.
ended() {
  exec 4>&-
  code=0
  wait $sim || code=$?
  sim=
}
# finish CODE: the session ends, with that code.
finish() {
  ended
  [[ $code == "$1" ]] || fail_with_session "exit code $code instead of $1"
}
