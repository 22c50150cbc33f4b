#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The Debian packages of what was built, unpacked into an empty folder tree: the right files, the same bytes twice, a page for every
# command, and completion. deb_case.sh works with what is in them.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/deb_pack.sh"
. "$(dirname "$0")/hardened_common.sh"
umask 077  # which must not show inside
pack packages
deb=$(echo "$work"/packages/trephine_*.deb)
dev=$(echo "$work"/packages/trephine-dev_*.deb)
python=$(echo "$work"/packages/python3-trephine_*.deb)  # of a build with TREPHINE_PYTHON
packages=("$deb" "$dev")
! grep -q '^set(CPACK_COMPONENTS_ALL "[^"]*python' "$BUILD/CPackConfig.cmake" || packages+=("$python")
[[ $(ls "$work"/packages/*.deb | wc -l) == "${#packages[@]}" ]] && ls "${packages[@]}" >/dev/null || fail "not these packages: ${packages[*]}"
root=$work/root
dpkg-deb -x "$deb" "$root"
date=$(stat -c %Y "$root/usr/bin/trephine")
if [[ -e $SOURCE/.git ]] && command -v git >/dev/null; then
  git -C "$SOURCE" log --format=%ct | grep -x "$date" >/dev/null || fail "dated $date, which is no commit's date"
fi

# What apt reads.
version=$(dpkg-deb -f "$deb" Version)
[[ $("$TREPHINE" --version) == "trephine $version" ]] || fail "version $version"
[[ $(head -1 "$SOURCE/cmake/debian/changelog") == "trephine ($version) "* ]] || fail "cmake/debian/changelog is not of $version"
dpkg-deb -f "$deb" Depends >"$work/depends"
for library in ninja-build gnuplot-nox fonts-dejavu-core libc6 libstdc++6 libfmt libssl libvtk libassimp libgdcm libyaml-cpp libinsighttoolkit libhdf5 libopenigtlink; do
  grep -q "$library" "$work/depends" || { cat "$work/depends"; fail "does not depend on $library"; }
done
[[ $(dpkg-deb -f "$dev" Depends) == *libfmt-dev* ]] || fail "trephine-dev does not depend on libfmt-dev"
[[ $(dpkg-deb -f "$deb" Description) == *sample* ]] || fail "no description"

# Every file has a place that is known, everybody may read it, and nobody but root owns it.
dpkg-deb -c "$deb" >"$work/list"
! awk '$2 != "root/root" || $1 !~ /^(-rw-r--r--|[-d]rwxr-xr-x)$/' "$work/list" | grep . || fail "owner or mode"
for page in trephine/{run.md,configuration.schema.json} trephine-sim/play.md; do
  grep -q " \./usr/share/doc/trephine/docs/reference/$page$" "$work/list" || fail "the reference lacks $page"
done
! awk '!/\/$/ { print $6 }' "$work/list" | grep -vxE -e '\./usr/bin/trephine(-sim|-itk|-tetra)?' \
  -e '\./usr/lib/trephine/(mesh_formats|dicom_codecs|hdf5_writer|igtl_messages|force_dimension|open_haptics|haply)\.so' \
  -e '\./usr/lib/trephine/slicer-modules/Trephine(Run|Export|Measure)' \
  -e '\./usr/share/trephine/(trephine\.root|(pipelines|configs|configs/scenes|configs/trade|configs/rubrics|examples/lessons)/[a-z_]+\.(yaml|json)|configs/same_place\.tfm|sample_dicom/slice_[0-9]{4}\.dcm)' \
  -e '\./usr/share/trephine/pipelines/Snakefile' \
  -e '\./usr/share/doc/trephine/docs/reference/trephine(-sim)?/[a-z0-9_.-]+\.(md|json)' \
  -e '\./usr/share/doc/trephine/((README|CONTRIBUTING|CHANGELOG)\.md|CITATION\.cff|LICENSE|copyright|changelog\.gz|docs/(tutorials|how-to|reference|explanation|developers|validation)/[a-z-]+\.md|docs/pictures/[a-z_]+\.(png|svg))' \
  -e '\./usr/share/man/man1/trephine[a-z0-9-]*\.1\.gz' \
  -e '\./usr/share/bash-completion/completions/trephine(-sim)?' || fail "these do not belong there"
! dpkg-deb -c "$dev" | awk '!/\/$/ { print $6 }' | grep -vxE -e '\./usr/include/trephine/[a-z]+/[a-z_0-9]+\.h' \
  -e '\./usr/lib/([a-z0-9_-]+/)?(libtrephine_[a-z]+\.a|cmake/TrephineCase/TrephineCase[A-Za-z-]+\.cmake)' \
  -e '\./usr/share/doc/trephine-dev/(copyright|changelog\.gz|examples/(ambf_stack|case_reader|contact|dicom_overlay|pressed_brain|python_reader|recording_data|slicer_scene|udp_client)/[A-Za-z._]+)' || fail "these do not belong there"

# The Python package, from an empty folder, by the Python that it is for.
if ((${#packages[@]} > 2)); then
  dpkg-deb -f "$python" Depends >"$work/depends"
  for library in 'python3 (>= 3\.' 'python3 (<< 3\.' python3-numpy libc6 libfmt libssl; do
    grep -q "$library" "$work/depends" || { cat "$work/depends"; fail "python3-trephine does not depend on $library"; }
  done
  ! grep -E 'libvtk|libgdcm|libinsighttoolkit|libassimp' "$work/depends" || fail "python3-trephine depends on these"
  ! dpkg-deb -c "$python" | awk '$2 != "root/root" || $1 !~ /^(-rw-r--r--|[-d]rwxr-xr-x)$/' | grep . || fail "owner or mode"
  ! dpkg-deb -c "$python" | awk '!/\/$/ { print $6 }' | grep -vxE \
    -e '\./usr/lib/python3/dist-packages/trephine/([a-z_]+\.pyi?|py\.typed|trephine-worker|_native\.cpython-[0-9]+-[a-z0-9_-]+\.so)' \
    -e '\./usr/share/doc/python3-trephine/(copyright|changelog\.gz|examples/python/[a-z_]+\.py)' || fail "these do not belong there"
  dpkg-deb -x "$python" "$work/python"
  installed=$work/python/usr/lib/python3/dist-packages
  for file in "$installed"/trephine/{trephine-worker,_native.*.so}; do
    is_hardened "$file"
    ! grep -aoE "($SOURCE|$BUILD)[ -~]*" "$file" || fail "$file knows where it was built"
  done
  chmod -R a-w "$work/python"
  (cd "$work" && env -i PATH=/usr/bin:/bin PYTHONDONTWRITEBYTECODE=1 PYTHONPATH="$installed" \
    /usr/bin/python3 "$work/python/usr/share/doc/python3-trephine/examples/python/own_surface.py" own.npz >said) || fail "the Python package does not work"
  grep -q '^closed, 2-manifold, no self-intersections$' "$work/said" || { cat "$work/said"; fail "no valid surface by Python"; }
fi

for file in "$SOURCE"/{pipelines,configs,sample_dicom}; do
  diff -r "$file" "$root/usr/share/trephine/${file##*/}" || fail "$file"
done
for program in trephine trephine-sim trephine-itk; do
  is_hardened "$root/usr/bin/$program"
  ! grep -aoE "($SOURCE|$BUILD)[ -~]*" "$root/usr/bin/$program" || fail "$program knows where it was built"
done
for library in "$root"/usr/lib/trephine/{mesh_formats,dicom_codecs,hdf5_writer,igtl_messages}.so; do
  is_hardened "$library"
  ! grep -aoE "($SOURCE|$BUILD)[ -~]*" "$library" || fail "$library knows where it was built"
done

chmod -R a-w "$root"
cd "$work"
clean=(env -i "PATH=$root/usr/bin:/usr/bin:/bin" "HOME=$work")

# A page for every command, which renders without a warning.
for program in trephine trephine-sim; do
  pages=$("${clean[@]}" $program --help | sed -n '/^Commands:/,/^$/ { s/^  \([a-z]*\) \([a-z]\+\)  .*/-\1-\2/p; s/^  \([a-z]*\) .*/-\1/p }')
  [[ $(wc -w <<<"$pages") -ge 2 ]] || fail "commands of $program: $pages"
  for page in '' $pages; do
    page=$root/usr/share/man/man1/$program$page.1.gz
    [[ -f $page ]] || fail "no ${page##*/}"
    command -v groff >/dev/null || { [[ ${TREPHINE_CHECK:-} != 1 ]] || fail "no groff"; continue; }
    zcat "$page" | groff -man -Tutf8 -P -cbou -ww -b >"$work/page" 2>"$work/warnings" || fail "$page"
    [[ ! -s $work/warnings ]] || { cat "$work/warnings"; fail "$page"; }
    grep -q 'SEE ALSO' "$work/page" || fail "${page##*/} is cut short"
  done
done
zcat "$root/usr/share/man/man1/trephine-run.1.gz" >"$work/page"
grep -q '^\\fB\\-\\-\[no\\-\]pictures\\fR$' "$work/page" || fail "trephine-run(1) lacks --pictures"

# Completion as bash-completion loads it, by the command's name.
completed() {  # WORDS...: what bash offers for the last
  bash -c 'source "$0/$1"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); "_$1_completion"; echo "${COMPREPLY[*]}"' \
    "$root/usr/share/bash-completion/completions" "$@"
}
[[ $(completed trephine vox) == voxelize ]] || fail "completion of trephine"
[[ $(completed trephine run --no-pic) == --no-pictures ]] || fail "completion of flags"
[[ $(completed trephine-sim che) == check ]] || fail "completion of trephine-sim"

long_only

# Packed elsewhere on the globe: the same bytes.
(export TZ=Asia/Tokyo LC_ALL=C SOURCE_DATE_EPOCH="$date"; pack again)
for f in "${packages[@]}"; do cmp "$f" "$work/again/${f##*/}" || fail "packed again, other bytes"; done
echo ok
