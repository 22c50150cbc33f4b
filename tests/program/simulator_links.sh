#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The simulator loads nothing of the offline toolchain.
. "$(dirname "$0")/common.sh"
ldd "$TREPHINE" >"$work/libraries"
grep -q 'libstdc++' "$work/libraries" || fail "ldd says nothing: $(cat "$work/libraries")"
! grep 'not found' "$work/libraries" || fail "a library is missing"
! grep -iE 'lib(itk|gdcm|cgal|yaml-cpp|vtk|gmp|mpfr|assimp|tinygltf|png|hdf5|zip|openigtlink)' "$work/libraries" ||
  fail "the simulator loads these"
