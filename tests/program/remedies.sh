#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What a refusal says to do is done, word for word, and works.
. "$(dirname "$0")/common.sh"
python3 "$(dirname "$0")/remedies.py" "$TREPHINE" "$SOURCE" "$work"
