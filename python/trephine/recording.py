# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings of trephine-sim (docs/reference/recordings.md)."""
import json
import os
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Tuple

import numpy as np

from trephine import _native
from trephine.case import Path

FRAME: np.dtype = _native.frame_dtype
EVENTS: Tuple[str, ...] = tuple(_native.event_names)
FAULTS: Tuple[str, ...] = tuple(_native.fault_names)


@dataclass(frozen=True, eq=False)
class Recording:
    """frames: a row for each tick, with the columns of FRAME: frames["force_n"] is (n, 3). seal: "sealed", "not sealed" or
    "broken seal", which says whether the bytes are those that were written. second: the other hand's rows of the same ticks, where
    there were two hands."""

    header: Dict[str, Any]
    frames: np.ndarray
    seal: str
    sha256: str
    second: Optional[np.ndarray] = None


def names_of(bits: int, names: Tuple[str, ...]) -> List[str]:
    """Of a frame's events or faults: names_of(frame["events"], EVENTS)."""
    return [name for bit, name in enumerate(names) if int(bits) >> bit & 1]


def read_recording(file: Path) -> Recording:
    header, frames, seal, sha256, second = _native.read_recording(os.fspath(file))
    return Recording(json.loads(header), frames, seal, sha256, second)


def replay(case: Path, file: Path) -> Tuple[np.ndarray, str]:
    """Runs a recording again in its case: the first hand's frames, which are those of the recording bit for bit but for late_us, and
    the hash of the voxels at the end (header["outcome"]["volume_sha256"], where something was cut). A recording with a broken seal
    is refused (80)."""
    return _native.replay(os.fspath(case), os.fspath(file))
