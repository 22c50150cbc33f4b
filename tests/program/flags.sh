#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Every number that a command declares, given beyond both ends of its range: 64, naming flag, value and range. And the
# values that only the command's own work finds wrong: 64 too where there is no configuration.
. "$(dirname "$0")/common.sh"
# A choice that is given by its place is named, and the message lists what it may be.
expect 64 ' completion: SHELL: csh: must be bash\|zsh\|fish$' "$TREPHINE" completion csh
expect 64 ' completion: SHELL: is needed: Which shell\. It must be bash\|zsh\|fish\.$' "$TREPHINE" completion
"$TREPHINE" reference --out "$work/reference"
python3 - "$TREPHINE" "$work/reference/parameters.schema.json" <<'PY'
import json, subprocess, sys
program, schema = sys.argv[1:]
groups = ("library", "track")
flags = 0
for name, command in json.load(open(schema))["$defs"].items():
    words = name.replace("-", " ", 1).split() if name.split("-")[0] in groups else [name]
    for end, step in (("minimum", -1), ("maximum", 1)):
        given, wanted = [], []
        for key, p in command["properties"].items():
            item = p.get("items", p)
            if item.get("type") not in ("number", "integer") or end not in item:
                continue
            bound = item[end]
            value = bound + step * max(1, abs(bound) * 1e-3)
            text = str(int(value)) if item["type"] == "integer" else repr(float(value))
            flag = "--" + key.replace("_", "-")
            given += [flag + "=" + ",".join([text] * p.get("minItems", 1))]
            wanted += [flag + ": " + text]
        if not given:
            continue
        done = subprocess.run([program, *words, *given], capture_output=True, text=True)
        assert done.returncode == 64, (words, given, done)
        for one in wanted:
            assert any(": " + one in line and "must be" in line for line in done.stderr.splitlines()), (words, one, done.stderr)
        flags += len(given)
print(flags, "values")
assert flags >= 30, flags
PY
