#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a case would take on more threads: more_threads.py EXPLAIN.json TRADE.json POINT

EXPLAIN.json is written by `trephine run ... --explain --json`, TRADE.json by `trephine trade` of the same case, which times
each stage alone on all threads of its machine. Stages are given to as many slots as are asked, the one with the longest
way to the end first, as the program does; a slot is that many threads. So what is printed is the wall time that 1, 2, 4
and 8 times as many threads would take if no stage became faster by them, and no slower by its neighbours: the way of
stages that wait for each other is the limit, and it is printed last."""
import heapq
import json
import sys


def main():
    explain, trade = (json.load(open(path)) for path in sys.argv[1:3])
    point = next(p for p in trade["details"] if p["name"] == sys.argv[3])
    seconds = {name: stage["median_s"] for name, stage in point["stages"].items()}
    readers = {s["name"]: [] for s in explain["stages"]}
    for stage in explain["stages"]:
        for part in stage["why"].split("; "):
            if part.startswith("read by "):
                readers[stage["name"]] += [r for r in part[len("read by "):].split(", ") if r in readers]
    seconds.update({name: 0 for name in readers if name not in seconds})
    readers["publish"] = []
    for name in list(readers):
        if name != "publish" and not readers[name]:
            readers[name] = ["publish"]
    seconds.setdefault("publish", 0)
    to_end = {}

    def left(name):
        if name not in to_end:
            to_end[name] = seconds[name] + max((left(r) for r in readers[name]), default=0)
        return to_end[name]

    waits = {name: 0 for name in readers}
    for name in readers:
        for r in set(readers[name]):
            waits[r] += 1
    print(f"{sum(seconds[n] for n in readers):.1f} s of stages, one after the other")
    for slots in (1, 2, 4, 8):
        missing, ready, running, now, busy = dict(waits), [], [], 0.0, 0
        for name in readers:
            if missing[name] == 0:
                heapq.heappush(ready, (-left(name), name))
        while ready or running:
            while ready and busy < slots:
                _, name = heapq.heappop(ready)
                heapq.heappush(running, (now + seconds[name], name))
                busy += 1
            now, name = heapq.heappop(running)
            busy -= 1
            for r in set(readers[name]):
                missing[r] -= 1
                if missing[r] == 0:
                    heapq.heappush(ready, (-left(r), r))
        print(f"{slots} times the threads: {now:.1f} s")
    name, way = max(readers, key=left), []
    while name:
        way.append(f"{name} {seconds[name]:.1f}")
        name = max(readers[name], key=left, default=None)
    print(f"the longest way, {left(way[0].split()[0]):.1f} s: " + ", ".join(way))


main()
