#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a recorded session of trephine-sim with the standard library alone, from the recording itself (docs/reference/recordings.md,
"Recordings") or from the JSON of `trephine-sim export-recording --json`.

    python3 read_recording.py FILE            says what is in it
    header, columns = read_recording.read("FILE")    columns["force_n"][17]: positions LPS mm, forces N, times s

The seal is compared, and a recording that was changed after it was written is refused. One that was written into a pipe has none.
"""
import hashlib
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


class RecordingError(ValueError):
    """What is wrong with the file; a line. exit_code is that of the program: 65, or 80 for a broken seal."""

    def __init__(self, what, exit_code=65):
        super().__init__(what)
        self.exit_code = exit_code


def names(bits, known):
    return "+".join(name for bit, name in enumerate(known) if bits >> bit & 1)


def is_sealed(header, head, frames):
    """False where the seal is not of these bytes."""
    said = header.get("seal_sha256")
    if said is None:
        return True
    before, found, after = head.rpartition(str(said).encode())
    return bool(found) and hashlib.sha256(frames + before + b"0" * 64 + after).hexdigest() == said


def of_recording(data):
    if len(data) < 16:
        raise RecordingError("is cut short")
    version, length = struct.unpack_from("<II", data, 8)
    if version != VERSION:
        raise RecordingError(f"version: {version}, this program reads version {VERSION}")
    if 16 + length > len(data):
        raise RecordingError("header: is cut short")
    try:
        header = json.loads(data[16:16 + length])
        each = header["frame_bytes"]
    except (ValueError, KeyError, TypeError):
        raise RecordingError("header: is damaged") from None
    hands = 2 if "second" in header else 1
    ticks, left = divmod(len(data) - 16 - length, hands * each) if each in (216, 240) else (0, 1)
    if left or header.get("frames", ticks) != ticks:
        raise RecordingError("frames: are cut short, or too many")
    if not is_sealed(header, data[:16 + length], data[16 + length:]):
        raise RecordingError("seal_sha256: is not of these bytes: the recording was changed after it was written", 80)
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
    try:
        text = json.loads(data)
        known, seal, frames = [column["name"] for column in text["columns"]], text["seal"], text["frames"]
        header, columns = text["header"], dict(zip(known, map(list, zip(*frames)))) or {n: [] for n in known}
    except (ValueError, KeyError, TypeError):
        raise RecordingError("is no recording of trephine-sim, nor its JSON") from None
    if seal == "broken seal":
        raise RecordingError("seal: was broken before it was exported: the recording was changed after it was written", 80)
    return header, columns


def main(words):
    if len(words) != 2:
        print("usage: read_recording.py FILE", file=sys.stderr)
        return 64
    try:
        header, columns = read(words[1])
    except RecordingError as error:
        print(f"{words[1]}: {error}", file=sys.stderr)
        return error.exit_code
    except OSError as error:
        print(error, file=sys.stderr)
        return 66
    force_n = max((f for f in columns["force_n"] if f is not None), default=0)  # null: not finite
    print(f"case {header['case']}, {len(columns['tick'])} frames at {header['rate_hz']:g} Hz of {header['device']}, "
          f"at most {force_n:.3f} N")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
