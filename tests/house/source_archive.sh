#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The archive of the source: the same bytes twice, nothing of git, and a configuration that asks git for nothing.
set -euo pipefail
cd "$1"
fail() { echo "$*" >&2; exit 1; }
command -v git >/dev/null && git rev-parse -q --verify HEAD >/dev/null || { echo "no git history here: skipped"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
file=$(cmake/source_archive.sh "$work")
(umask 077; TZ=Asia/Tokyo LC_ALL=C cmake/source_archive.sh "$work/again" >/dev/null)
cmp "$file" "$work/again/${file##*/}" || fail "archived again, other bytes"
(cd "$work" && sha256sum -c --quiet ./*.sha256) || fail "another SHA-256"
tar xf "$file" -C "$work"
source=$(echo "$work"/trephine-*/)
[[ $(cd "$source" && find . -name '.git*' ! -name .gitignore ! -name .gitattributes) == '' ]] || fail "something of git is in it"
[[ $(stat -c %Y "$source/CMakeLists.txt") == "$(git log -1 --format=%ct)" ]] || fail "not dated as its commit"
mkdir "$work/bin"
printf '#!/bin/sh\necho "git $*" >>%s\nexit 1\n' "$work/asked" >"$work/bin/git"
chmod +x "$work/bin/git"
(cd "$source" && PATH=$work/bin:$PATH cmake --preset release -DTREPHINE_TESTS=ON >"$work/said" 2>&1) || { cat "$work/said"; fail "it does not configure"; }
[[ ! -e $work/asked ]] || fail "asked of git: $(cat "$work/asked")"
