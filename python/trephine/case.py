# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading a case."""
import json
import os
from typing import Any, Dict, List, Optional, Union

import numpy as np

from trephine import _native
from trephine.meshing import Mesh
from trephine.volume import Volume

Path = Union[str, "os.PathLike[str]"]


class Case:
    """A loaded case; every checksum was compared. Arrays are views of what was loaded: they cost no copy, cannot be written to,
    and remain good when the case is gone. A copy (`array.copy()`) can be changed.

    manifest: case.json (docs/reference/case-package.md). surfaces: by anatomy. haptic: what is felt, with the raw values of the
    case package; hardness on the same voxels; ct in HU. They are None where the case has none, or the CT was not asked for."""

    def __init__(self, folder: Path, native: "_native.Case"):
        self.folder = os.fspath(folder)
        self.sha256: str = native.sha256
        self.manifest: Dict[str, Any] = json.loads(native.manifest)
        self.surfaces: Dict[str, Mesh] = dict(native.surfaces)
        self.haptic = _volume(native.haptic)
        self.hardness = _volume(native.hardness)
        self.ct = _volume(native.ct)

    @property
    def token(self) -> str:
        return self.manifest["case"]

    @property
    def landmarks(self) -> Dict[str, np.ndarray]:
        """LPS mm, by name."""
        return _positions(self.manifest["landmarks"])

    @property
    def targets(self) -> Dict[str, np.ndarray]:
        return _positions(self.manifest["targets"])

    @property
    def burr_holes(self) -> List[Dict[str, Any]]:
        return self.manifest["burr_holes"]

    @property
    def figures(self) -> Dict[str, Any]:
        """What was measured on the patient."""
        return self.manifest.get("figures", {})

    @property
    def deviations_mm(self) -> Dict[str, Dict[str, float]]:
        """By anatomy: max, p99 and rms of the two-sided deviation from the surface before decimation."""
        return {a["name"]: a["deviation_mm"] for a in self.manifest["anatomies"]}

    @property
    def colours_rgb(self) -> Dict[str, List[float]]:
        return {a["name"]: a["colour_rgb"] for a in self.manifest["anatomies"]}

    def shape(self, name: str) -> np.ndarray:
        """A mask over haptic.voxels: where that shape is. KeyError where there is none."""
        for shape in self.manifest.get("haptic", {}).get("shapes", []):
            if shape["name"] == name:
                low, high = shape["window"]
                return (self.haptic.voxels >= low) & (self.haptic.voxels <= high)
        raise KeyError(name)


def _volume(native: Any) -> Optional[Volume]:
    return None if native is None else Volume(native[0], *native[1])


def _positions(items: List[Dict[str, Any]]) -> Dict[str, np.ndarray]:
    return {item["name"]: np.array(item["position_mm"], float) for item in items}


def load_case(folder: Path, ct: bool = False, compare_all: bool = False) -> Case:
    """Loads a case and verifies all of it, as trephine-sim does. ct: its CT too. compare_all: also the comparisons of
    `trephine-sim check`. Raises Error with exit_code 66 where a file is missing, InputError (65) where one is damaged."""
    return Case(folder, _native.load_case(os.fspath(folder), ct, compare_all))
