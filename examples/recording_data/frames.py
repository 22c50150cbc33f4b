#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a recording that `trephine-sim render CASE RECORDING --hdf5 FILE` wrote: python3 frames.py FILE

For each frame it says where the tool's tip is seen and what part of the picture each label fills, and at the end what was
drilled. The layout is that of volumetric_drilling's recorder, so its own readers take the file too.
"""
import sys

import h5py
import numpy as np


def matrix(pose):
    """T_world_obj of a pose x y z qx qy qz qw."""
    x, y, z, w = pose[3:]
    m = np.eye(4)
    m[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                 [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                 [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    m[:3, 3] = pose[:3]
    return m


def cv_from_world(f, frame):
    return f["metadata/camera_extrinsic"][()] @ np.linalg.inv(matrix(f["data/pose_main_camera"][frame]))


def pixel_of(f, frame, world_m):
    """u, v and depth (m) of a point; whole numbers are the middles of pixels."""
    p = f["metadata/camera_intrinsic"][()] @ (cv_from_world(f, frame) @ [*world_m, 1])[:3]
    return p[0] / p[2], p[1] / p[2], p[2]


def points_of(f, frame):
    """The world point (m) of each pixel in which something is seen, and the pixels' labels."""
    depth, label = f["data/depth"][frame], f["data/label"][frame]
    v, u = np.nonzero(label)
    z = depth[v, u]
    rays = np.linalg.inv(f["metadata/camera_intrinsic"][()]) @ np.vstack([u, v, np.ones_like(u)])
    camera = np.vstack([rays * z, np.ones_like(z)])
    return (np.linalg.inv(cv_from_world(f, frame)) @ camera)[:3].T, label[v, u]


if __name__ == "__main__":
    f = h5py.File(sys.argv[1])
    names = [n.decode() for n in f["metadata/label_names"]]
    for n, time in enumerate(f["data/time"]):
        u, v, z = pixel_of(f, n, f["data/pose_mastoidectomy_drill"][n][:3])
        share = np.bincount(f["data/label"][n].ravel(), minlength=len(names)) / f["data/label"][n].size
        seen = ", ".join(f"{name} {100 * s:.1f} %" for name, s in zip(names[1:], share[1:]) if s > 0)
        print(f"{time:8.3f} s: tip at pixel {u:.1f} {v:.1f}, {1000 * z:.1f} mm away; {seen}")
    count = len(f["voxels_removed/voxel_removed"]) if "voxel_removed" in f["voxels_removed"] else 0
    print(f"{count} voxels removed, {count * f['metadata/voxel_volume'][()] / 1000:.3f} ml")
