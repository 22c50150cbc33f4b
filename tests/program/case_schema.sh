#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# docs/reference/trephine/case.schema.json and the loader agree on what case.json holds.
. "$(dirname "$0")/common.sh"
"$WRITE_CASE" "$work/sample"
python3 "$SOURCE/tests/program/case_schema.py" "$SOURCE/docs/reference/trephine/case.schema.json" "$work/sample" "$TREPHINE"
