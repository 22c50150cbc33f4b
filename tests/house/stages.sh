#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# stages.sh ROOT: what makes a case's graph and publishes it finds stages by their parameters, role or output; no source of it looks
# for a stage's name.
set -u
cd "$1" || exit 2
names=$(grep -hoE '\bs\.name = "[a-z0-9_]+"' lib/stages/*_stage.cpp 2>/dev/null | sed 's/.*"\(.*\)"/\1/' | paste -sd'|')
[ -n "$names" ] || { echo "lib/stages: declares no stage"; exit 1; }
found=$(grep -rnE --include='*.h' --include='*.cpp' \
  -e "find(_stage|_step)?\((.* )?\"\.?($names)\"" -e "[!=]= *\"\.?($names)\"" -e "\+ *\"\.($names)\"" -e "compare\(.*\"\.?($names)\"" \
  lib/pipeline lib/publish | grep -v 'throw Error(')
[ -z "$found" ] || { printf '%s\n' "$found"; echo "find the stage by its parameters: Graph::find_stage<Params>()"; exit 1; }
