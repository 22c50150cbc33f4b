# SPDX-License-Identifier: GPL-3.0-or-later
"""A case as an environment with the interface of Gymnasium (reset, step, spaces), which need not be installed."""
from typing import Any, Callable, Dict, Optional, Tuple, Union

import numpy as np

from trephine.case import Case, Path
from trephine.recording import EVENTS, FAULTS, names_of
from trephine.session import Session

try:
    from gymnasium import spaces
except ImportError:
    from trephine import _spaces as spaces

PEDAL = 1
_BREACH = 1 << EVENTS.index("breach")
#: Of the frames of a step and what each shape lost in it, in mm^3.
Reward = Callable[[np.ndarray, Dict[str, float]], float]


def removed(frames: np.ndarray, removed_mm3: Dict[str, float]) -> float:
    """The reward where none is given: what was cut in the step, in mm^3."""
    return float(sum(removed_mm3.values()))


class CaseEnv:
    """A tool in a case. An action is 7 numbers from -1 to 1; what lies beyond is clipped: how far the tip moves along x, y and z
    (LPS; 1 is step_mm), how far the tool turns about them (1 is turn_rad), and the drill's pedal, down above 0. A step lasts
    ticks_per_step ticks of the servo loop, in which the tool goes straight.

    An observation has force_n (of the last tick), tip_mm and axis (where the hand is), proxy_mm (where the tool is shown), and
    patch, the raw voxels about proxy_mm (case package; [k, j, i] along the volume's axes).

    An episode begins with the tip at begin_mm, moved by up to jitter_mm along each axis by the seed; where begin_mm is not given,
    10 mm before the surface that `axis` first meets on its way to the middle of the volume. It is terminated where a drill breaks
    through (`breach`), and truncated after max_steps. info has touched, removed_mm3 (of the episode), events and faults by name.
    Other parameters are those of Session, but for those of lessons. reset(options={"record": FILE}) records the episode; close() or the next reset()
    completes the file."""

    metadata: Dict[str, Any] = {"render_modes": []}
    render_mode: Optional[str] = None
    spec = None

    def __init__(self, case: Union[Case, Path], *, tool: str = "burr", drill: bool = True, begin_mm: Any = None,
                 axis: Any = (0.0, 0.0, 1.0), jitter_mm: float = 0.0, step_mm: float = 0.5, turn_rad: float = 0.05,
                 ticks_per_step: int = 10, max_steps: int = 1000, patch_size: int = 16, reward: Reward = removed, **params: Any):
        for name, value in (("ticks_per_step", ticks_per_step), ("max_steps", max_steps), ("patch_size", patch_size)):
            if not (isinstance(value, int) and value >= 1):
                raise ValueError(f"{name}: must be a whole number of 1 or more, not {value!r}")
        if patch_size > 256:
            raise ValueError(f"patch_size: must be 256 or less, not {patch_size}")
        for name, value in (("jitter_mm", jitter_mm), ("step_mm", step_mm), ("turn_rad", turn_rad)):
            if not 0 <= value < np.inf:
                raise ValueError(f"{name}: must be 0 or more, not {value!r}")
        for name in {"lesson", "participant", "task"} & params.keys():
            raise ValueError(f"{name}: an action takes up no tool, and a lesson has several: make a Session of it")
        self.session = Session(case, tool=tool, drill=drill, **params)
        self._axis = _unit(axis, "axis")
        self._begin_mm = self._before_surface() if begin_mm is None else _place(begin_mm, "begin_mm")
        self._jitter_mm, self._step_mm, self._turn_rad = float(jitter_mm), float(step_mm), float(turn_rad)
        self._ticks, self._max_steps, self._patch_size, self._reward = ticks_per_step, max_steps, patch_size, reward
        self._shares = np.arange(1, ticks_per_step + 1)[:, None] / ticks_per_step
        self._steps: Optional[int] = None  # of the episode; None where there is none
        self._used = False
        self.np_random = np.random.default_rng()
        self.action_space = spaces.Box(-1.0, 1.0, (7,), np.float32)
        place = dict(low=-np.inf, high=np.inf, shape=(3,), dtype=np.float64)
        self.observation_space = spaces.Dict({
            "force_n": spaces.Box(**place), "tip_mm": spaces.Box(**place), "proxy_mm": spaces.Box(**place),
            "axis": spaces.Box(**place),
            "patch": spaces.Box(low=-32768, high=32767, shape=(patch_size,) * 3, dtype=np.int16)})

    @property
    def unwrapped(self) -> "CaseEnv":
        return self

    def reset(self, *, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None) -> Tuple[Dict[str, Any], Dict[str, Any]]:
        if seed is not None:
            self.np_random = np.random.default_rng(seed)
        record = (options or {}).get("record")
        if self._used or record is not None:
            self.session.reset(record)
        self._used, self._steps, self._removed = True, 0, {}
        self._tip_mm = self._begin_mm + self.np_random.uniform(-1, 1, 3) * self._jitter_mm
        self._now_axis = self._axis
        frames = self.session.run(self._tip_mm[None], self._now_axis)
        return self._observation(frames), self._info(frames)

    def step(self, action: Any) -> Tuple[Dict[str, Any], float, bool, bool, Dict[str, Any]]:
        if self._steps is None:
            raise RuntimeError("no episode goes on: call reset()")
        action = np.asarray(action, float)
        if action.shape != (7,) or not np.isfinite(action).all():
            raise ValueError(f"an action is 7 finite numbers, not {action!r}")
        action = np.clip(action, -1, 1)
        tips = self._tip_mm + self._shares * (action[:3] * self._step_mm)
        turned = _turned(self._now_axis, action[3:6] * self._turn_rad)
        axes = self._now_axis + self._shares * (turned - self._now_axis)
        axes /= np.linalg.norm(axes, axis=1)[:, None]
        frames = self.session.run(tips, axes, PEDAL if action[6] > 0 else 0)
        self._tip_mm, self._now_axis = tips[-1], axes[-1]
        self._steps += 1
        before, info = self._removed, self._info(frames)
        reward = self._reward(frames, {n: v - before.get(n, 0.0) for n, v in info["removed_mm3"].items()})
        terminated = bool((frames["events"] & _BREACH).any())
        truncated = not terminated and self._steps >= self._max_steps
        if terminated or truncated:
            self._steps = None
        return self._observation(frames), float(reward), terminated, truncated, info

    def render(self) -> None:
        return None

    def close(self) -> None:
        self._used, self._steps = True, None
        self.session.finish()

    def _observation(self, frames: np.ndarray) -> Dict[str, Any]:
        last = frames[-1]
        return {"force_n": last["force_n"].copy(), "tip_mm": last["tip_mm"].copy(), "axis": last["axis"].copy(),
                "proxy_mm": last["proxy_mm"].copy(), "patch": self.session.patch(last["proxy_mm"], self._patch_size)}

    def _info(self, frames: np.ndarray) -> Dict[str, Any]:
        self._removed = self.session.removed_mm3
        bits = np.bitwise_or.reduce(frames["events"]), np.bitwise_or.reduce(frames["faults"])
        return {"touched": self.session.shapes.get(int(frames[-1]["touched"]), ""), "removed_mm3": self._removed,
                "events": names_of(bits[0], EVENTS), "faults": names_of(bits[1], FAULTS)}

    def _before_surface(self) -> np.ndarray:
        volume = self.session.volume
        size = np.array(volume.voxels.shape[::-1])
        middle = volume.position_mm((size - 1) / 2)
        far = middle + self._axis * np.linalg.norm(size * volume.spacing_mm)
        hit = self.session.first_hit(far, middle)
        if hit is None:
            raise ValueError("begin_mm: is missing, and no surface lies between the volume's middle and the direction of axis")
        return hit.point_mm + 10 * self._axis


def _place(value: Any, name: str) -> np.ndarray:
    try:
        out = np.array(value, float)
    except (TypeError, ValueError):
        out = np.empty(0)
    if out.shape != (3,) or not np.isfinite(out).all():
        raise ValueError(f"{name}: must be three finite numbers, not {value!r}")
    return out


def _unit(value: Any, name: str) -> np.ndarray:
    out = _place(value, name)
    if not np.linalg.norm(out) > 0:
        raise ValueError(f"{name}: must be a direction, not {value!r}")
    return out / np.linalg.norm(out)


def _turned(axis: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """The axis turned about `rotation` by its length, in radians (Rodrigues)."""
    angle = np.linalg.norm(rotation)
    if angle == 0:
        return axis
    about = rotation / angle
    return axis * np.cos(angle) + np.cross(about, axis) * np.sin(angle) + about * (about @ axis) * (1 - np.cos(angle))
