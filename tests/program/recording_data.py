# SPDX-License-Identifier: GPL-3.0-or-later
"""recording_data.py SOURCE CASE FILE TOOL_FILE: what --hdf5 wrote, against the case by numpy alone: rays of the file's camera are
cut with the case's triangles, and the tool's end is looked for in the picture of labels."""
import hashlib
import pathlib
import sys

import h5py
import numpy as np

source, case_folder, name, tool_name = sys.argv[1:5]
sys.path += [source + "/examples/recording_data", source + "/examples/python_reader"]
import frames
import read_case


def first_hit(eye, way, surface):
    """Distance along the unit way to the first triangle (Moeller and Trumbore), or inf."""
    a, b, c = (surface.points[surface.triangles[:, n]] for n in range(3))
    e, g = b - a, c - a
    h = np.cross(way, g)
    det = np.einsum("ij,ij->i", e, h)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = eye - a
        u = np.einsum("ij,ij->i", s, h) / det
        q = np.cross(s, e)
        v = q @ way / det
        t = np.einsum("ij,ij->i", g, q) / det
        t[~((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0))] = np.inf
    return t.min()


case = read_case.load(case_folder)
f = h5py.File(name)
count, height, width = f["data/label"].shape
names = [n.decode() for n in f["metadata/label_names"]]
assert names == ["background", "scalp", "skull", "brain", "tool"], names
for path, kind, shape in [("data/time", "<f8", (count,)), ("data/l_img", "|u1", (count, height, width, 3)),
                          ("data/segm", "|u1", (count, height, width, 3)), ("data/depth", "<f8", (count, height, width)),
                          ("data/pose_main_camera", "<f8", (count, 7)), ("data/pose_mastoidectomy_drill", "<f8", (count, 7)),
                          ("data/pose_mastoidectomy_volume", "<f8", (count, 7)), ("metadata/camera_intrinsic", "<f8", (3, 3)),
                          ("metadata/camera_extrinsic", "<i8", (4, 4)), ("metadata/voxel_volume", "<f8", ())]:
    assert f[path].dtype.str == kind and f[path].shape == shape, (path, f[path].dtype, f[path].shape)
assert f["metadata/voxel_volume"].attrs["units"] == "mm^3, millimeters cubed"
assert f["metadata/case_sha256"][()].decode() == hashlib.sha256((pathlib.Path(case_folder) / "case.json").read_bytes()).hexdigest()

# Labels, their colours, and where there is depth, say the same.
label, bgr = f["data/label"][()], f["metadata/label_bgr"][()]
assert np.array_equal(bgr[label], f["data/segm"][()]) and len(np.unique(bgr, axis=0)) == len(names)
assert np.array_equal(label > 0, f["data/depth"][()] > 0)

# The scalp that is seen is where the case has it: each pixel's ray meets the case's triangles at the depth of the file, also near the
# rim, where half a pixel would be millimetres.
k, camera = f["metadata/camera_intrinsic"][()], frames.matrix(f["data/pose_main_camera"][0])
back = np.linalg.inv(frames.cv_from_world(f, 0))
incision = 1000 * f["data/pose_mastoidectomy_drill"][0, :3]
random = np.random.default_rng(1)


def case_depth(u, v):
    """Depth in mm of the scalp in the case at a place of the picture, and the point."""
    ray = back[:3, :3] @ np.linalg.solve(k, [u, v, 1])  # 1 long along the line of sight
    z = first_hit(1000 * camera[:3, 3], ray / np.linalg.norm(ray), case.surfaces["scalp"]) / np.linalg.norm(ray)
    return z, 1000 * camera[:3, 3] + z * ray


worst_mm, worst_px, looked = 0, 0, 0
skin = np.argwhere(label[0] == 1)
for v, u in random.permutation(skin)[:400]:
    z, at = case_depth(u, v)
    if not np.isfinite(z) or np.linalg.norm(at - incision) < 25:
        continue  # the rim itself; what is seen through the incision is no triangle of the case
    off = abs(1000 * f["data/depth"][0, v, u] - z)
    slope = max(abs(case_depth(u + 0.1, v)[0] - z), abs(case_depth(u, v + 0.1)[0] - z)) / 0.1
    worst_mm, looked = max(worst_mm, off), looked + 1
    if 0.2 < slope < 100:  # by how many pixels the picture is shifted
        worst_px = max(worst_px, off / slope)
assert looked > 200 and worst_mm < 0.05 and worst_px < 0.1, (looked, worst_mm, worst_px)
edge = [(u, v) for v, u in skin if label[0, v, u - 1] == 0 or label[0, v, u + 1] == 0]
off = []  # the silhouette: the pixel's ray meets the scalp, the next one's misses it
for u, v in edge[:: max(1, len(edge) // 60)]:
    side = -1 if label[0, v, u - 1] == 0 else 1
    hits = []
    for shift in (0, side):
        hits.append(np.isfinite(case_depth(u + shift, v)[0]))
    off.append(hits == [True, False])
assert len(off) > 20 and np.mean(off) > 0.97, np.mean(off)

# The points of the depth lie on the case's surfaces, whole frames of them.
points, of = frames.points_of(f, 0)
ball = case.surfaces["scalp"].points
on_scalp = 1000 * points[of == 1][::40]
near = np.array([np.linalg.norm(ball - p, axis=1).min() for p in on_scalp])
assert np.median(near) < 2, np.median(near)  # of vertices that lie some mm apart

# Voxels that were removed were within the ball at some time not after; their places are those of the case's volume.
removed, stamp = f["voxels_removed/voxel_removed"][()], f["voxels_removed/voxel_time_stamp"][()]
assert removed.shape[1] == 4 and f["voxels_removed/voxel_color"].shape == (len(removed), 5) and len(removed) > 500
assert removed[0, 0] == 0 and removed[-1, 0] == len(stamp) - 1 and np.all(np.diff(stamp) > 0)
to_world = f["metadata/voxel_to_world"][()]
assert np.allclose(1000 * to_world[:3, 3], case.haptic.origin) and np.allclose(1000 * to_world[:3, :3], case.haptic.axes.T)
pose, time = (f["high_frequency_poses/mastoidectomy_drill/" + n][()] for n in ("pose", "time_stamp"))
radius_m = f["burr_change/diameter_mm"][0] / 2000
incision_mm = 15
inside = case.shape("skull")
for row in removed[:: len(removed) // 60]:
    i, j, k_ = (int(n) for n in row[1:])
    place = (to_world @ [i, j, k_, 1])[:3]
    before = time <= stamp[int(row[0])] + 1e-9
    centre = pose[before, :3] + radius_m * np.array([frames.matrix(p)[:3, 0] for p in pose[before]])
    voxel_m = f["metadata/voxel_volume"][()] ** (1 / 3) / 1000
    reach = radius_m + voxel_m if inside[k_, j, i] else incision_mm / 1000 + radius_m + voxel_m
    assert np.linalg.norm(centre - place, axis=1).min() < reach, (row, np.linalg.norm(centre - place, axis=1).min())
assert np.allclose(pose[np.searchsorted(time, f["data/time"][-1], "right") - 1], f["data/pose_mastoidectomy_drill"][-1])
wrench = f["drill_force_feedback/wrench"][()]
assert wrench.shape == (len(time), 6) and np.abs(wrench[:, :3]).max() > 0.05 and not wrench[:, 3:].any()

# The tool's end is seen where its pose says, within half a pixel: it is the end of the ball, away from the shaft.
t = h5py.File(tool_name)
pose = t["data/pose_mastoidectomy_drill"][0]
axis = frames.matrix(pose)[:3, 0]
middle = np.array(frames.pixel_of(t, 0, pose[:3] + t["burr_change/diameter_mm"][0] / 2000 * axis)[:2])
tip = np.array(frames.pixel_of(t, 0, pose[:3])[:2])
way = (tip - middle) / np.linalg.norm(tip - middle)
v, u = np.nonzero(t["data/label"][0] == 4)
seen = np.column_stack([u, v]) - middle
along, aside = seen @ way, seen @ [-way[1], way[0]]
radius_px = np.linalg.norm(tip - middle)
end = along.max() + 0.5  # a pixel is the tool's where its middle is
assert radius_px > 30 and abs(end - radius_px) < 0.5, (end, radius_px)
# And to a fraction of that: the circle through the ends of the rows below its middle; the tool stands upright in this picture.
assert way[1] > 0.999
rows = np.arange(int(middle[1]) + 8, v.max() - 1)
half = np.array([np.sum(v == row) for row in rows]) / 2
(c2, rest), *_ = np.linalg.lstsq(np.column_stack([rows, np.ones_like(rows)]), half**2 + rows.astype(float) ** 2, rcond=None)
end_v = c2 / 2 + np.sqrt(rest + c2 * c2 / 4)
worst = np.hypot(end_v - tip[1], aside[along > 0].mean())
assert worst < 0.25, (end_v, tip, aside[along > 0].mean())
assert np.allclose(frames.matrix(t["data/pose_main_camera"][0])[:3, 3], np.array(eval(sys.argv[5])) / 1000)

# A left and a right eye: what is near moves by the baseline over its depth.
if "r_img" in t["data"]:
    baseline = t["metadata/baseline"][()]
    z, fx = frames.pixel_of(t, 0, pose[:3])[2], t["metadata/camera_intrinsic"][0, 0]
    dark = [np.nonzero(np.abs(t["data/" + n][0].astype(int) - t["data/" + n][0, 0, 0]).sum(axis=2) > 60) for n in ("l_img", "r_img")]
    shift = dark[0][1].mean() - dark[1][1].mean()
    assert abs(shift - fx * baseline / z) < 0.2 * fx * baseline / z, (shift, fx * baseline / z)
print(f"{looked} rays: depth within {worst_mm:.4f} mm, pixel within {worst_px:.4f}; the tool's end within {worst:.2f} pixels")
