#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# sizes_selftest.sh SCRIPT: the check names a file, a room, a class, a script and its function that are too large, and nothing at the
# limits.
set -u
script=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/lib/{grid,mask} "$tree"/simulator/window "$tree"/tests/deep
seq 400 > "$tree/lib/grid/a.cpp"
for n in $(seq 14); do cp "$tree/lib/grid/a.cpp" "$tree/lib/grid/a$n.h"; done
cp "$tree"/lib/grid/* "$tree/simulator/window"
mkdir -p "$tree"/simulator/lessons/needle
cp "$tree"/lib/grid/* "$tree/simulator/lessons"
cp "$tree"/lib/grid/* "$tree/simulator/lessons/needle"
seq 400 > "$tree/tests/deep/b.cpp"
seq 900 > "$tree/lib/grid/notes.md"
# A class of 25 methods in two files, with what is none: accessors, a function object, what is defaulted, a class in a class.
{
  echo 'class Full : public Base<int> {'
  echo ' public:'
  echo '  Full() = default;'
  for n in $(seq 24); do echo "  std::vector<std::pair<int, int>> method_$n(const std::string& a, int b = f({1}));"; done
  printf '  int size() const { return size_; }\n  std::function<void(int)> call;\n  int size_ = f(1), other_{2};\n'
  printf '  void long_one() {\n    a();\n    b();\n  }\n'
  printf '  struct Part {\n    void one();\n    void two();\n  };\n};\n'
} > "$tree/lib/mask/full.h"
{ echo 'void Full::method_1(int) {'; seq -f 'a(%g);' 500; echo '}'; } | head -390 > "$tree/lib/mask/full.cpp"
echo '}' >> "$tree/lib/mask/full.cpp"
mkdir -p "$tree/web/part"
{
  echo "const text = 'function {', pattern = /[{(]/"
  echo 'function most(a) {'
  seq -f '  call(%g, { a: 1 })' 126
  printf '  if (a) {\n  }\n}\n'
  seq -f '// %g' 268
  printf '%130s\n' '//'
} > "$tree/web/part/a.js"
printf '%130s\n' . > "$tree/web/a.css"
python3 "$script" "$tree" || { echo "a tree at its limits is refused"; exit 1; }

expect_fault() {  # FILE NAMED [LINE]: a line more in the file, and how what is named begins
  touch "$tree/$1"
  cp "$tree/$1" "$tree/before"
  echo "${3:-more}" >> "$tree/$1"
  if python3 "$script" "$tree" > "$tree/said"; then echo "not found: $1 makes $2 too long"; exit 1; fi
  grep -q "^$2" "$tree/said" || { cat "$tree/said"; echo "$2 is not named"; exit 1; }
  mv "$tree/before" "$tree/$1"
}
expect_fault lib/grid/a.cpp lib/grid/a.cpp:
expect_fault tests/deep/b.cpp tests/deep/b.cpp:
expect_fault lib/grid/small.h lib/grid:
expect_fault simulator/window/small.h simulator/window:
expect_fault simulator/lessons/small.h simulator/lessons:
expect_fault simulator/lessons/needle/small.h simulator/lessons/needle:
expect_fault web/part/a.js web/part/a.js:
expect_fault web/a.css web/a.css:2: "$(printf '%131s' .)"
expect_fault web/part/b.js 'web/part/b.js: text is also a name of web/part/a.js' 'const text = 1'
sed -i 's/^ public:/ public:\n  ~Full();/' "$tree/lib/mask/full.h"
expect_fault lib/mask/b.cpp 'lib/mask/full.h: Full has 26 methods'
sed -i '/~Full/d' "$tree/lib/mask/full.h"
{ echo 'void Full::method_2(int) {'; seq -f 'a(%g);' 300; echo '}'; } > "$tree/lib/mask/full_two.cpp"
expect_fault lib/mask/b.cpp 'lib/mask/full.h: Full has [0-9]* lines in all its files'
rm "$tree/lib/mask/full_two.cpp"
sed -i 's/^  if (a) {/  if (a) {\n/' "$tree/web/part/a.js"
expect_fault web/part/b.js 'web/part/a.js: function most: a function of 131 lines'
