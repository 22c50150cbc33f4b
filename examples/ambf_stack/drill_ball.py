#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Removes a ball from what `trephine export CASE --format ambf` wrote, as volumetric_drilling saves it; with numpy, PyYAML and Pillow.

    python3 drill_ball.py CASE.ambf PLACE DIAMETER_MM OUT     PLACE: a name of fiducial_locations, or X,Y,Z: LPS, mm"""
import pathlib
import sys

import numpy as np
import yaml
from PIL import Image

folder, place, diameter_mm, out = pathlib.Path(sys.argv[1]), sys.argv[2], float(sys.argv[3]), pathlib.Path(sys.argv[4])
adf = yaml.safe_load((folder / "volume.yaml").read_text())
volume, images = adf["VOLUME mastoidectomy_volume"], adf["VOLUME mastoidectomy_volume"]["images"]


def vector(values, names="xyz"):
    return np.array([values[n] for n in names], float)


def rotation(angles):
    """Roll, pitch and yaw about the fixed axes x, y, z, as AMBF has them."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles), np.sin(angles)
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


# The stack as [slice, row from the top, column, RGBA].
stack = np.array([np.array(Image.open(folder / images["path"] / f"{images['prefix']}{n}.{images['format']}")) for n in range(images["count"])])

# Where the middle of each voxel lies in the patient, mm. AMBF counts rows from the bottom, and the volume's frame is at its middle.
size = np.array(stack.shape[2::-1])
step = vector(volume["dimensions"]) / size
k, row, i = np.meshgrid(*map(np.arange, stack.shape[:3]), indexing="ij")
voxel = np.stack([i, size[1] - 1 - row, k], axis=-1)
in_volume = (voxel + 0.5 - size / 2) * step
in_patient = in_volume @ rotation(vector(volume["location"]["orientation"], "rpy")).T + vector(volume["location"]["position"])
mm = 1000 * in_patient

if place in adf["fiducial_locations"]:
    middle = 1000 * vector(adf["fiducial_locations"][place])
else:
    middle = np.array([float(c) for c in place.split(",")])
gone = (np.linalg.norm(mm - middle, axis=-1) <= diameter_mm / 2) & (stack[..., 3] > 0)
stack[gone] = 0
out.mkdir(parents=True, exist_ok=True)
for n, picture in enumerate(stack):
    Image.fromarray(picture, "RGBA").save(out / f"{images['prefix']}{n}.png")
print(f"middle {middle[0]:.2f} {middle[1]:.2f} {middle[2]:.2f} mm LPS: {gone.sum()} voxels, {gone.sum() * step.prod() * 1e9:.1f} mm3")
