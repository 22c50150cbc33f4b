#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# anatomies_selftest.sh SCRIPT: the check finds names of anatomies in literals, and nothing in comments and sentences.
set -u
script=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/lib/{pipeline,publish,library,head,stages} "$tree/pipelines"
printf 'trephine: 1\nanatomies:\n  skull:\n    stages: []\n  skin:\n  brain:\n  ventricles:\nlandmarks:\n  mean: 1\n' >"$tree/pipelines/a.yaml"
printf 'trephine: 1\nanatomies:\n  other_bone:\n  canal:\n  vein:\n  clavicle:\n' >"$tree/pipelines/b.yaml"
printf '  s.points = {{"nasion", SlicePlane::sagittal},\n              {"monro_left", SlicePlane::axial}};\n' >"$tree/lib/stages/l_stage.cpp"
cat > "$tree/lib/pipeline/good.cpp" << 'END'
// A "skull" here is no fault, nor is "mesh.skull." /* "skin" */
/* "brain"
   "ventricles_ml" */
const char* a = "% in the bone removed; see http://x";  // "vein"
const char* b = "skins and bones", *c = "a \"quoted word\" of it", *d = R"(any text)";
std::string skull = name + ".removed_mm3", f = "mean." + g, h = "_left";
const char e = '"';
END
echo 'const char* name = "skull";' > "$tree/lib/head/skull.cpp"
cp "$tree/lib/pipeline/good.cpp" "$tree/lib/publish/good.h"
cp "$tree/lib/pipeline/good.cpp" "$tree/lib/library/good.cpp"
bash "$script" "$tree" || { echo "a good tree is refused"; exit 1; }

expect_fault() {  # FILE LINE: adding the line to the file is a fault, named with its number
  cp "$tree/$1" "$tree/before"
  echo "$2" >> "$tree/$1"
  if bash "$script" "$tree" > "$tree/said"; then echo "not found: $2 in $1"; exit 1; fi
  grep -q "^$1:$(wc -l < "$tree/$1"): " "$tree/said" || { cat "$tree/said"; echo "not named: $2 in $1"; exit 1; }
  mv "$tree/before" "$tree/$1"
}
for name in skull skin brain ventricles bone canal vein clavicle nasion monro; do
  expect_fault lib/pipeline/good.cpp "if (anatomy == \"$name\") return;"
done
expect_fault lib/publish/good.h 'const auto v = figure("mesh.skull.removed_mm3");'
expect_fault lib/publish/good.h 'add("ventricles_ml", 1);  // millilitres'
expect_fault lib/library/good.cpp 'add("volume_of_brain", 1);'
expect_fault lib/library/good.cpp "add('\"', \"x\\\"skin.\");"
expect_fault lib/library/good.cpp 'add(R"(mesh.vein)");'
