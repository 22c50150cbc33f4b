#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The source of a commit as one archive, FOLDER/trephine-VERSION.tar.gz, which builds without git. The same commit gives the same bytes: names,
# modes, owners and dates are the commit's. Beside it lies its SHA-256 for `sha256sum -c`.
# Usage: cmake/source_archive.sh FOLDER [COMMIT]        COMMIT: HEAD by default
set -euo pipefail
folder=$(readlink -f "${1:?usage: cmake/source_archive.sh FOLDER [COMMIT]}")
commit=${2:-HEAD}
cd "$(dirname "$(readlink -f "$0")")/.."
version=$(git show "$commit:CMakeLists.txt" | sed -nE 's/^project\(trephine VERSION ([0-9.]+) .*/\1/p')
name=trephine-${version:?"$commit names no version"}
mkdir -p "$folder"
git archive --format=tar --prefix="$name/" "$commit" | gzip -9n >"$folder/$name.tar.gz.part"
mv "$folder/$name.tar.gz.part" "$folder/$name.tar.gz"
(cd "$folder" && sha256sum "$name.tar.gz" >"$name.tar.gz.sha256")
echo "$folder/$name.tar.gz"
