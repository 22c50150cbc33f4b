#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""numpy: what a case holds, and how thick its bone is under each landmark.

    python3 measure_case.py CASE
"""
import sys

import numpy as np

import trephine

case = trephine.load_case(sys.argv[1])
print(f"case {case.token}")
for name, surface in case.surfaces.items():
    low, high = surface.points_mm.min(axis=0), surface.points_mm.max(axis=0)
    print(f"{name}: {len(surface.triangles)} triangles, {surface.volume_mm3 / 1000:.1f} ml, "
          f"{' x '.join(f'{d:.0f}' for d in high - low)} mm, at most {case.deviations_mm[name]['max']:.3f} mm off")

if case.haptic is not None:
    voxel_ml = abs(np.linalg.det(case.haptic.affine)) / 1000
    middle = case.haptic.position_mm((np.array(case.haptic.voxels.shape[::-1]) - 1) / 2)
    for shape in case.manifest["haptic"]["shapes"]:
        print(f"{shape['name']}: {case.shape(shape['name']).sum() * voxel_ml:.1f} ml in voxels that it fills, wholly or partly")
    session = trephine.Session(case)
    for name, at in case.landmarks.items():
        inward = (middle - at) / np.linalg.norm(middle - at)
        along = [session.shape_at(at + inward * d) for d in np.arange(-5, 25, 0.1)]
        print(f"{name}: at {np.round(at, 1).tolist()}, " +
              (", ".join(f"{along.count(s) / 10:.1f} mm of {s}" for s in dict.fromkeys(along) if s) or "nothing is felt there"))
