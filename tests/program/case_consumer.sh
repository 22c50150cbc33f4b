#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Somebody else's programs: TrephineCase installed into an empty folder, and examples/case_reader and examples/contact built
# and run with it.
. "$(dirname "$0")/common.sh"
prefix=$work/prefix
cmake --install "$BUILD" --prefix "$prefix" --component development >"$work/log" || { cat "$work/log"; fail "install"; }
package=$(dirname "$(find "$prefix" -name TrephineCaseConfig.cmake)")
! grep -rnE "$SOURCE|$BUILD" "$package" || fail "the package knows where it was built"
! grep -rniE 'vtk|itk|cgal|gdcm|yaml|nlohmann|cli11|tinygltf' "$package" || fail "the package asks for these"

# Moved after it was installed, and read from a copy of the example outside the repository.
mv "$prefix" "$work/moved"
cp -r "$SOURCE/examples/case_reader" "$work/example"
cmake -S "$work/example" -B "$work/build" -G Ninja -DCMAKE_PREFIX_PATH="$work/moved" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_CXX_FLAGS='-Wall -Wextra -Werror' >"$work/log" 2>&1 || { cat "$work/log"; fail "configure"; }
cmake --build "$work/build" >"$work/log" 2>&1 || { cat "$work/log"; fail "build"; }
! ldd "$work/build/case_reader" | grep -iE 'lib(itk|gdcm|cgal|yaml-cpp|vtk|gmp|mpfr|png)|not found' || fail "case_reader loads these"

"$WRITE_CASE" "$work/sample"
"$work/build/case_reader" "$work/sample" >"$work/said"
# A point that goes down the z axis from 20 mm above the entry, at 110 mm from the middle (z 300) of two balls: radius 80 and 40 mm,
# 3 % more along z. Millimetres count from the place that is printed.
awk '
  /^from 1, -20, 410 mm \(LPS\), 20 mm before the entry:$/ { from = 1 }
  /^outer: 168 triangles$/ { a = 1 } /^inner: 48 triangles$/ { b = 1 }
  / into outer / { d = $1 - (110 - 80 * 1.03); c += (d < 4 && d > -4) }
  / into inner / { d = $1 - (110 - 40 * 1.03); c += (d < 4 && d > -4) }
  / out of inner / { d = $1 - (110 + 40 * 1.03); c += (d < 4 && d > -4) }
  / out of outer / { d = $1 - (110 + 80 * 1.03); c += (d < 4 && d > -4) }
  END { exit !(from && a && b && c >= 4) }' "$work/said" || { cat "$work/said"; fail "the ray"; }
printf x >>"$work/sample/case.json"
expect 65 'case_reader: .*case\.json: checksum' "$work/build/case_reader" "$work/sample"

# The C interface, from a program in C.
cp -r "$SOURCE/examples/contact" "$work/contact"
cmake -S "$work/contact" -B "$work/contact/build" -G Ninja -DCMAKE_PREFIX_PATH="$work/moved" \
  -DCMAKE_C_FLAGS='-pedantic -Wall -Wextra -Werror' >"$work/log" 2>&1 || { cat "$work/log"; fail "configure contact"; }
cmake --build "$work/contact/build" >"$work/log" 2>&1 || { cat "$work/log"; fail "build contact"; }
"$work/contact/build/contact" >"$work/said" || { cat "$work/said"; fail "contact"; }
[[ $(grep -c '^front of shape 2 at ' "$work/said") == 6 ]] || { cat "$work/said"; fail "the ball was not met from six sides"; }

# Every header compiles alone, with the package's own folder only.
include=$work/moved/include/trephine
(cd "$include" && find . -name '*.h') >"$work/headers"
[[ $(wc -l <"$work/headers") -ge 20 ]] || fail "$(wc -l <"$work/headers") headers are installed"
while read -r header; do
  echo "#include \"$header\"" | c++ -std=c++17 -fsyntax-only -I"$include" -x c++ - || fail "$header needs what is not installed"
done <"$work/headers"

# Who writes an adaptor for a device needs its header, in C.
"${CC:-cc}" -std=c99 -pedantic -Wall -Wextra -Werror -shared -fPIC -I"$include" -o "$work/adaptor.so" "$SOURCE/tests/adaptor_stub.c" ||
  fail "no adaptor can be made with what is installed"

# A plug-in: all of it within a shared library.
c++ -shared -o "$work/plugin.so" -Wl,--whole-archive $(find "$work/moved" -name "libtrephine_*.a") \
  -Wl,--no-whole-archive -Wl,-z,defs -lfmt -lcrypto -ltbb -lz 2>"$work/log" || { cat "$work/log"; fail "no shared library can be made of it"; }
