# SPDX-License-Identifier: GPL-3.0-or-later
"""Trephine's cases, stages and haptic sessions for Python. Positions are DICOM patient LPS in mm, forces in N on the hand.

    import trephine
    case = trephine.load_case("library/head-01")
    case.surfaces["skull"].points_mm        # a view of what was loaded, (n, 3) float64

A gym-like environment is in trephine.env, which this does not import.
"""
import os as _os

from trephine import _native
from trephine._errors import Error, InputError
from trephine.case import Case, load_case
from trephine.meshing import (Mesh, Outcome, burr_hole, check, contour, cut, decimate, measure, normals, remesh, repair, smooth)
from trephine.recording import Recording, read_recording, replay
from trephine.session import Session
from trephine.volume import Volume

__version__: str = _native.version
__all__ = ["Case", "Error", "InputError", "Mesh", "Outcome", "Recording", "Session", "Volume", "burr_hole", "check", "contour",
           "cut", "decimate", "load_case", "measure", "normals", "read_recording", "remesh", "repair", "replay",
           "set_thread_count", "smooth", "thread_count"]

# What may fall or hang runs in a child, and Python is none.
_native.set_child_program(_os.path.join(_os.path.dirname(_os.path.abspath(_native.__file__)), "trephine-worker"))


def set_thread_count(count: int) -> None:
    """How many threads stages and loading use; 0: one for each core."""
    _native.set_thread_count(count)


def thread_count() -> int:
    return _native.thread_count()
