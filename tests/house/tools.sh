#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tools.sh ROOT: what a tool of the hand can do is asked of its ToolKind; no source but the kinds compares its name.
set -u
cd "$1" || exit 2
kinds=simulator/haptics/tool_kinds.cpp
names=$(grep -oE '\bKind\("[a-z_]+"' "$kinds" | sed 's/.*"\(.*\)"/\1/' | paste -sd'|')
[ -n "$names" ] || { echo "$kinds: names no kind"; exit 1; }
operand='[A-Za-z_.()>-]*tool[A-Za-z_.()>-]*'
found=$(grep -rnE --include='*.h' --include='*.cpp' \
  -e "$operand *[!=]= *\"($names)\"" -e "\"($names)\" *[!=]= *$operand" \
  -e "$operand(\.compare|\.starts_with|\.find)\(\"($names)\"" -e "(strcmp|contains)\($operand, *\"($names)\"" \
  simulator lib tools | grep -v "^$kinds:")
[ -z "$found" ] || { printf '%s\n' "$found"; echo "ask the tool's ToolKind (CONTRIBUTING.md, \"Add a tool of the hand\")"; exit 1; }
