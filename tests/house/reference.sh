#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# reference.sh PROGRAM ROOT: docs/reference is what the program writes.
set -u
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
"$1" reference --out "$fresh" || exit 1
diff -r -u "$2/docs/reference" "$fresh" || { echo "run: $1 reference --out docs/reference (and remove pages it no longer writes)"; exit 1; }
