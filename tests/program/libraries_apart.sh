#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What takes long to load is loaded where it is needed: ITK by trephine-itk alone, VTK, assimp and GDCM by libraries of our own, which
# the programs look for beside themselves and in ../lib/trephine.
set -eu
fail() { echo "FAIL: $1"; exit 1; }
for program in trephine trephine-sim; do
  libraries=$(ldd "$BIN/$program")
  [[ $libraries == *libstdc++* ]] || fail "ldd says nothing of $program"
  for library in ITK itk vtk assimp gdcm; do
    [[ $libraries != *lib$library* ]] || fail "$program loads $library before it begins"
  done
done
[[ $(ldd "$BIN/trephine-itk") == *ITK* ]] || fail "trephine-itk does not load ITK"
code=0; said=$("$BIN/trephine-itk" 2>&1) || code=$?
[[ $code == 64 && $said == *trephine* ]] || fail "trephine-itk by itself: $code: $said"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/alone/bin" "$work/alone/lib/trephine"
cp "$BIN/trephine" "$work/alone/bin"
phantom() { "$work/alone/bin/trephine" phantom "$work/$1" --columns-count 16 --rows-count 16 --slices-count 2 --mesh-step-mm 0 --no-labels --quiet; }
code=0; said=$(phantom none 2>&1) || code=$?
[[ $code == 70 && $said == *'dicom_codecs.so: is missing'* ]] || fail "without the library: $code: $said"
echo no >"$work/alone/lib/trephine/dicom_codecs.so"
code=0; said=$(phantom none 2>&1) || code=$?
[[ $code == 70 && $said == *dicom_codecs.so*'cannot'* || $code == 70 && $said == *'no library that can be loaded'* ]] || fail "no library: $code: $said"
cp "$BIN/../lib/trephine/dicom_codecs.so" "$work/alone/lib/trephine/"
phantom below || fail "with the library in ../lib/trephine"
mv "$work/alone/lib/trephine/dicom_codecs.so" "$work/alone/bin/"
phantom beside || fail "with the library beside the program"
cmp "$work/below/dicom/"*1.dcm "$work/beside/dicom/"*1.dcm || fail "other bytes"
cd "$work/alone/bin" && mv dicom_codecs.so "$work/" && cd "$work"  # the working folder is no place for it
code=0; phantom working >/dev/null 2>&1 || code=$?
[[ $code == 70 ]] || fail "a library of the working folder is loaded"
echo ok
