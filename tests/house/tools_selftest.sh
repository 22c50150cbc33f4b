#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tools_selftest.sh SCRIPT: the check finds a tool's name that is compared, and no other use of it.
set -u
script=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{lib,tools,simulator/haptics,simulator/window}
if bash "$script" "$tree" > "$tree/said" 2>&1; then echo "no list of kinds, and no fault"; exit 1; fi
printf '  Kind("burr", "Bohrer", "a ball"),\n  Kind("round_burr", "Rundbohrer", "a ball"),\n' > "$tree/simulator/haptics/tool_kinds.cpp"
cat > "$tree/simulator/window/good.cpp" << 'END'
ToolParams burr; burr.tool = "burr"; if (name == "burr") step(); t = tool_of("burr", "burr");
if (tool_kind(p.tool).cuts()) drill(); if (tool == "spoon") {}
END
bash "$script" "$tree" || { echo "a good tree is refused"; exit 1; }
expect_fault() {  # LINE
  echo "$1" > "$tree/simulator/window/bad.cpp"
  if bash "$script" "$tree" > "$tree/said"; then echo "not found: $1"; exit 1; fi
  grep -q "^simulator/window/bad.cpp:1:" "$tree/said" || { cat "$tree/said"; echo "not named: $1"; exit 1; }
}
expect_fault 'if (tool.tool == "burr") cut();'
expect_fault 'return tool_name_ != "round_burr";'
expect_fault 'if ("burr" == o.session.tool.tool) cut();'
expect_fault 'if (std::strcmp(tool_name(), "burr") == 0) cut();'
