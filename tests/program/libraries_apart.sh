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
echo no >"$work/alone/bin/dicom_codecs.so"  # the installed place comes first
phantom first || fail "a library beside the program is taken before the installed one"
rm "$work/alone/bin/dicom_codecs.so"

# A library that somebody else could have put there is not loaded: it would run with the rights of whoever starts the program.
refused() {  # WHAT: one line names the file and what is wrong
  code=0; said=$(phantom refused 2>&1) || code=$?
  [[ $code == 70 && $(wc -l <<<"$said") == 1 && $said == *"dicom_codecs.so: owner: "*"chmod go-w"* ]] || fail "$1: $code: $said"
}
installed=$work/alone/lib/trephine
for who in g o; do
  chmod $who+w "$installed/dicom_codecs.so" && refused "a library that others may write ($who)"
  chmod go-w "$installed/dicom_codecs.so"
  chmod $who+w "$installed" && refused "a folder that others may write ($who)"
  chmod go-w "$installed"
done
chmod 1777 "$installed" && refused "a sticky folder as /tmp"
chmod 755 "$installed"
chmod g+w "$work/alone/bin/trephine" "$installed" && phantom group || fail "who may write the program may write its library"
chmod g-w "$work/alone/bin/trephine" "$installed"
if [[ $(id -u) == 0 ]]; then
  chown nobody "$installed/dicom_codecs.so" && refused "a library of another user"
  chown root "$installed/dicom_codecs.so" && chown nobody "$installed" && refused "a folder of another user"
  chown -R nobody "$work/alone" && phantom clone || fail "root runs a user's own clone"
  chown -R root "$work/alone"
  mv "$installed/dicom_codecs.so" "$installed/real.so" && ln -s real.so "$installed/dicom_codecs.so"
  phantom linked || fail "a link of root's own"
  chown -h nobody "$installed/dicom_codecs.so" && refused "a link of another user"
  rm "$installed/dicom_codecs.so"
  # A link to a link that another user may put elsewhere, and a folder behind such a one.
  mkdir "$work/between" && ln -s "$installed/real.so" "$work/between/link" && chown -h nobody "$work/between/link"
  ln -s "$work/between/link" "$installed/dicom_codecs.so" && refused "a link of another user on the way"
  rm "$installed/dicom_codecs.so" && mv "$installed/real.so" "$installed/dicom_codecs.so"
  mv "$installed" "$work/alone/lib/real" && ln -s "$work/alone/lib/real" "$work/between/folder"
  chown nobody "$work/between" && ln -s "$work/between/folder" "$installed"
  refused "a folder behind a link that another user may exchange"
  rm "$installed" && mv "$work/alone/lib/real" "$installed"
fi
# The same holds for the program that reads with ITK.
cp "$BIN/trephine-itk" "$work/alone/bin/" && chmod go+w "$work/alone/bin/trephine-itk"
printf '%s\n' 'ObjectType = Image' 'NDims = 3' 'BinaryData = True' 'BinaryDataByteOrderMSB = False' 'TransformMatrix = 1 0 0 0 1 0 0 0 1' \
  'Offset = 0 0 0' 'ElementSpacing = 1 1 1' 'DimSize = 8 8 8' 'ElementType = MET_SHORT' 'ElementDataFile = LOCAL' >"$work/v.mha"
head -c 1024 /dev/zero >>"$work/v.mha"
code=0; said=$("$work/alone/bin/trephine" import "$work/v.mha" --volume-values hu --output "$work/v.nrrd" --quiet 2>&1) || code=$?
[[ $code == 70 && $said == *': owner: trephine-itk '*bin/trephine-itk* ]] || fail "a program that others may write: $code: $said"
rm "$work/alone/bin/trephine-itk"

mv "$work/alone/lib/trephine/dicom_codecs.so" "$work/alone/bin/"
phantom beside || fail "with the library beside the program"
cmp "$work/below/dicom/"*1.dcm "$work/beside/dicom/"*1.dcm || fail "other bytes"
cd "$work/alone/bin" && mv dicom_codecs.so "$work/" && cd "$work"  # the working folder is no place for it
code=0; phantom working >/dev/null 2>&1 || code=$?
[[ $code == 70 ]] || fail "a library of the working folder is loaded"
echo ok
