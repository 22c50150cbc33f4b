#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# reference.sh PROGRAM ROOT [FOLDER]: FOLDER, or docs/reference/trephine, is what the program writes.
set -u
folder=${3:-docs/reference/trephine}
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
"$1" reference --out "$fresh" || exit 1
diff -r -u "$2/$folder" "$fresh" || { echo "run: $1 reference --out $folder (and remove pages it no longer writes)"; exit 1; }
