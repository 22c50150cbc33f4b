#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutants of a case whose checksums are right: values of case.json and bytes of its files are exchanged, then it is sealed again.

The simulator's check must accept or refuse each (65) with one line, and never crash. A quarter are files whose geometry or type
contradicts case.json: each of these must be refused."""
import hashlib
import json
import re
import shutil

import common

ODD = [None, True, False, 0, -1, 1, 2.5, 1e9, -1e300, 2**63, "", "another", "a\nb", "../../case.json", [], {}, [1, 2, 3], [[[[]]]],
       "0" * 64, "\u202etxt", "x" * 70000]


def leaves(value, path=()):
    if isinstance(value, dict) and value:
        for key in value:
            yield from leaves(value[key], path + (key,))
    elif isinstance(value, list) and value:
        for i, item in enumerate(value):
            yield from leaves(item, path + (i,))
    else:
        yield path


def put(value, path, new):
    for step in path[:-1]:
        value = value[step]
    value[path[-1]] = new


def seal(folder, body, head):
    for f in body["files"]:
        try:
            data = (folder / f["name"]).read_bytes()
            f["sha256"], f["bytes"] = hashlib.sha256(data).hexdigest(), len(data)
        except (OSError, TypeError, KeyError, ValueError):
            pass
    text = head + json.dumps(body, indent=1, ensure_ascii=False)[1:-2]
    text += ',\n "checksum": "' + hashlib.sha256(text.encode()).hexdigest() + '"\n}\n'
    (folder / "case.json").write_bytes(text.encode())


def lie(rnd, name, data):
    """The header of a NRRD with another geometry than case.json says, or a GLB with another count. Null where nothing was found."""
    if name.endswith(".nrrd"):
        head, _, body = data.partition(b"\n\n")
        lines = head.decode().split("\n")
        for i, line in enumerate(lines):
            if rnd.random() < 0.5 and line.startswith("space directions: "):
                factor = rnd.choice([0.25, 0.5, 0.999, 1.001, 2, -1, 1e6])
                lines[i] = "space directions: " + re.sub(r"-?[0-9.e+-]+", lambda m: repr(float(m[0]) * factor), line[18:])
                return "\n".join(lines).encode() + b"\n\n" + body, f"directions times {factor}", factor != -1
            if line.startswith("sizes: "):
                sizes = line[7:].split()
                turned = sizes[1:] + sizes[:1]
                if turned != sizes and rnd.random() < 0.5:
                    lines[i] = "sizes: " + " ".join(turned)
                    return "\n".join(lines).encode() + b"\n\n" + body, "sizes in another order", True
        for i, line in enumerate(lines):
            if line.startswith("type: "):
                lines[i] = "type: unsigned char" if "char" not in line else "type: short"
                return "\n".join(lines).encode() + b"\n\n" + body, "another type", True
    return None


def main():
    attack = common.Attack(__doc__, 300, {"--case": {"required": True, "help": "a case of the current version"}})
    good = attack.work / "good"
    shutil.copytree(attack.args.case, good, ignore=shutil.ignore_patterns("report", ".lock"))
    body = json.loads((good / "case.json").read_text())
    head = '{\n "format": ' + json.dumps(body["format"]) + ","
    del body["format"], body["checksum"]
    seal(good, body, head)
    attack.run("sealed again", "check", good, program=attack.args.sim, allowed={0})
    paths = list(leaves(body))
    rnd = attack.random
    for n in range(attack.args.count):
        mutant = json.loads(json.dumps(body))
        folder = attack.work / "mutant"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(good, folder)
        what = []
        if rnd.random() < 0.25:  # what the file says, sealed, against what case.json says: never accepted
            name = rnd.choice([f["name"] for f in body["files"] if f["name"].endswith(".nrrd")])
            lied = lie(rnd, name, (folder / name).read_bytes())
            if lied and lied[2]:
                (folder / name).write_bytes(lied[0])
                seal(folder, mutant, head)
                attack.run(f"mutant {n}: {name}: {lied[1]}", "check", folder, program=attack.args.sim, allowed={65})
                continue
        for _ in range(rnd.choice([1, 1, 2, 4])):
            if rnd.random() < 0.25:
                name = rnd.choice(body["files"])["name"]
                data = bytearray((folder / name).read_bytes())
                for _ in range(rnd.choice([1, 8])):
                    data[rnd.randrange(min(len(data), rnd.choice([400, 4000, len(data)])))] = rnd.randrange(256)
                if rnd.random() < 0.2:
                    del data[rnd.randrange(len(data)):]
                (folder / name).write_bytes(bytes(data))
                what.append(name)
            else:
                path = rnd.choice(paths)
                value = rnd.choice(ODD)
                try:
                    put(mutant, path, value)
                except (TypeError, KeyError, IndexError):
                    continue  # an earlier mutation took the place away
                what.append(".".join(map(str, path)) + " = " + repr(value)[:40])
        try:
            seal(folder, mutant, head)
        except (TypeError, KeyError):
            continue
        attack.run(f"mutant {n}: " + ", ".join(what), "check", folder, program=attack.args.sim, allowed={0, 65, 66})
    attack.end()


if __name__ == "__main__":
    main()
