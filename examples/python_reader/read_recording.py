#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a recorded session of trephine-sim with the standard library alone, from the recording itself (docs/reference/recordings.md,
"Recordings") or from the JSON of `trephine-sim export-recording --json`.

    python3 read_recording.py FILE            says what is in it
    header, columns = read_recording.read("FILE")    columns["force_n"][17]: positions LPS mm, forces N, times s
"""
import json
import math
import struct
import sys

VERSION = 21
THREE = ("tip_{}_mm", "axis_{}", "proxy_{}_mm", "normal_{}", "force_{}_n")
NAMES = (["tick", "time_s", "dt_s"] + [n.format(a) for n in THREE for a in "xyz"] +
         ["buttons", "touched", "face", "inside", "held_by", "events", "faults", "late_us"])
OF_TICK = ("tick", "time_s", "dt_s", "late_us")
EVENTS = ("touch", "untouch", "motion", "popped", "left", "locked", "unlocked", "breach")
FAULTS = ("pose", "time step", "force", "device lost", "jump", "gap")


def names(bits, known):
    return "+".join(name for bit, name in enumerate(known) if bits >> bit & 1)


def of_recording(data):
    version, length = struct.unpack_from("<II", data, 8)
    if version != VERSION:
        raise ValueError(f"version {version}, this program reads version {VERSION}")
    if 16 + length > len(data):
        raise ValueError("the header is cut short")
    header = json.loads(data[16:16 + length])
    each = header["frame_bytes"]
    rest = len(data) - 16 - length
    hands = 2 if "second" in header else 1
    ticks = rest // (hands * each)
    if each not in (216, 240) or rest % (hands * each) or header.get("frames", ticks) != ticks:
        raise ValueError("the frames are cut short")
    frame = struct.Struct("<Q17dI4i3I40x" + ("3d" if each == 240 else ""))
    known = NAMES + ([f"across_{a}" for a in "xyz"] if each == 240 else [])
    rows = list(frame.iter_unpack(data[16 + length:]))
    columns = columns_of(known, rows[::hands])
    if hands == 2:  # in each tick the first hand's frame, and then the other one's
        columns.update(("second_" + n, v) for n, v in columns_of(known, rows[1::2]).items() if n not in OF_TICK)
    return header, columns


def columns_of(known, rows):
    columns = dict(zip(known, map(list, zip(*rows)))) or {n: [] for n in known}
    columns["force_n"] = [math.hypot(*f) for f in zip(*(columns[f"force_{a}_n"] for a in "xyz"))]
    for name, every in (("events", EVENTS), ("faults", FAULTS)):
        columns[name] = [names(bits, every) for bits in columns[name]]
    return columns


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    if data[:8] == b"TREPHSRV":
        return of_recording(data)
    text = json.loads(data)
    known = [column["name"] for column in text["columns"]]
    return text["header"], dict(zip(known, map(list, zip(*text["frames"])))) or {n: [] for n in known}


if __name__ == "__main__":
    header, columns = read(sys.argv[1])
    print(f"case {header['case']}, {len(columns['tick'])} frames at {header['rate_hz']:g} Hz of {header['device']}, "
          f"at most {max(columns['force_n'], default=0):.3f} N")
