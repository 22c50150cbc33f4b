#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The schema of case.json and the loader agree on what case.json holds.
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/sample"
offline=$(dirname "$TREPHINE")/trephine
[[ -x $offline ]] || { echo "skipped: this build has no trephine, which knows the schema"; exit 77; }
"$offline" schema case >"$work/case.schema.json"
python3 "$SOURCE/tests/program/case_schema.py" "$work/case.schema.json" "$work/sample" "$TREPHINE"
