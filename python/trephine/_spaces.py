# SPDX-License-Identifier: GPL-3.0-or-later
"""What an environment says of its actions and observations where gymnasium is not installed: the same names and calls."""
from typing import Any, Dict as DictOf, Optional

import numpy as np


class Box:
    """Arrays of a shape, each value from low to high."""

    def __init__(self, low: float, high: float, shape: tuple, dtype: Any = np.float32):
        self.shape, self.dtype = tuple(shape), np.dtype(dtype)
        self.low = np.full(self.shape, low, self.dtype)
        self.high = np.full(self.shape, high, self.dtype)
        self._random = np.random.default_rng()

    def seed(self, seed: Optional[int] = None) -> None:
        self._random = np.random.default_rng(seed)

    def sample(self) -> np.ndarray:
        low, high = self.low.astype(float), self.high.astype(float)
        if self.dtype.kind == "i":
            return self._random.integers(self.low, self.high, endpoint=True, dtype=self.dtype)
        unbounded = ~(np.isfinite(low) & np.isfinite(high))
        low, high = np.where(unbounded, 0, low), np.where(unbounded, 1, high)
        made = np.where(unbounded, self._random.normal(size=self.shape), self._random.uniform(low, high))
        return made.astype(self.dtype)

    def contains(self, x: Any) -> bool:
        return (isinstance(x, np.ndarray) and x.shape == self.shape and x.dtype == self.dtype and
                bool(np.all(x >= self.low) and np.all(x <= self.high)))

    __contains__ = contains

    def __repr__(self) -> str:
        return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, {self.dtype})"


class Dict:
    """Spaces by name."""

    def __init__(self, spaces: DictOf[str, Any]):
        self.spaces = dict(spaces)

    def seed(self, seed: Optional[int] = None) -> None:
        for number, space in enumerate(self.spaces.values()):
            space.seed(None if seed is None else seed + number)

    def sample(self) -> DictOf[str, Any]:
        return {name: space.sample() for name, space in self.spaces.items()}

    def contains(self, x: Any) -> bool:
        return isinstance(x, dict) and x.keys() == self.spaces.keys() and all(s.contains(x[n]) for n, s in self.spaces.items())

    __contains__ = contains

    def __getitem__(self, name: str) -> Any:
        return self.spaces[name]
