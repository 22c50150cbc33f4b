#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A loop as for gymnasium: a simple hand drills until it is through, and its episode is recorded for trephine-sim.

    python3 drill_episode.py CASE OUT.servo [X Y Z]      X Y Z: where the tip begins, LPS mm
"""
import sys

import numpy as np

import trephine
from trephine.env import CaseEnv

begin = [float(x) for x in sys.argv[3:6]] or None
env = CaseEnv(sys.argv[1], tool="ball", tool_diameter_mm=4, begin_mm=begin, step_mm=0.2, max_steps=600)
observation, info = env.reset(seed=1, options={"record": sys.argv[2]})
cut_mm3 = most_n = 0.0
terminated = truncated = False
while not (terminated or truncated):
    force_n = np.linalg.norm(observation["force_n"])
    down = 1.0 if force_n < 1 else 0.2  # presses with about 1 N
    action = np.zeros(7)
    action[:3], action[6] = -down * observation["axis"], 1
    observation, reward, terminated, truncated, info = env.step(action)
    cut_mm3 += reward
    most_n = max(most_n, force_n)
env.close()

frames = trephine.read_recording(sys.argv[2]).frames
print(f"{'through' if terminated else 'not through'} after {frames['time_s'][-1]:.2f} s: {cut_mm3:.0f} mm^3, at most {most_n:.2f} N, "
      f"{np.count_nonzero(frames['touched']) / len(frames):.0%} of the time in contact")
