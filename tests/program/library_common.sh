# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the library's scripts after common.sh: a configuration whose cases take a third of a second each.
mkdir "$work/l"
touch "$work/l/trephine.root"
cp "$SOURCE/pipelines/ventriculostomy.yaml" "$work/l/p.yaml"
printf 'trephine: 1\nanatomies: {skull: {max_triangles: 20000}}\nface: {policy: keep, reason: synthetic}\n' >"$work/l/s.yaml"
printf 'trephine: 1\npipeline: p.yaml\nscene: s.yaml\n' >"$work/l/c.yaml"
# A block at the vault.
tiny='columns_count: 40, rows_count: 40, slices_count: 10, field_of_view_mm: 80, slice_step_mm: 2, slice_thickness_mm: 1, centre_mm: [0, -40, 115], noise_hu: 3, mesh_step_mm: 0, labels: false'
tiny_flags=$(sed 's/: \[\([^]]*\)\]/=\1/; s/, \([0-9-]*\), \([0-9]*\), noise/,\1,\2, noise/; s/labels: false/no_labels/; s/: /=/g; s/, / --/g; s/_/-/g; s/^/--/' <<<"${tiny/\[0, -40, 115\]/[0,-40,115]}")
build() { "$TREPHINE" library build "$@" --out "$work/out" --quiet --no-pictures; }
digests() { for c in "$work"/out/*/case.json; do c=${c%/case.json}; echo "${c##*/} $(case_digest "$c")"; done; }
