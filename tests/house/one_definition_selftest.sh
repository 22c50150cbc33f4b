#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# one_definition_selftest.sh SCRIPT COMPILER: the check finds a twin and a file outside of its room's namespace.
set -u
script=$1 compiler=$2
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/lib/{base,voxel,boolean}
echo 'namespace trephine { struct Vec3 {}; }' > "$tree/lib/base/vec3.h"
echo 'namespace trephine::voxel { struct Cutter { int a; }; }' > "$tree/lib/voxel/cutter.h"
echo 'namespace trephine::boolean { struct Cutter { double b; }; }' > "$tree/lib/boolean/cutter.h"
bash "$script" "$tree" "$compiler" || { echo "a good tree is refused"; exit 1; }
echo 'namespace trephine::voxel { struct Cutter { int c; }; }' > "$tree/lib/voxel/other.h"
bash "$script" "$tree" "$compiler" > "$tree/said" && { echo "a twin is not found"; exit 1; }
grep -q Cutter "$tree/said" || { cat "$tree/said"; echo "the twin is not named"; exit 1; }
printf 'namespace trephine {\nstruct Drill {};\n}\n' > "$tree/lib/voxel/other.h"
bash "$script" "$tree" "$compiler" > "$tree/said" && { echo "a file outside of its room is not found"; exit 1; }
grep -q 'lib/voxel/other.h' "$tree/said" || { cat "$tree/said"; exit 1; }
