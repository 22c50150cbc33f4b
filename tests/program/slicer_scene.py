# SPDX-License-Identifier: GPL-3.0-or-later
"""slicer_scene.py CASE BUNDLE SOURCE: reads a bundle of 3D Slicer by the rules of its format, with VTK, pydicom's table of codes and numpy,
and compares it with the case as examples/python_reader reads that: positions in mm in the scene's frame (RAS), names, colours, codes.

Prints one line of figures for docs/validation."""
import json, pathlib, sys, urllib.parse, xml.etree.ElementTree as ET, zipfile, zlib
import numpy as np
from pydicom.sr._concepts_dict import concepts
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance
from vtkmodules.vtkFiltersModeling import vtkSelectEnclosedPoints
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

folder, file, source = map(pathlib.Path, sys.argv[1:4])
sys.path.insert(0, str(source / "examples" / "python_reader"))
import read_case
case = read_case.load(folder)
manifest = case.manifest
to_ras = np.array([-1.0, -1.0, 1.0])

# One folder with one scene, and Data/ below it; nothing says when it was made.
bundle = zipfile.ZipFile(file)
assert bundle.testzip() is None
names = bundle.namelist()
top = names[0].split("/")[0]
assert all(n.startswith(top + "/") and ".." not in n for n in names) and len(set(names)) == len(names), names
assert {i.date_time for i in bundle.infolist()} == {(1980, 1, 1, 0, 0, 0)}
scenes = [n for n in names if n.endswith(".mrml")]
assert scenes == [f"{top}/{manifest['case']}.mrml"] and top == manifest["case"], scenes
root = ET.fromstring(bundle.read(scenes[0]))
assert root.tag == "MRML" and root.get("version").startswith("Slicer")

# Every node has an ID of its class, once, and refers to nodes that are there, or to the colours that Slicer always has.
nodes = {n.get("id"): n for n in root}
assert len(nodes) == len(root) and all(i.startswith("vtkMRML") for i in nodes)
always = {"vtkMRMLColorTableNodeGrey"}
for n in root:
    refs = [r.split(":") for r in (n.get("references") or "").split(";") if r]
    for role, target in refs:
        assert target in nodes or target in always, (n.tag, role, target)
    for role, attribute in (("display", "displayNodeRef"), ("storage", "storageNodeRef")):
        assert dict(refs).get(role) == n.get(attribute), (n.get("name"), role)
def of(tag):
    return [n for n in root if n.tag == tag]
used = set()
def stored(node):
    """Storage node and bytes of its file, whose name is URL-encoded."""
    storage = nodes[node.get("storageNodeRef")]
    name = f"{top}/{urllib.parse.unquote(storage.get('fileName'))}"
    used.add(name)
    return storage, bundle.read(name)

# Models: VTK's points, turned to RAS as the storage node says, are the case's; names, colours, opacities and unit.
def read_vtp(data, scratch):
    scratch.write_bytes(data)
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(scratch))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()
scratch = file.with_suffix(".scratch.vtp")
anatomies = {a["name"]: a for a in manifest["anatomies"]}
meshes, off_mm = {}, 0
for model in of("Model"):
    name, display = model.get("name"), nodes[model.get("displayNodeRef")]
    anatomy = anatomies[name]
    storage, data = stored(model)
    mesh = meshes[name] = read_vtp(data, scratch)
    assert storage.get("coordinateSystem") == "LPS"  # left out it would be RAS, as of old scenes
    fields = mesh.GetFieldData()
    assert fields.GetAbstractArray("SPACE").GetValue(0) == "LPS" and fields.GetAbstractArray("UNIT").GetValue(0) == "mm"
    assert [float(c) for c in display.get("color").split()] == anatomy["colour_rgb"], name
    assert float(display.get("opacity")) == anatomy["opacity"] and display.get("visibility") == "true"
    assert display.get("scalarVisibility") == "false"
    points = vtk_to_numpy(mesh.GetPoints().GetData()) * to_ras
    if name in case.surfaces:
        truth = case.surfaces[name]
        assert points.shape == truth.points.shape and mesh.GetNumberOfPolys() == len(truth.triangles), name
        off_mm = max(off_mm, np.abs(points - truth.points * to_ras).max())
assert set(meshes) == {n for n in anatomies if n in case.surfaces} | {n for n, a in anatomies.items() if "file" not in a}, meshes.keys()
assert off_mm < 1e-9, off_mm

def nrrd(data):
    header, voxels = data.split(b"\n\n", 1)
    lines = header.decode().splitlines()
    assert lines[0].startswith("NRRD")
    field = dict(line.split(":=", 1) if ":=" in line else line.split(": ", 1) for line in lines[1:])
    assert field["space"] == "left-posterior-superior"
    kind = {"unsigned char": "u1", "short": "<i2"}[field["type"]]
    voxels = np.frombuffer(zlib.decompress(voxels, 31), kind).reshape([int(n) for n in field["sizes"].split()][::-1])
    vectors = lambda text: np.array([[float(c) for c in v.strip("()").split(",")] for v in text.split() if v != "none"])
    return field, voxels, vectors(field["space directions"]), vectors(field["space origin"])[0]

# The CT: the case's voxels, whose places are the same by the file's header and by the scene's matrix.
volumes = of("Volume")
assert len(volumes) == (case.ct is not None)
ct_id = None
if volumes:
    volume, ct_id = volumes[0], volumes[0].get("id")
    field, voxels, axes, origin = nrrd(stored(volume)[1])
    assert (voxels == case.ct.voxels).all() and np.allclose(axes, case.ct.axes) and np.allclose(origin, case.ct.origin)
    directions = np.array([float(c) for c in volume.get("ijkToRASDirections").split()]).reshape(3, 3)  # a row for each of R, A, S
    spacing, at = (np.array([float(c) for c in volume.get(k).split()]) for k in ("spacing", "origin"))
    corner = np.array(voxels.shape[::-1]) - 1.0
    for ijk in (np.zeros(3), corner, corner * [1, 0, 0], corner * [0, 1, 0]):
        off = np.abs(directions @ (spacing * ijk) + at - (origin + ijk @ axes) * to_ras).max()
        assert off < 1e-9, (ijk, off)
        off_mm = max(off_mm, off)

# The segmentation: each voxel whose middle VTK finds inside the model is the segment's, and no other. Terminology by pydicom's table.
segmentation = of("Segmentation")[0]
if ct_id:
    assert f"referenceImageGeometryRef:{ct_id};" in segmentation.get("references")
field, layers, axes, origin = nrrd(stored(segmentation)[1])
layers = layers if layers.ndim == 4 else layers[..., None]
assert field["Segmentation_MasterRepresentation"] == "Binary labelmap"
known = {code: meanings for code, meanings in concepts["SCT"].items()}
shape = layers.shape[:3]
if case.ct is not None:
    assert shape == case.ct.voxels.shape and np.allclose(axes, case.ct.axes) and np.allclose(origin, case.ct.origin)
count, compared, wrong, named = sum(k.endswith("_ID") for k in field), 0, 0, set()
k, j, i = np.indices(shape)
places = origin + np.stack([i, j, k], -1).reshape(-1, 3) @ axes
for n in range(count):
    word = lambda key: field[f"Segment{n}_{key}"]
    name = word("Name")
    named.add(name)
    assert [float(c) for c in word("Color").split()] == anatomies[name]["colour_rgb"], name
    assert word("NameAutoGenerated") == word("ColorAutoGenerated") == "0"
    assert [int(e) for e in word("Extent").split()] == [e for a in shape[::-1] for e in (0, a - 1)]
    tags = dict(t.split(":", 1) for t in word("Tags").split("|") if t)
    context, category, kind, modifier, region_context, region, region_modifier = tags["TerminologyEntry"].split("~")
    for coded in (category, kind):
        scheme, code, meaning = coded.split("^")
        assert scheme == "SCT" and any(code in codes for codes in known.values()), coded
    assert category == "SCT^123037004^Anatomical Structure" and modifier == region == region_modifier == "^^"
    mine = (layers[..., int(word("Layer"))] == int(word("LabelValue"))).reshape(-1)
    bounds = meshes[name].GetBounds()
    near = np.all([(places[:, a] >= bounds[2 * a]) & (places[:, a] <= bounds[2 * a + 1]) for a in range(3)], 0)
    assert not mine[~near].any(), name
    near = np.flatnonzero(near)
    near = near[::max(1, len(near) // 20000) | 1]  # enough of them, on all slices, for VTK takes a millisecond for ten
    cloud, points = vtkPolyData(), vtkPoints()
    points.SetData(numpy_to_vtk(places[near], deep=True))
    cloud.SetPoints(points)
    inside = vtkSelectEnclosedPoints()
    inside.SetInputData(cloud)
    inside.SetSurfaceData(meshes[name])
    inside.SetTolerance(1e-9)
    inside.Update()
    truth = vtk_to_numpy(inside.GetOutput().GetPointData().GetArray("SelectedPoints")) > 0
    other = np.flatnonzero(truth != mine[near])
    distance = vtkImplicitPolyDataDistance()
    distance.SetInput(meshes[name])
    # VTK's ray may graze an edge: where the two differ, the signed distance decides, beyond what lies on the surface.
    for at in other:
        d = distance.EvaluateFunction(places[near][at])
        if abs(d) > 1e-4 and (d < 0) != mine[near][at]:
            wrong += 1
    compared += len(near)
    assert len(other) < 0.01 * len(near), name
assert wrong == 0 and compared > 1000, (wrong, compared)
assert named == set(meshes), named

# Points: landmarks, targets, and a line for each hole, as long as its bone is thick and as wide as the hole.
marks = {}
for tag in ("MarkupsFiducial", "MarkupsLine"):
    for node in of(tag):
        storage, data = stored(node)
        markup = json.loads(data)["markups"][0]
        assert storage.tag == "MarkupsJsonStorage" and markup["coordinateSystem"] == "LPS" == storage.get("coordinateSystem")
        assert markup["coordinateUnits"] == "mm" and markup["type"] == tag.removeprefix("Markups")
        marks[node.get("name")] = ({p["label"]: np.array(p["position"]) * to_ras for p in markup["controlPoints"]}, nodes[node.get("displayNodeRef")])
for group in ("landmarks", "targets"):
    truth = {p["name"]: np.array(p["position_mm"]) * to_ras for p in manifest[group]}
    assert truth.keys() == (marks[group][0].keys() if truth else set()), group
    for name, at in truth.items():
        off_mm = max(off_mm, np.abs(marks[group][0][name] - at).max())
for hole in manifest["burr_holes"]:
    thick = dict(hole.get("figures", {})).get("bone_thickness_mm")
    if thick:
        points, display = marks["hole-" + hole["name"]]
        outer, inner = points[hole["name"] + "_outer"], points[hole["name"] + "_inner"]
        off_mm = max(off_mm, np.abs(outer - np.array(hole["position_mm"]) * to_ras).max())
        assert abs(np.linalg.norm(inner - outer) - thick) < 1e-9
        assert np.allclose((inner - outer) / thick, np.array(hole["direction"]) * to_ras, atol=1e-6)
        assert display.get("curveLineSizeMode") == "UseLineDiameter" and float(display.get("lineDiameter")) == hole["diameter_mm"]
assert off_mm < 1e-9, off_mm

# The view: four windows; slices through the middle of what is shown, with the CT behind; a camera that sees all of it.
shown = np.concatenate([vtk_to_numpy(m.GetPoints().GetData()) for m in meshes.values()]) * to_ras
middle = (shown.min(0) + shown.max(0)) / 2
assert of("Layout")[0].get("currentViewArrangement") == "3"
for node in of("Slice"):
    m = np.array([float(c) for c in node.get("sliceToRAS").split()]).reshape(4, 4)
    assert np.allclose(m[:3, 3], middle) and node.get("id") == "vtkMRMLSliceNode" + node.get("layoutName")
    out = {"Axial": [0, 0, 1], "Sagittal": [1, 0, 0], "Coronal": [0, 1, 0]}[node.get("orientation")]
    assert (m[:3, 2] == out).all() and np.allclose(m[:3, :3].T @ m[:3, :3], np.eye(3))
assert {n.get("backgroundVolumeID") for n in of("SliceComposite")} == {ct_id or ""} and len(of("SliceComposite")) == 3
camera = of("Camera")[0]
eye, focus, up = (np.array([float(c) for c in camera.get(k).split()]) for k in ("position", "focalPoint", "viewUp"))
look = (focus - eye) / np.linalg.norm(focus - eye)
assert np.allclose(focus, middle) and camera.get("activetag") == of("View")[0].get("id") and abs(up @ look) < 1e-9
assert np.degrees(np.arccos((shown - eye) @ look / np.linalg.norm(shown - eye, axis=1))).max() < 15 and look[1] < 0  # VTK's 30 degrees, from the front
unit = of("Unit")[0]
assert unit.get("Suffix") == "mm" and of("Selection")[0].get("lengthUnitNodeRef") == unit.get("id")
assert used == set(names) - set(scenes), set(names) ^ used
scratch.unlink()
print(f"{len(meshes)} models, {count} segments in {layers.shape[3]} layers, {compared} voxels compared, {len(marks)} markups, off by {off_mm:.2g} mm")
