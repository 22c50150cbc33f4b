#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""schemas.py ROOT REFERENCE: every YAML file that comes with the program is as its schema says, and each schema refuses what the
program refuses: a key that nobody knows, a required one that is missing, a value of another kind."""
import copy
import json
import os
import sys
from pathlib import Path

try:
    import jsonschema
    import yaml
except ImportError as missing:  # Debian's python3-jsonschema and python3-yaml
    print(f"skipped: {missing}")
    sys.exit(1 if os.environ.get("TREPHINE_CHECK") == "1" else 77)

ROOT = Path(sys.argv[1])
KINDS = [("recipe", "pipelines/*.yaml"), ("scene", "configs/scenes/*.yaml"), ("materials", "configs/materials.yaml"),
         ("library", "configs/library.yaml"), ("library", "configs/exercise_library.yaml"),
         ("rubric", "configs/rubrics/*.yaml"),
         ("trade", "configs/trade/*.yaml"), ("configuration", "configs/*.yaml")]


class Loader(yaml.SafeLoader):
    """YAML 1.2's core schema, as the program reads it: yes and no are words."""


Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag != "tag:yaml.org,2002:bool" or first in "tTfF"]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()}


def faults_of(schema, tree):
    return [f"{'/'.join(str(p) for p in e.absolute_path)}: {e.message[:200]}"
            for e in jsonschema.Draft202012Validator(schema).iter_errors(tree)]


def maps_below(tree, path=()):
    """Every map with declared keys: those whose own keys are names stand one above."""
    if isinstance(tree, dict):
        yield path, tree
        for key, value in tree.items():
            yield from maps_below(value, path + (key,))
    elif isinstance(tree, list):
        for i, value in enumerate(tree):
            yield from maps_below(value, path + (i,))


def with_key(tree, path, key, value):
    changed = copy.deepcopy(tree)
    at = changed
    for step in path:
        at = at[step]
    at[key] = value
    return changed


failed, seen, refused = 0, set(), 0
for kind, pattern in KINDS:
    schema = json.loads((Path(sys.argv[2]) / "trephine" / f"{kind}.schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    files = [f for f in sorted(ROOT.glob(pattern)) if f not in seen]
    if not files:
        print(f"{pattern}: no file")
        failed += 1
    for file in files:
        seen.add(file)
        tree = yaml.load(file.read_text(), Loader)
        for fault in faults_of(schema, tree):
            print(f"{file.relative_to(ROOT)}: {fault}")
            failed += 1
        wrong = [with_key(tree, (), "no_such_key", 1), with_key(tree, (), "trephine", 2),
                 with_key(tree, (), "trephine", "1")]
        without = copy.deepcopy(tree)
        del without["trephine"]
        wrong.append(without)
        # Maps from names to things take any name; everything else refuses a key that it does not know.
        named = {"anatomies", "materials", "shapes", "landmarks", "set", "sweeps", "configs", "finest", "values", "targets",
                 "burr_holes", "names", "environment"}
        for path, _ in maps_below(tree):
            if path and path[-1] not in named:
                wrong.append(with_key(tree, path, "no_such_key", 1))
        for one in wrong:
            refused += 1
            if not faults_of(schema, one):
                print(f"{file.relative_to(ROOT)}: the schema takes what the program refuses")
                failed += 1
print(f"{len(seen)} files are as their schemas say, {refused} wrong ones refused" if not failed else f"{failed} faults")
sys.exit(failed > 0)
