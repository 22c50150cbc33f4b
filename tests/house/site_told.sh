#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# docs/build_site.sh without mkdocs says what to install; the pages that a newcomer reads first lead to painting by hand.
set -euo pipefail
root=$1
bin=$(mktemp -d)
trap 'rm -rf "$bin"' EXIT
for tool in bash dirname readlink; do ln -s "$(command -v "$tool")" "$bin/$tool"; done
status=0
said=$(env -u TREPHINE_CHECK PATH="$bin" "$bin/bash" "$root/docs/build_site.sh" "$bin/site" 2>&1) || status=$?
[[ $status == 77 && $said == *"apt install mkdocs"* ]] || { echo "without mkdocs: $status, $said" >&2; exit 1; }
for page in README.md docs/how-to/own-scan.md; do
  grep -q "paint.md" "$root/$page" || { echo "$page does not link to paint.md" >&2; exit 1; }
done
