#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Symbolic links anywhere in a library, and beside its configurations, to files and folders outside of it.

Whatever the desk is asked by its owner, it neither reads nor writes there."""
import json
import os
import shutil

import desk_of_one
from desk_of_one import CASE, exchange

CANARY = "canary-61c0de"
PATIENCE_S = 120  # a page of a case is made meanwhile, on a machine that may be busy
OUTSIDE = ["case.json", "approved.json", "journal.json", "axial.png", "view", "skull", "a.yaml", "desk-build.log", f"case.{CASE}.log",
           f"{CASE}.result.json"]
GETS = ["library", "plan", "status", "log?C", "case?C", "open?C", "draft?C&what=view", "draft?C&what=skull", "lessons?C",
        "overview?C&name=axial.png", "page?C", "compare?C", "folders?path=0", "folders?path=0/scan", "series?path=0/scan",
        "slice?C&axis=0&index=1", "tried?C"]
NOT_THERE = ["library/.library/desk/" + CASE, "library/.library/logs", "library/.library/desk-build.log", "library/bb", f"configs/{CASE}.desk",
             f"library/.library/logs/case.{CASE}.log", f"library/{CASE}/approved.json", f"library/.library/cases/{CASE}.result.json"]


def requests_of(desk, rnd):
    """What the desk's page asks of a case, reads and writes, in any order."""
    info = exchange(desk.port, [desk.head("GET", "api/case?case=" + CASE)], 20).partition(b"\r\n\r\n")[2]
    try:
        base = json.loads(info).get("base", "")
    except ValueError:
        base = ""
    said = {"case": CASE, "by": "anna-2", "why": "w", "base": base}
    accepted = {lesson: "x" for lesson in ("pedicle_finder", "pedicle_screw", "spine_needle", "subclavian")}
    posts = [("landmark", {**said, "name": "nasion", "position_mm": [1, 2, 3]}), ("value", {**said, "name": "skull.segment.lower_hu", "value": 230}),
             ("holes", {**said, "holes": []}), ("approve", {**said, "difficulty_level": 2, "accepted": accepted}),
             ("approve", {**said, "withdraw": True}), ("keep?C&what=view", None), ("keep?C&what=skull", None),
             ("switch", {**said, "id": 1, "on": False}), ("scene", {**said, "scene": "s.yaml"}), ("stop", {})]
    every = [desk.head("GET", "api/" + g.replace("?C", "?case=" + CASE)) for g in GETS]
    for path, body in posts:
        data = b"{}" if body is None else json.dumps(body).encode()
        kind = "application/octet-stream" if body is None else "application/json"
        every.append(desk.head("POST", "api/" + path.replace("?C", "?case=" + CASE), Content_Type=kind, Content_Length=len(data)) + data)
    rnd.shuffle(every)
    return every


def restore(root, good):
    """As it was: the library, and what the desk wrote beside the configurations."""
    for name in ("library", "configs"):
        shutil.rmtree(root / name)
        shutil.copytree(good / name, root / name, symlinks=True)
    for name in ("a.yaml", "s.yaml", "p.yaml"):
        shutil.copy(good / name, root / name)


def put_link(rnd, root, outside):
    """One more link, in place of something or where nothing is. Returns what."""
    below = [*(root / "library").rglob("*"), *(root / "configs").glob("*.desk"), *(root / "configs").glob("*.desk/*")]
    place = rnd.choice(below + [root / name for name in NOT_THERE])
    was_folder = place.is_dir()
    if was_folder and not place.is_symlink():
        shutil.rmtree(place)
    elif place.exists() or place.is_symlink():
        place.unlink()
    if not place.parent.is_dir():
        return ""
    folders, files = [outside, outside / "below"], [outside / name for name in OUTSIDE + ["made"]]
    to = rnd.choice(folders if was_folder or rnd.random() < 0.3 else files)
    place.symlink_to(rnd.choice([to, os.path.relpath(to, place.parent)]))
    return f"{place.relative_to(root)} -> {to.name}"


def main():
    attack = desk_of_one.attack_of_desk(__doc__, 50)
    from desk import Desk
    root, library = desk_of_one.library_of_one(attack)
    rnd, outside, good = attack.random, attack.work / "outside", attack.work / "good"
    (outside / "below").mkdir(parents=True)
    for name in OUTSIDE:
        (outside / name).write_text(json.dumps({"trephine": CANARY, "running": CANARY}))
    (outside / "below/view").write_text(CANARY)
    with Desk(root, library) as desk:
        for request in requests_of(desk, rnd):
            exchange(desk.port, [request], PATIENCE_S)  # so that all of its own folders are there
        shutil.copytree(root, good, symlinks=True)
        for n in range(attack.args.count):
            restore(root, good)
            what = f"{n}: " + ", ".join(put_link(rnd, root, outside) for _ in range(rnd.choice([1, 1, 2])))
            before = desk_of_one.state_of(outside)
            for request in requests_of(desk, rnd):
                got = exchange(desk.port, [request], PATIENCE_S)
                desk_of_one.status_of(attack, got)
                asked = request.split(b" HTTP")[0].decode()
                if not got:
                    attack.find(f"{what}: {asked} is not answered")
                if CANARY.encode() in got:
                    attack.find(f"{what}: {asked} reads outside")
                if desk_of_one.state_of(outside) != before:
                    attack.find(f"{what}: {asked} writes outside")
                    before = desk_of_one.state_of(outside)
                if desk.process.poll() is not None:
                    attack.find(f"{what}: {asked} ends the desk")
                    attack.end()
    attack.end()


if __name__ == "__main__":
    main()
