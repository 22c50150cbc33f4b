# SPDX-License-Identifier: GPL-3.0-or-later
"""case_schema.py SCHEMA CASE PROGRAM: the schema and the loader agree on what case.json holds.

A real case passes the schema; and for each key of it, missing or of another type, the schema and PROGRAM (trephine-sim) say
the same of the case.
"""
import copy, hashlib, json, pathlib, re, shutil, subprocess, sys, tempfile

schema_file, case, program = map(pathlib.Path, sys.argv[1:4])
schema = json.loads(schema_file.read_text())


types = {"object": dict, "array": list, "string": str, "boolean": bool, "number": (int, float), "integer": int}
annotations = {"description", "title", "$schema"}


def fault(value, s, at=""):
    """The first fault of the value, or None. Knows the words that our schema uses and no others."""
    unknown = s.keys() - annotations - {"type", "required", "properties", "additionalProperties", "items", "minItems", "maxItems",
                                        "pattern", "minLength", "minimum", "maximum", "exclusiveMinimum", "enum", "const", "anyOf"}
    assert not unknown, unknown
    if "anyOf" in s:
        return None if any(fault(value, o, at) is None for o in s["anyOf"]) else f"{at}: is none of what it may be"
    if "const" in s and value != s["const"] or "enum" in s and value not in s["enum"]:
        return f"{at}: {value!r}"
    if "type" in s:
        if not isinstance(value, types[s["type"]]) or isinstance(value, bool) and s["type"] != "boolean":
            return f"{at}: is no {s['type']}"
    if isinstance(value, str) and ("pattern" in s and not re.search(s["pattern"], value) or len(value) < s.get("minLength", 0)):
        return f"{at}: {value!r}"
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        if not s.get("minimum", value) <= value <= s.get("maximum", value) or value <= s.get("exclusiveMinimum", value - 1):
            return f"{at}: {value} is out of range"
    if isinstance(value, list):
        if not s.get("minItems", 0) <= len(value) <= s.get("maxItems", len(value)):
            return f"{at}: {len(value)} items"
        for i, v in enumerate(value):
            if f := fault(v, s.get("items", {}), f"{at}[{i}]"):
                return f
    if isinstance(value, dict):
        for k in s.get("required", []):
            if k not in value:
                return f"{at}.{k}: missing"
        for k, v in value.items():
            rule = s.get("properties", {}).get(k, s.get("additionalProperties", {}))
            if f := fault(v, rule, f"{at}.{k}"):
                return f
    return None


def keys_of(s):
    """How many keys the schema describes."""
    below = [*s.get("properties", {}).values(), *([s["items"]] if "items" in s else [])]
    return len(s.get("properties", {})) + sum(keys_of(v) for v in below)


def ways(value, at=()):
    yield at
    if isinstance(value, dict):
        for k, v in value.items():
            yield from ways(v, at + (k,))
    elif isinstance(value, list):
        for i, v in enumerate(value):
            yield from ways(v, at + (i,))


def loads(folder, document):
    """Whether the program loads the case with this case.json, its version and checksum as they must be."""
    body = json.dumps({k: v for k, v in document.items() if k not in ("format", "checksum")}, indent=1)
    text = '{\n "format": "%s",' % document["format"] + body[1:-2]
    text += ',\n "checksum": "' + hashlib.sha256(text.encode()).hexdigest() + '"\n}\n'
    (folder / "case.json").write_text(text)
    done = subprocess.run([program, "check", folder], capture_output=True, text=True)
    assert done.returncode in (0, 65), done
    return done.returncode == 0, done.stderr


document = json.loads((case / "case.json").read_text())
assert fault(document, schema) is None, fault(document, schema)
try:
    import jsonschema
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.Draft202012Validator(schema).validate(document)
except ImportError:
    pass

tried = 0
with tempfile.TemporaryDirectory() as scratch:
    folder = pathlib.Path(scratch) / "case"
    shutil.copytree(case, folder)
    assert loads(folder, document)[0]
    for way in list(ways(document)):
        if not way or way[0] in ("format", "checksum"):
            continue
        changed = copy.deepcopy(document)
        holder = changed
        for step in way[:-1]:
            holder = holder[step]
        original = holder[way[-1]]
        changes = [{"no": "such"}] if isinstance(original, (str, bool, int, float, list)) else [7]
        if isinstance(original, (int, float)) and not isinstance(original, bool):
            changes += [-1e9, 40000]
        for change in changes:
            # Another number can be a fault in itself, or be one beside the files: the schema knows the former only.
            holder[way[-1]] = change
            good, said = loads(folder, changed)
            bad = fault(changed, schema)
            assert good == (bad is None) or (not good and isinstance(change, (int, float))), (way, change, said, bad)
            tried += 1
        if isinstance(way[-1], str):
            del holder[way[-1]]
            good, said = loads(folder, changed)
            bad = fault(changed, schema)
            # A shape that is displayed from its surface must have one.
            if way[0] == "anatomies" and way[-1] == "file":
                assert not good and "displayed" in said, said
            else:
                assert good == (bad is None), (way, said, bad)
            tried += 1
assert keys_of(schema) > 70 and tried > 300, (keys_of(schema), tried)
print(f"{keys_of(schema)} keys, {tried} changes")
