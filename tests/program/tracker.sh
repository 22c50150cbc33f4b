# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced, after common.sh, by the scripts with a fake tracker (track_fake_server.cpp). Nothing waits for a time: the fake is told what
# to do, and says when it does.
: "${SERVER:?}" "${WRITE_CASE:?}"
coproc TRACKER { exec "$SERVER" serve 0.1; }
tracker_in=${TRACKER[1]} tracker_out=${TRACKER[0]}
read -r port <&"$tracker_out"
tracker() { echo "$*" >&"$tracker_in"; read -r answer <&"$tracker_out"; [[ $answer == ok ]] || fail "the fake says $answer"; }
link=(--tracker-port "$port" --tracker-wait-s 120)

# steps ACTIONS -- COMMAND...: runs it; each time that it waits for Enter, the fake does the next action first. Output is in $work/said,
# the exit code in `code`.
steps() {
  local actions=() action n=0
  while [[ $1 != -- ]]; do actions+=("$1"); shift; done
  shift
  rm -f "$work/keys"; mkfifo "$work/keys"
  "$@" <"$work/keys" >"$work/said" 2>"$work/stderr" &
  local pid=$!
  exec 9>"$work/keys"
  for action in "${actions[@]}"; do
    n=$((n + 1))
    until (($(grep -c 'press Enter$' "$work/said" || true) >= n)) || [[ ! -e /proc/$pid ]]; do sleep 0.02; done
    [[ -e /proc/$pid ]] || break
    tracker "$action"
    echo >&9
  done
  code=0; wait $pid || code=$?
  exec 9>&-
}
well() { [[ $code == 0 && ! -s $work/stderr ]] || fail "$1: exit code $code: $(cat "$work/said" "$work/stderr")"; }
refused_as() {  # CODE PATTERN
  [[ $code == "$1" && $(wc -l <"$work/stderr") == 1 ]] && grep -Eq -- "$2" "$work/stderr" || fail "exit code $code: $(cat "$work/stderr")"
}
