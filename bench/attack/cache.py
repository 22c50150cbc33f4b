#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Entries of the stage cache under each other's names: the index alone, the data alone, or both.

A run over such a cache must give the bytes that it gives without one."""
import hashlib
import json
import shutil

import common


def digest(case):
    manifest = (case / "case.json").read_bytes()
    for f in json.loads(manifest)["files"]:
        if hashlib.sha256((case / f["name"]).read_bytes()).hexdigest() != f["sha256"]:
            return "torn: " + f["name"]
    return hashlib.sha256(manifest).hexdigest()


def main():
    attack = common.Attack(__doc__, 20, {"--config": {"required": True, "help": "the configuration of a case"},
                                         "--series": {"help": "its series, where the configuration has none"}})
    out, cache = attack.work / "out", attack.work / "cache"
    words = ["run", attack.args.config, "--out", out, "--case", "a", "--cache", cache, "--quiet", "--no-pictures"]
    words += ["--series", attack.args.series] if attack.args.series else []
    attack.run("the first run", *words, allowed={0})
    before = digest(out / "a")
    kept = attack.work / "kept"
    shutil.copytree(cache, kept)
    entries = sorted(f.stem for f in cache.glob("*.index"))
    data = {e: [f.suffix for f in cache.glob(e + ".*") if f.suffix != ".index"] for e in entries}
    for n in range(attack.args.count):
        shutil.rmtree(cache)
        shutil.copytree(kept, cache)
        which = attack.random.choice(["index", "data", "both"])
        pairs = attack.random.choice([1, 1, len(entries)])
        for _ in range(pairs):
            a, b = attack.random.sample(entries, 2)
            if data[a] != data[b]:
                if which != "index":
                    continue
            for suffix in ([".index"] if which != "data" else []) + (data[a] if which != "index" else []):
                (cache / (a + suffix)).replace(cache / "swap")
                (cache / (b + suffix)).replace(cache / (a + suffix))
                (cache / "swap").replace(cache / (b + suffix))
        what = f"swap {n}: {which} of {pairs} pairs"
        attack.run(what, *words, allowed={0})
        if digest(out / "a") != before:
            attack.find(what + ": another case")
    attack.end()


if __name__ == "__main__":
    main()
