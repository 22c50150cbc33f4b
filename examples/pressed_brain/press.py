#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Presses regions of a tetrahedral mesh with CalculiX (Debian: calculix-ccx): python3 press.py CASE.msh brain,midline FOLDER
CASE.msh is of `trephine export CASE --format tetra-msh`. First the same pressure acts from all sides, for which the answer is
known whatever the shape: the strain is -p (1 - 2 nu) / E in all directions. Then a spatula of 30 mm presses on the top, and
the bottom fifth is held. Units: mm, N, MPa. E and nu are of the size that is reported for brain, and no more."""
import pathlib, subprocess, sys
import numpy as np
E, NU, PRESSURE, SPATULA_MM = 0.003, 0.45, 0.0005, 15

def read(file, regions):
    """Points and tetrahedra of the regions, and the triangles around them, which look outwards."""
    lines = iter(pathlib.Path(file).read_text().split("\n"))
    section = lambda name: next(line for line in lines if line == name) and [next(lines) for _ in range(int(next(lines)))]
    names = {int(n): name.strip('"').split("|") for _, n, name in (line.split() for line in section("$PhysicalNames"))}
    points = np.array([line.split()[1:] for line in section("$Nodes")], float)
    cells = [np.array(line.split(), int) for line in section("$Elements")]
    tets = np.array([c[5:] - 1 for c in cells if c[1] == 4 and names[c[3]][0] in regions])
    sides = [(c[5:] - 1, [name in regions for name in names[c[3]]]) for c in cells if c[1] == 2]
    border = [t if inside[0] else t[::-1] for t, inside in sides if inside[0] != inside[1]]
    used, tets = np.unique(tets, return_inverse=True)
    return points[used], tets.reshape(-1, 4), np.searchsorted(used, np.array(border))

def solve(folder, name, points, tets, held, forces):
    """Displacement of each point; held: (point, direction 0 to 2)."""
    rows = lambda table: "\n".join(", ".join(str(v) for v in row) for row in table)
    loads = [(n + 1, a + 1, f"{forces[n, a]:.12e}") for n, a in np.argwhere(forces != 0)]  # ccx reads 20 letters of a number
    (folder / f"{name}.inp").write_text(f"""*NODE, NSET=ALL
{rows((n + 1, *(f'{x:.12e}' for x in p)) for n, p in enumerate(points))}
*ELEMENT, TYPE=C3D4, ELSET=BODY
{rows((n + 1, *(t + 1).tolist()) for n, t in enumerate(tets))}
*MATERIAL, NAME=TISSUE\n*ELASTIC\n{E}, {NU}\n*SOLID SECTION, ELSET=BODY, MATERIAL=TISSUE
*BOUNDARY\n{rows((n + 1, a + 1, a + 1) for n, a in held)}
*STEP\n*STATIC\n*CLOAD\n{rows(loads)}\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n""")
    subprocess.run(["ccx", "-i", name], cwd=folder, check=True, stdout=(folder / f"{name}.log").open("w"))
    return np.array([line.split()[1:] for line in (folder / f"{name}.dat").read_text().split("\n")[3:] if line], float)

if __name__ == "__main__":
    (points, tets, border), folder = read(sys.argv[1], sys.argv[2].split(",")), pathlib.Path(sys.argv[3])
    a, b, c = (points[border[:, n]] for n in range(3))
    push = np.zeros_like(points)  # PRESSURE on the border, a third of each triangle's at each corner
    np.add.at(push, border, np.repeat((-PRESSURE * np.cross(b - a, c - a) / 6)[:, None], 3, axis=1))
    way = points - points[0]  # held as a body is: one point, the turn of a second one about it, and the turn about both
    far = np.argmax(np.linalg.norm(way, axis=1))
    aside = np.cross(way, way[far])
    side = np.argmax(np.linalg.norm(aside, axis=1))
    held = [(0, 0), (0, 1), (0, 2)] + [(far, d) for d in np.argsort(abs(way[far]))[:2]] + [(side, np.argmax(abs(aside[side])))]
    u = solve(folder, "squeezed", points, tets, held, push)
    affine = np.column_stack([points, np.ones(len(points))])
    fit = np.linalg.lstsq(affine, u, rcond=None)[0]
    known = -PRESSURE * (1 - 2 * NU) / E
    off = max(abs((fit[:3] + fit[:3].T) / 2 - known * np.eye(3)).max(), abs(affine @ fit - u).max() / np.ptp(points)) / -known
    print(f"squeezed from all sides: strain {np.trace(fit[:3]) / 3:.6f}, known {known:.6f}, off by at most {off:.1e} of it")
    low, top = points[:, 2].min(), np.argmax(points[:, 2])
    held = [(n, d) for n in np.flatnonzero(points[:, 2] < low + 0.2 * np.ptp(points[:, 2])) for d in range(3)]
    push[np.linalg.norm(points - points[top], axis=1) > SPATULA_MM] = 0
    u = solve(folder, "pressed", points, tets, held, push)
    print(f"pressed with {np.linalg.norm(push.sum(axis=0)):.3f} N: {np.linalg.norm(u, axis=1).max():.2f} mm at most, {-u[top, 2]:.2f} mm downwards at the top")
