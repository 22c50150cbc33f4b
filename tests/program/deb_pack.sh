# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced, after common.sh, by the scripts that look at the Debian packages.
for tool in cpack dpkg-deb dpkg-shlibdeps file readelf; do
  command -v $tool >/dev/null || skip "no $tool"
done

pack() {  # FOLDER: from what the build holds; builds nothing. not compressed, which is quicker.
  cpack --config "$BUILD/CPackConfig.cmake" -G DEB -D CPACK_DEBIAN_COMPRESSION_TYPE=none -B "$work/$1" >"$work/log" 2>&1 || { cat "$work/log"; fail "cpack"; }
}
