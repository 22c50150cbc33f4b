# SPDX-License-Identifier: GPL-3.0-or-later
import os
import pathlib
import re
import subprocess
import sys
import unittest

import numpy as np

import common
import trephine
from trephine import _native

FOLDER = common.SOURCE / "examples" / "python"


def example(name, *args):
    return subprocess.run([sys.executable, FOLDER / name, *map(str, args)], capture_output=True, text=True)


class Examples(common.Case):
    def test_each_is_run_here_and_short(self):
        here = pathlib.Path(__file__).read_text()
        for file in FOLDER.glob("*.py"):
            self.assertIn(f'"{file.name}"', here)
            self.assertLess(len(file.read_text().splitlines()), 60, file)

    def test_measure_case(self):
        done = example("measure_case.py", common.sample_case("head"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"(?m)^kocher_right: at .* mm of skull")
        name = next(iter(trephine.load_case(common.sample_case()).surfaces))
        self.assertRegex(example("measure_case.py", common.sample_case()).stdout, rf"(?m)^{name}: \d+ triangles, [\d.]+ ml")

    def test_own_surface(self):
        out = common.WORK / "own.npz"
        done = example("own_surface.py", out)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("closed, 2-manifold, no self-intersections", done.stdout)
        with np.load(out) as arrays:
            self.assertEqual(arrays["points_mm"].shape, arrays["normals"].shape)
            mesh = trephine.Mesh(arrays["points_mm"], arrays["triangles"])
        removed = float(re.search(r"(\d+) mm\^3 removed", done.stdout)[1])
        self.assertAlmostEqual(removed, np.pi * 36 * 6, delta=0.2 * np.pi * 36 * 6)
        self.assertTrue(trephine.check(mesh)[0])

    def test_show_in_vtk(self):
        try:
            from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
        except ImportError:
            done = example("show_in_vtk.py", "case", "out")
            self.assertEqual(done.returncode, 1)
            self.assertIn("apt-get install python3-vtk9", done.stderr)
            self.skipTest("python3-vtk9 is not installed")
        folder, out = common.sample_case(), common.WORK / "case.vtp"
        done = example("show_in_vtk.py", folder, out)
        self.assertEqual(done.returncode, 0, done.stderr)
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(out))
        reader.Update()
        surfaces = trephine.load_case(folder).surfaces.values()
        self.assertEqual(reader.GetOutput().GetNumberOfPolys(), sum(len(s.triangles) for s in surfaces))
        low = np.min([s.points_mm.min(axis=0) for s in surfaces], axis=0)
        np.testing.assert_allclose(reader.GetOutput().GetBounds()[::2], low, atol=1e-4)

    def test_drill_episode(self):
        folder, out = common.sample_case("drill"), common.WORK / "episode.servo"
        done = example("drill_episode.py", folder, out, 1, -20, 315)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"^through after ")
        self.assertIn("replayed bit for bit", common.run(common.SIM, "replay", folder, out))

    def test_the_tutorial_runs(self):
        page = (common.SOURCE / "docs" / "tutorials" / "python.md").read_text()
        blocks = re.findall(r"```python\n(.*?)```", page, re.S)
        self.assertGreater(len(blocks), 4)
        script = "\n".join(blocks).replace("out/sample", str(common.sample_case("head")))
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=common.WORK)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"(?m)^skull [\d.]+ \{.*'skull': [1-9]", "its drill cuts no bone")

    def test_stubs_name_what_there_is(self):
        package = pathlib.Path(trephine.__file__).parent
        self.assertTrue((package / "py.typed").exists())
        stub = (package / "_native.pyi").read_text()
        declared = set(re.findall(r"(?m)^(?:def |class )?(\w+)(?=[:(])", stub)) | set(re.findall(r"(?m)^class (\w+):", stub))
        there = {n for n in dir(_native) if not n.startswith("__")}
        self.assertEqual(declared & there, there)
        self.assertEqual({d for d in declared if not hasattr(_native, d)}, set())
        for name in ("Mesh", "Case", "Hand"):
            body = re.search(rf"(?ms)^class {name}:\n(.*?)(?=^\S)", stub)[1]
            members = {m for m in re.findall(r"def (\w+)", body) if not m.startswith("__")}
            self.assertEqual(members, {n for n in dir(getattr(_native, name)) if not n.startswith("_")})


if __name__ == "__main__":
    unittest.main()
