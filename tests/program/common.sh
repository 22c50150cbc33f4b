# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the scripts here. TREPHINE is the program, SOURCE the repository. Each script is one CTest test.
set -euo pipefail
: "${TREPHINE:?}" "${SOURCE:?}"
work=$(mktemp -d)
trap 'chmod -R u+w "$work" 2>/dev/null; rm -rf "$work"' EXIT

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
