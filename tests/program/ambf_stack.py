# SPDX-License-Identifier: GPL-3.0-or-later
"""ambf_stack.py scene CASE SCENE SOURCE: reads a scene for AMBF with PyYAML, Pillow and VTK, turns what is in it into the patient's mm by the
rules of AMBF and CHAI3D, and compares it with the case as examples/python_reader reads that.

ambf_stack.py drill CASE SCENE SOURCE OUT X,Y,Z RADIUS_MM: removes a cylinder about the line from X,Y,Z to the volume's middle, placed by
the case's own lattice, and what lies in it, and saves the stack with and without zeros before the numbers; the truth to OUT.json.

ambf_stack.py labels CASE SCENE SOURCE LABELS TRUTH: the labels' voxels are the case's, and those that were removed."""
import json, pathlib, sys, zlib
import numpy as np, yaml
from PIL import Image

what, folder, scene, source = sys.argv[1], *map(pathlib.Path, sys.argv[2:5])
sys.path.insert(0, str(source / "examples" / "python_reader"))
import read_case
case = read_case.load(folder)
manifest, haptic = case.manifest, case.haptic

def xyz(d): return np.array([d["x"], d["y"], d["z"]], float)
def transform(location):
    """AMBF: rotations about the fixed axes x, y, z by r, p, y, in this order (tf::Matrix3x3::setRPY)."""
    def about(axis, angle):
        m = np.eye(3)
        a, b = (axis + 1) % 3, (axis + 2) % 3
        m[a, a] = m[b, b] = np.cos(angle)
        m[b, a] = np.sin(angle)
        m[a, b] = -m[b, a]
        return m
    o, t = location.get("orientation", {"r": 0, "p": 0, "y": 0}), np.eye(4)
    t[:3, :3] = about(2, o["y"]) @ about(1, o["p"]) @ about(0, o["r"])
    t[:3, 3] = xyz(location["position"])
    return t

files = {p.name: yaml.safe_load(p.read_text()) for p in scene.glob("*.yaml")}
adf = files["volume.yaml"]
volume = adf["VOLUME mastoidectomy_volume"]
images = volume["images"]
def stack_of(path):
    """[k, j, i, 4]: CHAI3D's images begin at the bottom row."""
    return np.array([np.array(Image.open(path / f"{images['prefix']}{n}.{images['format']}"))[::-1] for n in range(images["count"])])
stack = stack_of(scene / images["path"])

# What a voxel shows, from the case alone: the shape of at least half of it.
value, lattice = haptic.voxels.astype(int), haptic.voxels.shape
by_number = {s["number"]: s for s in manifest["haptic"]["shapes"]}
assert manifest["haptic"]["encoding"] == "occupancy"
number, share = value // 1000, np.where(value % 1000 > 300, value % 1000 - 300, value % 1000) / 255
left_handed = np.linalg.det(haptic.axes) < 0
def as_stack(voxels): return voxels[::-1] if left_handed else voxels
sure = as_stack((number > 0) & (share > 0.5))
empty = as_stack(value == 0)
k, j, i = np.meshgrid(*map(np.arange, lattice), indexing="ij")
mm = as_stack(haptic.origin + np.stack([i, j, k], -1) @ haptic.axes)

def scene_check():
    # Files and names as volumetric_drilling wants them.
    launch = files["launch.yaml"]
    assert launch["plugins"][0]["name"] == "DRILLING_SIMULATOR" and set(files) == {"launch.yaml", "world.yaml", "volume.yaml", "drills.yaml"}
    for name in [launch["world config"]] + launch["multibody configs"]:
        assert (scene / name).is_file(), name
    assert adf["volumes"] == ["VOLUME mastoidectomy_volume"] and volume["name"] == "mastoidectomy_volume"
    origin = adf[volume["parent"]]
    assert volume["parent"].endswith("_anatomical_origin") and volume["scale"] == 1.0
    assert files["world.yaml"]["conversion factor"] == 1.0
    bodies = [b for f in ("volume.yaml", "drills.yaml") for b in files[f]["bodies"]]
    assert len(set(bodies)) == len(bodies) and all(b in adf or b in files["drills.yaml"] for b in bodies)
    pictures = sorted(p.name for p in (scene / images["path"]).iterdir())
    assert pictures == sorted(f"plane00{n}.png" for n in range(images["count"])), pictures[:3]
    assert stack.shape[3] == 4 and stack.dtype == np.uint8

    # Each voxel's middle, by the frames: the patient's, in mm.
    to_world, in_patient = transform(origin["location"]), transform(volume["location"])
    n, size = np.array(stack.shape[2::-1]), xyz(volume["dimensions"])
    assert np.linalg.det(in_patient[:3, :3]) > 0.999 and np.linalg.det(to_world[:3, :3]) > 0.999
    kk, jj, ii = np.meshgrid(*map(np.arange, stack.shape[:3]), indexing="ij")
    at = ((np.stack([ii, jj, kk], -1) + 0.5) / n - 0.5) * size
    at_mm = 1000 * (at @ in_patient[:3, :3].T + in_patient[:3, 3])
    voxel_off = np.linalg.norm(at_mm - mm, axis=-1).max()

    # There or not, and in which colour: what may be removed is bone to volumetric_drilling.
    shown = stack[..., 3] > 0
    assert set(np.unique(stack[..., 3])) <= {0, 255} and not stack[~shown].any()
    assert shown[sure].all() and not shown[empty].any()
    colours = {a["name"]: a["colour_rgb"] for a in manifest["anatomies"]}
    for s, by in by_number.items():
        own = sure & (as_stack(number) == s)
        rgb = (255, 249, 219) if by["cuttable"] else np.floor(255 * np.array(colours[by["name"]]) + 0.5).astype(int)
        assert (stack[own][:, :3] == rgb).all(), by["name"]

    # Landmarks, targets and holes: as places of the patient, and as bodies in the world.
    places = {f"landmark_{p['name']}": p for p in manifest["landmarks"]} | {f"target_{p['name']}": p for p in manifest["targets"]}
    places |= {f"hole_{h['name']}": h for h in manifest["burr_holes"]}
    assert set(adf["fiducial_locations"]) == set(places)
    off = [0]
    for name, p in places.items():
        off.append(np.linalg.norm(1000 * xyz(adf["fiducial_locations"][name]) - p["position_mm"]))
        body = transform(adf[f"BODY {name}"]["location"])[:, 3]
        off.append(np.linalg.norm(1000 * (np.linalg.inv(to_world) @ body)[:3] - p["position_mm"]))

    # The camera sees all of the volume, and the side that was asked for.
    camera = files["world.yaml"]["main_camera"]
    eye, aim = xyz(camera["location"]), xyz(camera["look at"])
    corners = np.array([[a, b, c, 1] for a in (-.5, .5) for b in (-.5, .5) for c in (-.5, .5)]) * np.append(size, 1) @ (to_world @ in_patient).T
    sight = (aim - eye) / np.linalg.norm(aim - eye)
    for c in corners[:, :3] - eye:
        assert np.arccos(c @ sight / np.linalg.norm(c)) < camera["field view angle"] / 2
        assert camera["clipping plane"]["near"] < c @ sight < camera["clipping plane"]["far"]
    assert np.linalg.norm((to_world @ in_patient)[:3, 3] - aim) < 1e-9
    towards = to_world[:3, :3].T @ -sight  # in the patient
    side = {"anterior": (0, -1, 0), "posterior": (0, 1, 0), "left": (1, 0, 0), "right": (-1, 0, 0), "superior": (0, 0, 1)}
    view = sys.argv[5] if len(sys.argv) > 5 else "anterior"
    assert np.allclose(towards, side[view], atol=1e-9), (view, towards)
    up = to_world[:3, :3].T @ xyz(camera["up"])
    assert np.allclose(up, (0, -1, 0) if view == "superior" else (0, 0, 1), atol=1e-9), up

    # Tools: as wide as their names say, their middle at the origin, mm.
    from vtkmodules.vtkIOGeometry import vtkOBJReader
    from vtkmodules.util.numpy_support import vtk_to_numpy
    drills = files["drills.yaml"]
    tools = 0
    for name in ("1mm", "2mm", "4mm", "6mm"):
        body = drills[f"BODY {name}"]
        for path in (drills["high resolution path"], drills["low resolution path"]):
            reader = vtkOBJReader()
            reader.SetFileName(str(scene / path / body["mesh"]))
            reader.Update()
            points = 1000 * body["scale"] * vtk_to_numpy(reader.GetOutput().GetPoints().GetData())
            width = points[:, 1:].max(0) - points[:, 1:].min(0)
            assert np.allclose(width, float(name[:-2]), atol=1e-3) and np.isclose(points[:, 0].min(), -float(name[:-2]) / 2, atol=1e-3), (name, width)
            tools += 1
    assert "BODY mastoidectomy_drill" in drills
    print(f"{folder.name}: {images['count']} pictures of {n[0]} x {n[1]}, {shown.sum()} voxels shown; a voxel at most {voxel_off:.1e} mm off, of {len(places)} "
          f"places the worst {max(off):.1e} mm; {tools} meshes of tools")
    assert voxel_off < 1e-6 and max(off) < 1e-6

def drill(out, place, radius):
    outer = np.array([float(c) for c in place.split(",")])
    centre = mm.reshape(-1, 3).mean(0)
    axis = (outer - centre) / np.linalg.norm(outer - centre)
    d = mm - outer
    height = d @ axis
    gone = (np.linalg.norm(d - height[..., None] * axis, axis=-1) <= radius) & (height > -25) & (stack[..., 3] > 0)
    # No brain is drilled.
    for s, by in by_number.items():
        if not by["cuttable"]:
            gone &= ~(as_stack(number) == s)
    saved = stack.copy()
    saved[gone] = 0
    for form in ("plane00{}.png", "slice_{:04d}.png"):
        to = pathlib.Path(out + ("" if "plane" in form else "_named"))
        to.mkdir()
        for n, picture in enumerate(saved):
            Image.fromarray(picture[::-1].copy(), "RGBA").save(to / form.format(n))
    counts = {by["name"]: int((gone & sure & (as_stack(number) == s)).sum()) for s, by in by_number.items()}
    bone = gone & (as_stack(number) == next(s for s, by in by_number.items() if by["name"] == "skull"))
    np.save(out + ".npy", as_stack(gone))
    json.dump({"voxels": int(gone.sum()), "at_least": counts, "at_mm": outer.tolist(), "bone_middle_mm": mm[bone].mean(0).tolist(), "axis": axis.tolist(),
               "mm3": float(gone.sum() * abs(np.linalg.det(haptic.axes)))}, open(out + ".json", "w"))

def labels(file, truth):
    header, voxels = pathlib.Path(file).read_bytes().split(b"\n\n", 1)
    lines = header.decode().splitlines()[1:]
    field = dict(l.split(":=", 1) if ":=" in l else l.split(": ", 1) for l in lines if not l.startswith("#"))
    assert field["type"] in ("unsigned char", "uint8") and field["space"] == "left-posterior-superior"
    got = np.frombuffer(zlib.decompress(voxels, 31), "u1").reshape([int(n) for n in field["sizes"].split()][::-1])
    vectors = np.array([[float(c) for c in v.strip("()").split(",")] for v in field["space directions"].split()])
    start = np.array([float(c) for c in field["space origin"].strip("()").split(",")])
    assert np.abs(vectors - haptic.axes).max() < 1e-12 and np.abs(start - haptic.origin).max() < 1e-9
    names = {int(field[f"Segment{n}_LabelValue"]): field[f"Segment{n}_Name"] for n in range(100) if f"Segment{n}_Name" in field}
    gone, shown = np.load(truth + ".npy"), as_stack(stack[..., 3]) > 0
    assert ((got > 32) == gone).all() and ((got > 0) == shown).all()
    for v in np.unique(got[got > 0]):
        assert names[v] == by_number[v % 32]["name"] + ("_removed" if v > 32 else ""), v
    trusted = (number > 0) & (share > 0.5)
    assert (got[trusted] % 32 == number[trusted]).all()
    print(f"{(got > 32).sum()} voxels removed, as the truth has them")

{"scene": scene_check, "drill": lambda: drill(sys.argv[5], sys.argv[6], float(sys.argv[7])), "labels": lambda: labels(*sys.argv[5:7])}[what]()
