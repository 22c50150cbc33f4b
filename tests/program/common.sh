# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the scripts here. TREPHINE is the program, SOURCE the repository. Each script is one CTest test.
set -euo pipefail
: "${TREPHINE:?}" "${SOURCE:?}"
work=$(mktemp -d)
trap 'chmod -R u+w "$work" 2>/dev/null; rm -rf "$work"' EXIT

# The default suites work on coarse voxels, the long ones (LONG=1) on the scan's own.
: "${LONG:=0}"
coarse=(--set "resample.spacing_mm=[2.5,2.5,2.5]")
# For what does not look at the shapes: coarser still, and so is what is felt. It needs a scene with a haptic volume.
coarsest=(--set "resample.spacing_mm=[3.5,3.5,3.5]" --set "haptic.spacing_mm=[2,2,2]")
((LONG == 0)) || coarse=() coarsest=()

# long_only: what follows is done by the long suite alone, by the script's twin program.LongRest_NAME (tests/CMakeLists.txt).
long_only() { ((LONG)) || [[ ${WHOLE:-0} == 1 ]] || { echo "ok; the rest is for the long suite"; exit 0; }; }

fail() { echo "FAILED: $*" >&2; exit 1; }
# skip WHY: what the test needs is missing. In ./check, which installs it, that is a failure.
skip() { [[ ${TREPHINE_CHECK:-} != 1 ]] || fail "$*"; echo "skipped: $*"; exit 77; }

# expect CODE PATTERN COMMAND...: the command ends with CODE and prints exactly one line on stderr that matches PATTERN.
expect() {
  local code=$1 pattern=$2 got=0
  shift 2
  "$@" >"$work/stdout" 2>"$work/stderr" || got=$?
  [[ $got == "$code" ]] || { cat "$work/stderr" >&2; fail "exit code $got instead of $code: $*"; }
  [[ $(wc -l <"$work/stderr") == 1 ]] || { cat "$work/stderr" >&2; fail "not one line on stderr: $*"; }
  grep -Eq -- "$pattern" "$work/stderr" || { cat "$work/stderr" >&2; fail "stderr does not match '$pattern': $*"; }
}

# refuses CODE PATTERN COMMAND...: as expect, where warnings precede the line. What it says is in ./said.
refuses() {
  local code=$1 pattern=$2 got=0
  shift 2
  "$@" >/dev/null 2>said || got=$?
  [[ $got == "$code" ]] && tail -n 1 said | grep -Eq -- "$pattern" || fail "exit code $got of $*: $(cat said)"
}

# interrupted COMMAND...: Ctrl-C while it runs, into `code`; stdout and stderr go to $work/said. It is sent once the program listens
# for it (a background process of a shell ignores it before) and has run a little; a command that ends before that is tried again.
interrupted() {
  local delay try pid
  for delay in 0.4 0.3 0.2 0.1 0.05 0.02 0; do
    "$@" >"$work/said" 2>&1 &
    pid=$!
    for try in {1..3000}; do
      (($((16#$(sed -n 's/^SigCgt:[[:space:]]*//p' /proc/$pid/status 2>/dev/null || true)0)) & 0x20)) && break
      [[ -e /proc/$pid ]] || break
      sleep 0.01
    done
    sleep $delay
    code=0
    if kill -INT $pid 2>/dev/null; then
      wait $pid || code=$?
      ((code == 0)) || return 0  # 0: its last step was done when the signal came
    else
      wait $pid || { code=$?; return 0; }
    fi
  done
  fail "ends before it can be interrupted: $*"
}

# The case's bytes: case.json and every file that it names, each of which must be there and whole.
case_digest() {
  python3 - "$1" <<'PY'
import hashlib, json, pathlib, sys
case = pathlib.Path(sys.argv[1])
manifest = (case / "case.json").read_bytes()
for f in json.loads(manifest)["files"]:
    assert hashlib.sha256((case / f["name"]).read_bytes()).hexdigest() == f["sha256"], f["name"]
print(hashlib.sha256(manifest).hexdigest())
PY
}
