#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# include_directions_selftest.sh SCRIPT: the check finds each sort of wrong include, and nothing wrong in a good tree.
set -u
script=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/lib/{base,grid,meshing,cli} "$tree"/{simulator,tools}
echo 'foreach(module base grid meshing cli)' > "$tree/lib/CMakeLists.txt"
echo '#include <string>' > "$tree/lib/base/error.h"
echo '#include "base/error.h"' > "$tree/lib/grid/grid.h"
printf '#include "grid/grid.h"\n#include <CGAL/Kernel.h>\n' > "$tree/lib/meshing/contour.cpp"
echo '#include <vtkPolyData.h>' > "$tree/lib/meshing/private.h"
echo '#include "grid/grid.h"' > "$tree/lib/meshing/contour.h"
echo '#include "meshing/contour.h"' > "$tree/tools/contour.cpp"
echo '#include "cli/command.h"' > "$tree/simulator/main.cpp"
echo '#include "grid/grid.h"' >> "$tree/simulator/main.cpp"
echo '#include "base/error.h"' > "$tree/lib/cli/command.h"
mkdir -p "$tree"/simulator/{lessons/{needle,screw,region},window}
touch "$tree"/simulator/lessons/{needle/needle,screw/screw}_lesson.cpp "$tree/simulator/lessons/region/moves.h" "$tree/simulator/window/hud.h"
echo '#include "base/error.h"' > "$tree/simulator/lessons/needle/needle_rubric.h"
printf '#include "lessons/needle/needle_rubric.h"\n#include "lessons/region/moves.h"\n' > "$tree/simulator/lessons/needle/needle_score.cpp"
printf '#include "lessons/rubric_types.h"\n' > "$tree/tools/rubric.cpp"
touch "$tree"/simulator/lessons/{score,rubric_types}.h
bash "$script" "$tree" || { echo "a good tree is refused"; exit 1; }

expect_fault() {  # FILE LINE: adding the line to the file is a fault
  cp "$tree/$1" "$tree/before"
  echo "$2" >> "$tree/$1"
  if bash "$script" "$tree" > "$tree/said"; then echo "not found: $2 in $1"; exit 1; fi
  grep -q "^lib/\|^tools/\|^simulator/" "$tree/said" || { cat "$tree/said"; echo "no file named for $2 in $1"; exit 1; }
  mv "$tree/before" "$tree/$1"
}
expect_fault lib/base/error.h '#include "grid/grid.h"'
expect_fault lib/grid/grid.h '#  include  <CGAL/Kernel.h>'
expect_fault lib/meshing/contour.cpp '#include <itkImage.h>'
expect_fault lib/meshing/contour.h '#include <vtkPolyData.h>'
expect_fault lib/meshing/contour.h '#include "meshing/private.h"'
expect_fault lib/grid/grid.h '#include <yaml-cpp/yaml.h>'
expect_fault simulator/main.cpp '#include "meshing/contour.h"'
expect_fault simulator/main.cpp '#include <CLI/CLI.hpp>'
expect_fault lib/cli/command.h '#include <CLI/CLI.hpp>'
expect_fault tools/contour.cpp '#include <CLI/CLI.hpp>'
expect_fault simulator/lessons/screw/screw_lesson.cpp '#include "lessons/needle/needle_rubric.h"'
expect_fault simulator/window/hud.h '#include "lessons/needle/needle_rubric.h"'
expect_fault simulator/window/hud.h '#include "lessons/region/moves.h"'
expect_fault simulator/lessons/score.h '#include "lessons/region/moves.h"'
expect_fault simulator/lessons/needle/needle_rubric.h '#include "lessons/score.h"'
expect_fault simulator/lessons/needle/needle_rubric.h '#include "grid/grid.h"'
expect_fault tools/rubric.cpp '#include "lessons/score.h"'
expect_fault simulator/window/hud.h '#include "peers/god_object.h"'
