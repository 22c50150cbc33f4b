#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A case whose every text holds sequences that control a terminal: no command of either program lets one through, and no text makes
# a second line of its own.
. "$(dirname "$0")/common.sh"
library=$work/library case=$work/library/sample
"$WRITE_CASE" "$case"
python3 - "$case" <<'PY'
import hashlib, json, pathlib, sys
case = pathlib.Path(sys.argv[1])
body = json.loads((case / "case.json").read_text())
head = '{\n "format": ' + json.dumps(body["format"]) + ","
del body["format"], body["checksum"]
bad = "x\x1b[31m\x07\x9b2J\r\nsample: FORGED"
body["landmarks"][0]["name"] = bad
body["targets"][0]["name"] = body["targets"][0]["anatomy"] = bad
body["burr_holes"][0]["name"] = bad
body["burr_holes"][0]["figures"]["note " + bad] = bad
body["haptic"]["shapes"][0]["material"]["name"] = bad
body["provenance"]["program"] = "trephine " + bad
body["provenance"]["parameters"]["p" + bad] = bad
body["face"]["reason"] = bad
body["figures"] = {"class": "normal", "class_of": bad, "note": bad, "n" + bad: bad}
body["missing"] = [{"anatomy": "a" + bad, "why": bad}]
text = head + json.dumps(body, indent=1)[1:-2]
text += ',\n "checksum": "' + hashlib.sha256(text.encode()).hexdigest() + '"\n}\n'
(case / "case.json").write_text(text)
(case / "run.json").write_text(json.dumps({"warnings": [bad], "seconds": 1}))
PY
plain() {  # COMMAND...: nothing in what it says controls a terminal
  local code=0
  "$@" >"$work/said" 2>&1 </dev/null || code=$?
  case $code in 0 | 64 | 65 | 66 | 80 | 81) ;; *) cat -v "$work/said"; fail "exit code $code: $*" ;; esac
  [[ -s $work/said ]] || fail "says nothing: $*"
  ! LC_ALL=C grep -nP '[\x00-\x08\x0b-\x1f\x7f]|\xc2[\x80-\x9f]' "$work/said" | cat -v | grep . || fail "controls the terminal: $*"
  ! grep -n '^sample: FORGED' "$work/said" || fail "makes a line of its own: $*"
  if [[ $code == 0 ]]; then good+=("$*"); fi
}
good=()
plain "$TREPHINE" library show "$library" sample
plain "$TREPHINE" library list "$library"
plain "$TREPHINE" library list "$library" --json /dev/stdout
plain "$TREPHINE" library verify "$library"
plain "$TREPHINE" library gc "$library"
plain "$TREPHINE" diff "$case" "$case"
plain "$TREPHINE" export "$case" --format stl --output "$work/e"
plain "$TREPHINE" export "$case" --format mrk.json --output "$work/e2"
plain "$TREPHINE" page "$case" --output "$work/p.html"
plain "$TREPHINE" library approve "$case" --by somebody
plain "$SIM" check "$case"
plain "$SIM" check "$case" --json
plain "$SIM" servo "$case" --seconds 0.1
plain "$SIM" exercise "$library" --help
((${#good[@]} >= 7)) || { printf '%s\n' "${good[@]}"; fail "hardly any command took the case"; }
grep -q 'x?' <("$TREPHINE" library show "$library" sample) || fail "library show does not show the text"
# A text is cut nowhere, whatever its language.
plain "$TREPHINE" run "$work/Größe-$(printf '\033[31m')ζ.yaml" --out "$work/out"
grep -q 'Größe-?\[31mζ' "$work/said" || { cat -v "$work/said"; fail "letters are lost"; }
echo ok
