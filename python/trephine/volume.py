# SPDX-License-Identifier: GPL-3.0-or-later
"""Voxels and where they lie."""
from dataclasses import dataclass, field
from typing import Any, Tuple

import numpy as np


@dataclass(frozen=True, eq=False)
class Volume:
    """voxels[k, j, i]: i is the first axis of the volume. The columns of direction are its axes, of length 1; the centre of voxel
    (i, j, k) is origin_mm + direction @ ((i, j, k) * spacing_mm)."""

    voxels: np.ndarray
    spacing_mm: np.ndarray = field(default_factory=lambda: np.ones(3))
    origin_mm: np.ndarray = field(default_factory=lambda: np.zeros(3))
    direction: np.ndarray = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        for name, shape, what in (("spacing_mm", (3,), "three numbers"), ("origin_mm", (3,), "three numbers"),
                                  ("direction", (3, 3), "a matrix of 3 x 3")):
            value = getattr(self, name)
            try:
                array = np.asarray(value, float)
            except (TypeError, ValueError):
                array = np.empty(0)
            if array.shape != shape:
                raise ValueError(f"{name} must be {what}, not {value!r}")
            object.__setattr__(self, name, array)

    @property
    def affine(self) -> np.ndarray:
        """4 x 4: takes (i, j, k, 1) to LPS mm."""
        out = np.eye(4)
        out[:3, :3] = self.direction * self.spacing_mm
        out[:3, 3] = self.origin_mm
        return out

    def position_mm(self, ijk: Any) -> np.ndarray:
        """Of indices (..., 3), the places in LPS mm."""
        return np.asarray(ijk, float) @ self.affine[:3, :3].T + self.origin_mm

    def index(self, position_mm: Any) -> np.ndarray:
        """Of places (..., 3) in LPS mm, the indices (i, j, k), with what lies between voxels."""
        return (np.asarray(position_mm, float) - self.origin_mm) @ np.linalg.inv(self.affine[:3, :3]).T

    def _place(self) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.spacing_mm, self.origin_mm, self.direction
