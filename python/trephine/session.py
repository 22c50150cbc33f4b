# SPDX-License-Identifier: GPL-3.0-or-later
"""A tool in a case, moved tick by tick."""
import json
import os
from typing import Any, Dict, NamedTuple, Optional, Union

import numpy as np

from trephine import _native
from trephine._params import to_json
from trephine.case import Case, Path
from trephine.volume import Volume


class Hit(NamedTuple):
    """Where a line first meets a surface: the normal points to where the line came from."""

    point_mm: np.ndarray
    normal: np.ndarray
    shape: str


class Session:
    """The contact, force and drilling of `trephine-sim servo`, whose parameters it takes by name: tool="burr", drill=True,
    tool_diameter_mm=4, spindle_rpm=60000, max_force_n=3. With lesson="ventriculostomy" (participant, task) the tools are the
    lesson's, and `trephine-sim score` judges the recording. The case is loaded anew, for what is cut of it changes.

    Equal poses give equal bits, those of a recording by trephine-sim. record: every tick is written to that file, which is there
    after finish(). As `with Session(...) as s:` it is finished at the end, or dropped where an exception passes."""

    def __init__(self, case: Union[Case, Path], *, record: Optional[Path] = None, **params: Any):
        folder = case.folder if isinstance(case, Case) else os.fspath(case)
        self._hand = _native.Hand(folder, to_json(params), _text(record))
        self._records = record is not None
        self.header: Dict[str, Any] = json.loads(self._hand.header)
        if isinstance(case, Case) and self.header["case_sha256"] != case.sha256:
            raise ValueError(f"{folder}: the case was changed since it was loaded")
        self.shapes: Dict[int, str] = self._hand.shapes
        voxels, place = self._hand.voxels
        #: What is felt: a view of the voxels as they now are, through cuts and reset().
        self.volume = Volume(voxels, *place)
        self.outcome: Optional[Dict[str, Any]] = None

    def step(self, tip_mm: Any, axis: Any, buttons: Any = 0, across: Any = None) -> np.void:
        """One tick with the tool there: axis points from tip to tail, and has length 1. Button 1 (bit 0) is the drill's pedal.
        Gives the tick as a recording has it (trephine.recording.FRAME): force_n on the hand, proxy_mm where the tool is shown,
        touched the number of the shape."""
        return self._hand.step(tip_mm, axis, buttons, across)[()]

    def run(self, tip_mm: np.ndarray, axis: Any, buttons: Any = 0, across: Any = None) -> np.ndarray:
        """A tick for each row of tip_mm (n, 3); the others have a value for each row, or one for all."""
        return self._hand.run(tip_mm, axis, buttons, across)

    def reset(self, record: Optional[Path] = None) -> None:
        """Completes the recording, where there is one, and begins another session with the patient as the case has it."""
        if self._records:
            self.finish()
        self._records = False
        self._hand.reset(_text(record))
        self._records, self.outcome = record is not None, None

    def finish(self) -> Dict[str, Any]:
        """Ends the session and completes the recording; what was cut, where something can be."""
        made = self._hand.finish()
        if made is not None:
            self.outcome = json.loads(made)
        return self.outcome or {}

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, kind: Any, *_: Any) -> None:
        if kind is None:
            self.finish()
        else:
            self._hand.drop()

    @property
    def torque_n_mm(self) -> np.ndarray:
        """On the hand, about the tip, in the last tick."""
        return self._hand.torque_n_mm

    @property
    def removed_mm3(self) -> Dict[str, float]:
        """What was cut so far, by shape; once the session has ended, what was cut in it."""
        return self._hand.removed_mm3

    def patch(self, place_mm: Any, size: int = 16) -> np.ndarray:
        """A copy of the raw voxels about a place, [k, j, i] along the volume's axes; beyond the volume, what is felt there."""
        return self._hand.patch(place_mm, size)

    def shape_at(self, place_mm: Any) -> str:
        """The shape that holds the place; "" for none."""
        return self.shapes.get(self._hand.shape_at(place_mm), "")

    def first_hit(self, start_mm: Any, end_mm: Any) -> Optional[Hit]:
        """Where the line first meets a surface of what is felt now; None where it meets none."""
        hit = self._hand.first_hit(start_mm, end_mm)
        return None if hit is None else Hit(hit[0], hit[1], self.shapes.get(hit[2], ""))


def _text(path: Optional[Path]) -> str:
    return "" if path is None else os.fspath(path)
