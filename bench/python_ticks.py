#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""python_ticks.py CASE RECORDING [...]: how many ticks a second of CPU time a session makes from Python, in one thread: in rows, which cross to
C++ once, a call a tick, and as an environment. Each recording is of CASE (`trephine-sim servo --record`); the best of three.

    PYTHONPATH=build/release/python python3 bench/python_ticks.py out/sample touch.servo drill.servo
"""
import os
import sys
import time

import numpy as np

import trephine
from trephine.env import CaseEnv

CHOSEN = ("tool", "tool_diameter_mm", "tool_length_mm", "tool_spacing_mm", "tool_tip")


def best(function, times=3):
    taken = []
    for _ in range(times):
        prepared = function()
        begin = time.thread_time()
        prepared()
        taken.append(time.thread_time() - begin)
    return min(taken)


os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
trephine.set_thread_count(1)
print("load", " ".join(f"{x:.1f}" for x in os.getloadavg()))
for file in sys.argv[2:]:
    recording = trephine.read_recording(file)
    f, header = recording.frames, recording.header
    params = {name: header["tool"][name] for name in CHOSEN if name in header["tool"]}
    params["drill"] = header.get("drilling", {}).get("drill", False)
    session = trephine.Session(sys.argv[1], **params)

    def each():
        session.reset()
        poses = [(t, a, int(b)) for t, a, b in zip(f["tip_mm"], f["axis"], f["buttons"])]

        def go():
            for tip, axis, buttons in poses:
                session.step(tip, axis, buttons)
        return go

    def environment(ticks):
        env = CaseEnv(sys.argv[1], begin_mm=f["tip_mm"][0], ticks_per_step=ticks, max_steps=10 ** 9, step_mm=1.0,
                      **params)
        moved = np.diff(f["tip_mm"][::ticks], axis=0)
        pedal = (f["buttons"][::ticks][1:] & 1).astype(float)
        actions = np.column_stack([moved, np.zeros((len(moved), 3)), pedal])

        def prepare():
            env.reset()

            def go():
                for action in actions:
                    env.step(action)
                    if env._steps is None:  # drilled through: only the count of ticks matters here
                        env._steps = 0
            return go
        return best(prepare) * len(f) / (len(actions) * ticks)

    def rows():
        session.reset()
        chunk = np.ascontiguousarray(f["tip_mm"])
        return lambda: [session.run(chunk[n:n + 1000], f["axis"][n:n + 1000], f["buttons"][n:n + 1000]) for n in range(0, len(f), 1000)]

    cpp = best(rows)
    print(f"{file}: {len(f)} ticks, {np.count_nonzero(f['touched']) / len(f):.0%} in contact, drill {params['drill']}")
    for name, seconds in (("rows of 1,000 ticks (session.run)", cpp), ("a call a tick (session.step)", best(each)),
                          ("an environment, 10 ticks a step", environment(10)), ("an environment, 1 tick a step", environment(1))):
        print(f"  {name}: {len(f) / seconds:,.0f} ticks/s, {seconds / cpp:.2f} of the first")
