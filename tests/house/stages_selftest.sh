#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# stages_selftest.sh SCRIPT: the check finds a stage's name that is looked for, and no other use of it.
set -u
script=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/lib/{stages,pipeline,publish}
if bash "$script" "$tree" > "$tree/said" 2>&1; then echo "no stage, and no fault"; exit 1; fi
echo '  s.name = "import";' > "$tree/lib/stages/import_stage.cpp"
echo '  s.name = "boolean";' > "$tree/lib/stages/boolean_stage.cpp"
cat > "$tree/lib/publish/good.cpp" << 'END'
graph.find_stage<Import>(scan.name); rows.push_back({"import", "MB"}); warn(name + ".import: has another patient");
END
bash "$script" "$tree" || { echo "a good tree is refused"; exit 1; }
expect_fault() {  # LINE
  echo "$1" > "$tree/lib/pipeline/bad.cpp"
  if bash "$script" "$tree" > "$tree/said"; then echo "not found: $1"; exit 1; fi
  grep -q "^lib/pipeline/bad.cpp:1:" "$tree/said" || { cat "$tree/said"; echo "not named: $1"; exit 1; }
}
expect_fault 'const int read = graph.find(scan.name + ".import");'
expect_fault 'if (node == "import") read();'
expect_fault 'anatomy.surface = add(node_with(anatomy.name + ".boolean", params));'
expect_fault 'if (recipe.find_step("boolean")) cut();'
expect_fault 'if (node.compare(node.size() - 7, 7, ".import") != 0) return;'
