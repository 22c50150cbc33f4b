#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What those who compute get: tetrahedra (.vtu, .msh) and a model for Gazebo (SDF), the same bytes whatever the threads, read by others; and
# what is refused. LONG=1: Gmsh and CalculiX too, and a whole head.
. "$(dirname "$0")/common.sh"
python3=/usr/bin/python3
"$python3" -c 'import numpy' 2>/dev/null || skip "no python3-numpy"
"$WRITE_CASE" "$work/sample" play
export_() { "$TREPHINE" export "$@"; }
export_ "$work/sample" --format tetra-msh,tetra-vtu,sdf --size-mm 5 --densities skull=1900 --out "$work/a" --report "$work/report.json" >"$work/said" ||
  fail "no export"
grep -q 'tetrahedra and .* triangles of borders' "$work/said" && grep -q '^skull  *[0-9]' "$work/said" || { cat "$work/said"; fail "says nothing of them"; }
mv "$work/report.json" "$work/a/"
for n in 1 2; do export_ "$work/sample" --format tetra-msh,tetra-vtu,sdf --size-mm 5 --densities skull=1900 --out "$work/b$n" --threads $n --quiet; done
rm -f "$work"/b?/report.json
diff -r "$work/b1" "$work/b2" && diff -r -x report.json "$work/a" "$work/b1" || fail "other bytes"
check=()
if pkg-config --exists sdformat12 2>/dev/null; then
  # shellcheck disable=SC2046
  g++ -std=c++17 -O0 "$SOURCE/tests/program/sdf_check.cpp" -o "$work/sdf_check" $(pkg-config --cflags --libs sdformat12) || fail "does not compile"
  "$work/sdf_check" "$work/a/sample/model.sdf" >"$work/sdf" 2>&1 || { cat "$work/sdf"; fail "libsdformat refuses the model"; }
  check=("$work/sdf")
elif [[ ${TREPHINE_CHECK:-} == 1 ]]; then
  fail "no libsdformat-dev"
else
  echo "libsdformat-dev is not installed: the model was not read by it"
fi
"$python3" "$SOURCE/tests/program/solids.py" "$SOURCE" "$work/sample" "$work/a" "${check[@]}" || fail "what is written"

# A single surface, by its own name.
export_ "$work/sample" --format obj --anatomy brain --out "$work/one" --quiet
export_ "$work/one/brain.obj" --format tetra-msh,sdf --name lump --size-mm 8 --out "$work/one" --quiet
grep -q '"lump"' "$work/one/lump.msh" && [[ -s $work/one/lump/model.sdf && -s $work/one/lump/lump_collision.obj ]] || fail "one surface"

refused() { expect "$1" "$2" export_ "$work/sample" --out "$work/no" "${@:3}"; [[ ! -e $work/no ]] || fail "half an output"; }
refused 64 'bones=1900: there is no surface' --format sdf --densities bones=1900
refused 64 'skull=heavy: must be' --format sdf --densities skull=heavy
refused 64 'size-mm' --format tetra-msh --size-mm 0
refused 64 'size-mm: 0.2: that are some' --format tetra-msh --size-mm 0.2
refused 64 'tetra-vtk' --format tetra-vtk
refused 80 'its tetrahedra fill .* ml' --format tetra-msh --size-mm 100 --border-mm 20
mkdir -p "$work/alone/bin" && cp "$TREPHINE" "$work/alone/bin/" && cp -r "$(dirname "$TREPHINE")/../lib" "$work/alone/" 2>/dev/null
expect 70 'trephine-tetra: is missing.*TREPHINE_TETRA' "$work/alone/bin/trephine" export "$work/sample" --format tetra-msh --out "$work/no"
[[ ! -e $work/no ]] || fail "half an output"
((LONG == 1)) || exit 0

command -v gmsh >/dev/null || skip "no gmsh"
gmsh -check "$work/a/sample.msh" >"$work/gmsh" 2>&1 || fail "gmsh refuses the mesh"
! grep -iE 'warning|error' "$work/gmsh" || fail "gmsh finds a fault"
command -v ccx >/dev/null || skip "no calculix-ccx"
example=$SOURCE/examples/pressed_brain/press.py
(($(wc -l <"$example") < 60)) || fail "the example is long"
# pressed MESH REGIONS LIMIT: the known answer to within LIMIT of it, and a spatula's dent that is one.
pressed() {
  mkdir -p "$work/press"
  "$python3" "$example" "$1" "$2" "$work/press" >"$work/said" || fail "the example"
  cat "$work/said"
  "$python3" - "$work/said" "$3" <<'PY'
import re, sys
squeezed, pressed = open(sys.argv[1]).read().splitlines()
off = float(re.search(r"off by at most (\S+)", squeezed).group(1))
most, down = (float(n) for n in re.search(r": (\S+) mm at most, (\S+) mm", pressed).groups())
assert off < float(sys.argv[2]), squeezed
assert 0.3 < down <= most < 20, pressed
PY
}
pressed "$work/a/sample.msh" brain 1e-6
"$TREPHINE" run --quiet "$SOURCE/configs/sample.yaml" --root "$SOURCE" --out "$work/library" --set "resample.spacing_mm=[1.5,1.5,1.5]" --no-pictures \
  --no-page || fail "no case of a head"
export_ "$work/library/sample" --format tetra-msh,sdf --size-mm 6 --out "$work/head"
export_ "$work/library/sample" --format tetra-msh --size-mm 6 --out "$work/again" --quiet
cmp "$work/head/sample.msh" "$work/again/sample.msh" || fail "another mesh"  # CGAL's own limits of time would make one
pressed "$work/head/sample.msh" brain,midline,ventricles,third_ventricle,brainstem,sagittal_sinus 1e-5
