#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""numpy: from voxels of one's own to a surface that is valid, small and has a hole. The voxels here are a shell by a formula.

    python3 own_surface.py OUT.npz
"""
import sys

import numpy as np

import trephine

spacing_mm = 1.5
z, y, x = np.meshgrid(*[(np.arange(64) - 31.5) * spacing_mm] * 3, indexing="ij")
radius = np.sqrt(x ** 2 + (y / 1.2) ** 2 + z ** 2)
volume = trephine.Volume((3 - abs(radius - 33)).astype(np.float32), np.full(3, spacing_mm), np.full(3, -31.5 * spacing_mm))

full = trephine.contour(volume, field=True, keep_cavities=True).value
few = trephine.decimate(full, max_deviation_mm=0.1)
print(f"{len(full.triangles)} triangles, then {len(few.value.triangles)}: {few.figures['stopped_by']}")
even = trephine.smooth(few.value, reference=full, total_deviation_mm=0.2).value

hole = trephine.burr_hole(full, position_mm=[0, 0, 36], diameter_mm=12)
print(f"bone of {hole.figures['bone_thickness_mm']:.1f} mm under the hole")
cut = trephine.cut(even, hole.value)
skull = trephine.normals(cut.value).value
print(f"{cut.figures['removed_mm3']:.0f} mm^3 removed, {len(skull.triangles)} triangles")

valid, text = trephine.check(skull)
print(text)
measured = trephine.measure(few.value, reference=full)
print(f"decimated: {measured['deviation_max_mm']:.3f} mm off at most, RMS {measured['deviation_rms_mm']:.4f} mm")
np.savez_compressed(sys.argv[1], points_mm=skull.points_mm, triangles=skull.triangles, normals=skull.normals)
sys.exit(0 if valid else 1)
