# SPDX-License-Identifier: GPL-3.0-or-later
"""Stages on arrays: the functions behind commands of `trephine`, with the same parameters by name (`trephine decimate --help`).
burr_hole is the command burrhole, cut is boolean; the others have the command's name, but for check, which is none. Each gives an Outcome. Ctrl-C ends them, and other threads of Python go on."""
import json
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from trephine import _native
from trephine._params import to_json
from trephine.volume import Volume

Mesh = _native.Mesh


class Outcome(NamedTuple):
    """value: what was made. figures: what was measured of it. warnings: lines that a person should read."""

    value: Any
    figures: Dict[str, Any]
    warnings: List[str]


def _outcome(native: Tuple[Any, str, List[str]]) -> Outcome:
    return Outcome(native[0], json.loads(native[1]), list(native[2]))


def contour(volume: Volume, *, field: bool = False, **params: Any) -> Outcome:
    """The closed surface of a CT (int16 or float32 HU) at isovalue_hu, or of a field (float32, positive inside) at 0."""
    return _outcome(_native.contour(volume.voxels, volume._place(), field, to_json(params)))


def decimate(mesh: Mesh, **params: Any) -> Outcome:
    """Fewer triangles within max_deviation_mm."""
    return _outcome(_native.decimate(mesh, to_json(params)))


def smooth(mesh: Mesh, reference: Optional[Mesh] = None, **params: Any) -> Outcome:
    """Smoothed within max_displacement_mm; with a reference also within total_deviation_mm of it."""
    return _outcome(_native.smooth(mesh, reference, to_json(params)))


def repair(mesh: Mesh, **params: Any) -> Outcome:
    """A closed, valid surface of a mesh of any kind."""
    return _outcome(_native.repair(mesh, to_json(params)))


def remesh(mesh: Mesh, **params: Any) -> Outcome:
    """Even triangles within a bound."""
    return _outcome(_native.remesh(mesh, to_json(params)))


def normals(mesh: Mesh, **params: Any) -> Outcome:
    """The same surface with a normal for each point."""
    return _outcome(_native.normals(mesh, to_json(params)))


def cut(mesh: Mesh, cutters: Sequence[Mapping[str, Any]], **params: Any) -> Outcome:
    """Cuts solids out of a surface, exactly. A cutter is a dict as `trephine burrhole` writes it (kind, position_mm, ...), or
    {"kind": "mesh", "mesh": MESH}."""
    solids, plain = [], []
    for number, cutter in enumerate(cutters):
        cutter = dict(cutter)
        if cutter.get("kind") == "mesh":
            if not isinstance(cutter.get("mesh"), Mesh):
                raise ValueError(f"cutters[{number}].mesh: must be a Mesh")
            solids.append(cutter.pop("mesh"))
            cutter["file"] = ""
        plain.append(cutter)
    return _outcome(_native.cut(mesh, to_json({"cutters": plain}), solids, to_json(params)))


def burr_hole(bone: Mesh, position_mm: Any, over: Optional[Mesh] = None, **params: Any) -> Outcome:
    """Places a burr hole on a bone that is not decimated, under the skin `over`. The value is the list of cutters for cut()."""
    params = {"at": "position", "position_mm": position_mm, **params}
    made = _outcome(_native.burr_hole(bone, over, to_json(params)))
    return made._replace(value=json.loads(made.value)["cutters"])


def check(mesh: Mesh) -> Tuple[bool, str]:
    """Whether the surface is closed, 2-manifold, oriented outwards and free of self-intersections and degenerate triangles; and
    a line that says what is wrong."""
    return _native.check(mesh)


def measure(mesh: Mesh, reference: Optional[Mesh] = None, **params: Any) -> Dict[str, Any]:
    """Validity with the places of faults, volume, area, quality; against a reference also the two-sided deviation in mm."""
    return _outcome(_native.measure(mesh, reference, to_json(params))).figures
