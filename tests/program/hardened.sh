#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# No binary that is built or installed looks for libraries in the working folder, and the programs' tables of addresses are
# read-only from the start. deb.sh asks the same of the packages.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/hardened_common.sh"
command -v readelf >/dev/null || skip "no readelf"
bin=$(dirname "$TREPHINE")

programs=(trephine trephine-sim trephine-itk)
[[ ! -e $bin/trephine-tetra ]] || programs+=(trephine-tetra)  # TREPHINE_TETRA
for program in "${programs[@]}"; do is_hardened "$bin/$program"; done
for library in mesh_formats dicom_codecs hdf5_writer; do is_hardened "$BUILD/lib/trephine/$library.so"; done
for path in '/a:' ':/a' '/a::/b' 'lib' '/a:lib' ''; do  # each of these is found
  ! (readelf() { echo " 0x1d (RUNPATH)            Library runpath: [$path]"; }; has_whole_run_path fake) 2>/dev/null || [[ -z $path ]] \
    || fail "a run path of '$path' was not found"
done
count=0
while IFS= read -r file; do
  readelf -h "$file" >/dev/null 2>&1 || continue
  has_whole_run_path "$file"
  count=$((count + 1))
done < <(find "$bin" "$BUILD/tests" "$BUILD/lib/trephine" -type f \( -perm -u+x -o -name '*.so' \) 2>/dev/null)
[[ $count -ge 3 ]] || fail "only $count binaries were looked at"

# What the programs load is not taken from the working folder, whatever lies there: these are no libraries at all.
mkdir "$work/here"
cd "$work/here"
for program in trephine trephine-sim trephine-itk; do
  ldd "$bin/$program" | sed -n 's/^\t\([^ /]*\) => .*/\1/p' | while read -r name; do echo no >"$name"; done
done
[[ $(ls | wc -l) -ge 20 ]] || fail "ldd named hardly any library"
"$bin/trephine" --version >/dev/null || fail "trephine takes a library from the working folder"
"$bin/trephine-sim" --version >/dev/null || fail "trephine-sim takes a library from the working folder"
code=0; "$bin/trephine-itk" >out 2>&1 || code=$?
[[ $code == 64 ]] || { cat out; fail "trephine-itk takes a library from the working folder: $code"; }

# Every object of our libraries says that its functions begin with landing pads.
if [[ -n ${COMPILED_HARDENED:-} && $(uname -m) == x86_64 ]]; then
  for library in "$BUILD"/lib/{base,grid,dicom,voxel}/libtrephine_*.a; do
    objects=$(ar t "$library" | wc -l)
    with=$(readelf -n "$library" | grep -c 'x86 feature: IBT, SHSTK' || true)
    [[ $objects -gt 0 && $with == "$objects" ]] || fail "$library: $with of $objects objects have landing pads"
  done
fi

# Installed.
cmake --install "$BUILD" --prefix "$work/installed" --component programs >"$work/log" 2>&1 || { cat "$work/log"; fail "cmake --install"; }
for program in "${programs[@]}"; do is_hardened "$work/installed/bin/$program"; done
for library in mesh_formats dicom_codecs hdf5_writer; do is_hardened "$work/installed/lib/trephine/$library.so"; done
echo ok
