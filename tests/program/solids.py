# SPDX-License-Identifier: GPL-3.0-or-later
"""solids.py SOURCE CASE FOLDER [SDF]: what `export --format tetra-msh,tetra-vtu,sdf` wrote, by arithmetic of its own and by meshio where it
is installed. SDF: what sdf_check printed."""
import json
import pathlib
import sys
import xml.etree.ElementTree as xml

import numpy as np

source, case_folder, folder = (pathlib.Path(a) for a in sys.argv[1:4])
sys.path += [str(source / "examples/pressed_brain"), str(source / "examples/python_reader")]
import press
import read_case

case = read_case.load(str(case_folder))
names = [a["name"] for a in case.manifest["anatomies"] if a["name"] in case.surfaces]
outermost_first = sorted(names, key=lambda n: -case.surfaces[n].volume_ml())
report = json.loads((folder / "report.json").read_text())


def volumes(points, tets):
    a, b, c, d = (points[tets[:, n]] for n in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


msh = folder / "sample.msh"
points, tets, border = press.read(msh, names)
of = {n: press.read(msh, [n]) for n in names}
assert sum(len(t) for _, t, _ in of.values()) == len(tets) > 1000
assert volumes(points, tets).min() > 0  # none is turned inside out
for n in names:
    p, t, b = of[n]
    own = volumes(p, t).sum() / 1000
    inner = outermost_first[outermost_first.index(n) + 1:][:1]
    wanted = case.surfaces[n].volume_ml() - sum(case.surfaces[i].volume_ml() for i in inner)
    assert abs(own - wanted) < 0.03 * wanted, (n, own, wanted)
    assert abs(own - next(v for k, v in report.items() if k.endswith(f"{n}.volume_ml"))) < 1e-6
    # Its border is closed and looks outwards: what it encloses is what the tetrahedra fill.
    x = p[b]
    assert abs(np.einsum("ij,ij->i", x[:, 0], np.cross(x[:, 1], x[:, 2])).sum() / 6000 - own) < 1e-9 * own
    edges = np.sort(np.concatenate([b[:, [0, 1]], b[:, [1, 2]], b[:, [2, 0]]]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] % 2 == 0).all()

# Every face belongs to two tetrahedra, or to one and is on the outside: regions share their borders.
faces = np.sort(np.concatenate([tets[:, c] for c in ([1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2])]), axis=1)
unique, counts = np.unique(faces, axis=0, return_counts=True)
assert counts.max() == 2
assert {tuple(f) for f in unique[counts == 1]} == {tuple(sorted(f)) for f in border}
inner, outer = of[outermost_first[-1]], of[outermost_first[-2]]
shared = {tuple(p) for p in inner[0][np.unique(inner[2])]}
assert shared <= {tuple(p) for p in outer[0]} and len(shared) > 100

# The borders lie on the case's surfaces: by the radius of the sample's bumpy balls, which is known.
middle = case.haptic.position(*((np.array(case.haptic.voxels.shape[::-1]) - 1) / 2))
worst = 0
for n, radius in zip(outermost_first, sorted((np.linalg.norm(case.surfaces[n].points - middle, axis=1).max() for n in names), reverse=True)):
    p, t, b = of[n]
    own = [f for f in np.unique(b)]
    d = p[own] - middle
    unit = d / np.linalg.norm(d, axis=1)[:, None]
    s = case.surfaces[n].points - middle
    bump = lambda u: 1 + 0.04 * u[:, 0] * u[:, 1] + 0.03 * u[:, 2] ** 2
    size = (np.linalg.norm(s, axis=1) / bump(s / np.linalg.norm(s, axis=1)[:, None])).mean()
    off = abs(np.linalg.norm(d, axis=1) / bump(unit) - size)
    worst = max(worst, off[off < 2].max())  # the inner border is another surface's
    assert np.mean(off < 0.6) > 0.4, (n, off.max())
assert worst < 0.7, worst

# The .vtu says the same.
grid = xml.parse(folder / "sample.vtu").getroot().find("UnstructuredGrid")
array = lambda path, name: np.array(next(a for a in grid.findall(path + "/DataArray") if a.get("Name") == name).text.split(), float)
vtu_points = array("Piece/Points", "Points").reshape(-1, 3)
types, region = array("Piece/Cells", "types"), array("Piece/CellData", "region")
assert np.allclose(vtu_points[np.lexsort(vtu_points.T)], points[np.lexsort(points.T)], atol=0) and (types == 10).sum() == len(tets)
for a in grid.find("FieldData"):
    assert ((types == 10) & (region == float(a.text))).sum() == len(of[a.get("Name")][1]), a.get("Name")
try:
    import meshio
    for file in (msh, folder / "sample.vtu"):
        mesh = meshio.read(file)
        assert np.array_equal(mesh.points, vtu_points), file
        cells = {c.type: len(c.data) for c in mesh.cells}
        assert cells["tetra"] == len(tets) and set(names) <= set(mesh.field_data), (cells, mesh.field_data)
except ImportError:
    print("meshio is not installed")

# The model: mass and inertia, by the tetrahedra; another sum than that of the surfaces.
sdf = xml.parse(folder / "sample/model.sdf").getroot()
assert sdf.get("version") == "1.7"
link = sdf.find("model/link")
density = {"skull": 1900.0}
mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
for n in names:
    p, t, _ = of[n]
    world = np.column_stack([-p[:, 1], p[:, 0], p[:, 2]]) / 1000
    m = density.get(n, 1000.0) * volumes(p, t) * 1e-9
    corners = world[t]
    total = corners.sum(axis=1)
    mass += m.sum()
    first += (m[:, None] * total / 4).sum(axis=0)
    second += np.einsum("n,nci,ncj->ij", m, corners, corners) / 20 + np.einsum("n,ni,nj->ij", m, total, total) / 20
centre = first / mass
second -= mass * np.outer(centre, centre)
inertia = np.trace(second) * np.eye(3) - second
number = lambda path: float(link.find("inertial/" + path).text)
assert abs(number("mass") - mass) < 0.02 * mass, (number("mass"), mass)
pose = np.array(link.find("inertial/pose").text.split(), float)
assert np.allclose(pose[:3], centre, atol=2e-4) and not pose[3:].any(), (pose, centre)
said = np.array([number("inertia/" + i) for i in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")])
wanted = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
assert np.allclose(said, wanted, atol=0.03 * wanted[:3].max()), (said, wanted)
for part in link.findall("visual") + link.findall("collision"):
    file = part.find("geometry/mesh/uri").text
    assert file.startswith("model://sample/") and (folder / file[len("model://"):]).is_file(), file

if len(sys.argv) > 4:
    lines = pathlib.Path(sys.argv[4]).read_text().splitlines()
    assert not [line for line in lines if line.startswith("error")], lines
    words = next(line for line in lines if line.startswith("link")).split()
    assert words[words.index("valid") + 1] == "1" and abs(float(words[words.index("mass") + 1]) - number("mass")) < 1e-6
    at = words.index("inertia")
    assert np.allclose(np.array(words[at + 1:at + 7], float), said, rtol=1e-6)
    places = [line.split() for line in lines if line.startswith(("visual", "collision"))]
    assert len(places) == 2 * len(names)
    for p in places:  # a point at 1, 2, 3 m of LPS is 2 m to the back and 1 m to the left
        assert np.allclose(np.array(p[-3:], float), [-2, 1, 3], atol=1e-9), p
    colours = [line.split()[1:4] for line in lines if line.startswith("colour")]
    wanted = [a["colour_rgb"] for a in case.manifest["anatomies"] if a["name"] in names]
    assert np.allclose(np.array(colours, float), wanted, atol=1e-6)
    print("libsdformat reads the model")
print(f"{len(tets)} tetrahedra; borders within {worst:.2f} mm; mass {100 * (number('mass') / mass - 1):.2f} % off that of the tetrahedra")
