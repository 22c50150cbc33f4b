#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The Debian package of what was built, unpacked into an empty folder tree: the sample case made and checked by what lies there and
# nothing else. LONG=1: on the scan's own voxels.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/deb_pack.sh"
pack packages
root=$work/root
dpkg-deb -x "$work"/packages/trephine_*.deb "$root"

# Only what was unpacked: an empty environment, another folder, a tree that nobody can write to.
chmod -R a-w "$root"
cd "$work"
clean=(env -i "PATH=$root/usr/bin:/usr/bin:/bin" "HOME=$work")
"${clean[@]}" trephine run "$root/usr/share/trephine/configs/sample.yaml" --out "$work/library" --no-pictures --quiet "${coarsest[@]}"
"${clean[@]}" trephine-sim check "$work/library/sample" >"$work/said" || fail "trephine-sim check"
grep -q ventricles "$work/said" || { cat "$work/said"; fail "the sample's ventricles are missing"; }
# A user's own case; the sample's stages are in the library's cache.
"${clean[@]}" trephine run "$root/usr/share/trephine/configs/ct_head.yaml" --series "$root/usr/share/trephine/sample_dicom" \
  --case own --out "$work/library" --no-pictures --quiet "${coarsest[@]}"
"${clean[@]}" trephine-sim check "$work/library/own" >"$work/said" || fail "trephine-sim check"
cmp <(cd "$work/library/sample" && ls meshes haptic*) <(cd "$work/library/own" && ls meshes haptic*) || fail "own case"
echo ok
