#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A device behind a shared library, with a stub for the vendor's: it is found, held, felt, and lost.
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/sample" drill
servo=("$TREPHINE" servo "$work/sample" --device adaptor --adaptor "$STUB" --no-realtime --max-step-s 3600)

# On a machine under load the stub's thread may wait for longer than the 50 ms that are usual.
TREPHINE_STUB=tells "${servo[@]}" --adaptor-timeout-ms 10000 --seconds 1.5 --json "$work/a.json" >"$work/text" 2>"$work/stub" || { cat "$work/text"; fail "does not run"; }
grep -q '^holding stub 0$' "$work/text" || { cat "$work/text"; fail "does not say what it holds"; }
grep -Eq '^stub closed after (0\.[1-9]|1|2)' "$work/stub" || { cat "$work/stub"; fail "the device felt no force, or too much"; }
python3 - "$work/a.json" <<'PY'
import json, sys
d = json.load(open(sys.argv[1]))
assert d["device"] == "adaptor" and d["faults"] == 0 and d["touching_ratio"] > 0.3, d
assert d["device_counts"]["poses"] > 100, d
PY
expect 74 'device lost' "${servo[@]}" --adaptor-index 1 --seconds 3
expect 66 'adaptor_index: 5: the devices that are there: 0 stub 0, 1 stub 1' "${servo[@]}" --adaptor-index 5 --seconds 1
TREPHINE_STUB=none expect 66 'no device is there' "${servo[@]}" --seconds 1
TREPHINE_STUB=fails expect 74 'open: the cable is out' "${servo[@]}" --seconds 1
TREPHINE_STUB=later expect 65 'version: 7, this program uses 1' "${servo[@]}" --seconds 1
expect 65 'is no library' "$TREPHINE" servo "$work/sample" --device adaptor --adaptor "$work/text" --seconds 1
expect 64 '[-]-no-paced' "${servo[@]}" --no-paced --seconds 1
