# SPDX-License-Identifier: GPL-3.0-or-later
import _thread
import gc
import json
import threading
import time
import unittest

import numpy as np

import common
import trephine
from trephine import _native


class Stages(common.Case):
    @classmethod
    def setUpClass(cls):
        cls.ball = common.ball()
        cls.full = trephine.contour(cls.ball, field=True)

    def test_figures_are_those_of_the_commands(self):
        work = common.WORK
        common.write_nrrd(work / "ball.nrrd", self.ball)
        common.run(common.TREPHINE, "contour", work / "ball.nrrd", "--output", work / "full.vtp", "--report", work / "full.json")
        common.run(common.TREPHINE, "decimate", work / "full.vtp", "--max-deviation-mm", 0.2, "--output", work / "few.vtp",
                   "--report", work / "few.json")
        few = trephine.decimate(self.full.value, max_deviation_mm=0.2)
        for made, report in ((self.full, "full.json"), (few, "few.json")):
            said = json.loads((work / report).read_text())
            said = {k: v for k, v in said.get("figures", said).items() if k in made.figures}
            self.assertGreater(len(said), 4)
            self.assertEqual(said, {k: made.figures[k] for k in said})

    def test_a_chain_on_ones_own_data(self):
        full = self.full.value
        self.assertEqual(trephine.check(full)[0], True)
        few = trephine.decimate(full, max_deviation_mm=0.2)
        self.assertLess(few.figures["triangles_count"], 0.5 * len(full.triangles))
        even = trephine.smooth(few.value, reference=full, total_deviation_mm=0.3).value
        drilled = trephine.cut(even, [{"kind": "cylinder", "name": "hole", "position_mm": [0, 0, 120], "direction": [0, 0, -1],
                                       "radius_mm": 5, "above_mm": 5, "depth_mm": 10}])
        removed = drilled.figures["removed_mm3"]
        self.assertAlmostEqual(removed, np.pi * 25 * 9.7, delta=0.03 * removed)
        self.assertAlmostEqual(even.volume_mm3 - drilled.value.volume_mm3, removed, delta=0.01 * removed)
        measured = trephine.measure(trephine.normals(drilled.value).value, reference=full)
        self.assertTrue(measured["valid"])
        self.assertAlmostEqual(measured["deviation_max_mm"], 10, delta=0.3)  # the middle of the hole's floor
        # A solid of one's own: a smaller ball, moved into the side.
        inner = trephine.Mesh(full.points_mm * 0.3 + [20, 0, 70], full.triangles)
        bitten = trephine.cut(even, [{"kind": "mesh", "name": "bite", "mesh": inner}]).value
        self.assertLess(bitten.volume_mm3, even.volume_mm3)
        self.assertTrue(trephine.check(bitten)[0])

    def test_a_burr_hole_is_placed_and_cut(self):
        shell = trephine.contour(trephine.Volume(np.minimum(self.ball.voxels, 6 - self.ball.voxels), self.ball.spacing_mm,
                                                 self.ball.origin_mm), field=True, keep_cavities=True).value
        hole = trephine.burr_hole(shell, [0, 0, 122], diameter_mm=8)
        self.assertAlmostEqual(hole.figures["bone_thickness_mm"], 6, delta=0.3)
        made = trephine.cut(shell, hole.value)
        self.assertAlmostEqual(made.figures["removed_mm3"], np.pi * 16 * 6, delta=0.15 * np.pi * 16 * 6)
        far = trephine.burr_hole(shell, [0, 0, 140], diameter_mm=8)
        self.assertIn("from position_mm", " ".join(far.warnings))
        self.refuses(65, "at: must be position", trephine.burr_hole, shell, [0, 0, 0], at="kocher")
        self.refuses(65, "avoid", trephine.burr_hole, shell, [0, 0, 122], avoid={"sinus": 3})

    def test_a_ct_and_its_isovalue(self):
        hu = trephine.Volume((self.ball.voxels * 50 + 300).astype(np.int16), self.ball.spacing_mm, self.ball.origin_mm)
        made = trephine.contour(hu, isovalue_hu=300)
        self.assertEqual(made.figures["isovalue_hu"], 299.5)
        self.assertAlmostEqual(made.value.volume_mm3, 4 / 3 * np.pi * 20 ** 3, delta=300)
        np.testing.assert_allclose(made.value.points_mm.mean(axis=0), [0, 0, 100], atol=0.2)
        # Left-handed and oblique axes are taken as they are.
        turned = np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1]], float)
        made = trephine.contour(trephine.Volume(hu.voxels, hu.spacing_mm, hu.origin_mm, turned))
        self.assertGreater(made.value.volume_mm3, 0)
        self.assertTrue(trephine.check(made.value)[0])

    def test_broken_meshes_are_checked_and_repaired(self):
        full = self.full.value
        open_one = trephine.Mesh(full.points_mm, full.triangles[1:])
        good, text = trephine.check(open_one)
        self.assertFalse(good)
        self.assertIn("open", text)
        hole = [{"kind": "sphere", "position_mm": [0, 0, 120], "radius_mm": 5}]
        for stage in (trephine.decimate, trephine.smooth, trephine.remesh, lambda mesh: trephine.cut(mesh, hole),
                      lambda mesh: trephine.cut(full, [{"kind": "mesh", "name": "bite", "mesh": mesh}])):
            error = self.refuses(65, "mesh: is not valid: 3 open edges .*; repair\\(\\) mends it$", stage, open_one)
            self.assertNotIn("fault of the program", str(error))
        mended = trephine.repair(open_one).value
        self.assertTrue(trephine.check(mended)[0])
        self.assertAlmostEqual(mended.volume_mm3, full.volume_mm3, delta=5)
        even = trephine.remesh(full, edge_mm=4).value
        self.assertTrue(trephine.check(even)[0])

    def test_other_layouts_of_arrays_are_the_same_mesh(self):
        full = self.full.value
        for points, triangles in ((np.asfortranarray(full.points_mm), full.triangles.astype(np.int64)),
                                  (np.repeat(full.points_mm, 2, axis=0)[::2], full.triangles.astype(np.uint16)[:, ::-1][:, ::-1])):
            made = trephine.Mesh(points, triangles)
            np.testing.assert_array_equal(made.points_mm, full.points_mm)
            np.testing.assert_array_equal(made.triangles, full.triangles)

    def test_what_is_no_mesh_is_refused(self):
        points, triangles = self.full.value.points_mm, self.full.value.triangles
        spoilt = points.copy()
        spoilt[7, 1] = np.nan
        beyond = triangles.astype(np.int64)
        for row, value in ((3, len(points)), (4, -1), (5, 2 ** 40)):
            wrong = beyond.copy()
            wrong[row, 2] = value
            with self.assertRaisesRegex(ValueError, f"triangles: row {row} names the point {value}, of {len(points)}"):
                trephine.Mesh(points, wrong)
        with self.assertRaisesRegex(ValueError, "points_mm holds a value that is not finite, in row 7"):
            trephine.Mesh(spoilt, triangles)
        for wrong, pattern in ((points[:, :2], r"shape \(n, 3\), not"), (points.ravel(), "shape"), (points.astype(int), "int64"),
                               (points.astype(complex), "complex"), (points.tolist(), "must be a numpy array"), (None, "numpy"),
                               (np.array([["a", "b", "c"]]), "float64"), (points.astype(object), "object")):
            with self.assertRaisesRegex(ValueError, "points_mm.*" + pattern):
                trephine.Mesh(wrong, triangles)
        for wrong in (triangles.astype(float), triangles[:, :2], triangles.ravel(), [[0, 1, 2]], triangles > 3):
            with self.assertRaisesRegex(ValueError, "triangles must"):
                trephine.Mesh(points, wrong)
        with self.assertRaisesRegex(ValueError, "triangles: row 0 names the point 18446744073709551615|triangles: row 0 names the point -1"):
            trephine.Mesh(points, np.full((1, 3), 2 ** 64 - 1, np.uint64))
        empty = trephine.Mesh(np.empty((0, 3)), np.empty((0, 3), int))
        self.assertEqual(empty.points_mm.shape, (0, 3))
        full, hole = self.full.value, [{"kind": "sphere", "position_mm": [0, 0, 120], "radius_mm": 5}]
        for stage in (trephine.decimate, trephine.smooth, trephine.remesh, trephine.repair, trephine.normals, trephine.measure,
                      lambda mesh: trephine.cut(mesh, hole), lambda mesh: trephine.burr_hole(mesh, [0, 0, 122]),
                      lambda mesh: trephine.cut(full, [{"kind": "mesh", "name": "bite", "mesh": mesh}]),
                      lambda mesh: trephine.burr_hole(full, [0, 0, 122], over=mesh),
                      lambda mesh: trephine.smooth(full, reference=mesh), lambda mesh: trephine.measure(full, reference=mesh)):
            self.refuses(65, "has no triangles", stage, empty)
        self.assertFalse(trephine.check(empty)[0])

    def test_what_is_no_volume_is_refused(self):
        v = self.ball
        make = trephine.Volume
        for wrong, pattern in ((make(v.voxels[0]), "three axes"), (make(v.voxels[:0]), "axis of 0 voxels"),
                               (make(v.voxels.astype(float)), "float64"), (make(v.voxels > 0), "bool"),
                               (make(v.voxels, [1, 0, 1]), "spacing_mm"), (make(v.voxels, [1, np.nan, 1]), "spacing_mm"),
                               (make(v.voxels, origin_mm=[0, 0, np.inf]), "origin_mm"),
                               (make(v.voxels, direction=np.ones((3, 3))), "direction")):
            with self.assertRaisesRegex(ValueError, pattern):
                trephine.contour(wrong)
        for name, wrong in (("spacing_mm", 2.0), ("spacing_mm", [2.0]), ("spacing_mm", [1, 1]), ("spacing_mm", "abc"),
                            ("spacing_mm", None), ("origin_mm", 0), ("direction", np.eye(2)), ("direction", None), ("direction", 1)):
            with self.assertRaisesRegex(ValueError, f"^{name} must be (three numbers|a matrix of 3 x 3), not "):
                make(v.voxels, **{name: wrong})
        np.testing.assert_array_equal(make(v.voxels, (1, 2, 3), [4, 5, 6]).position_mm([1, 1, 1]), [5, 7, 9])
        with self.assertRaisesRegex(ValueError, "must be of float32, not int16"):
            trephine.contour(make(v.voxels.astype(np.int16)), field=True)
        spoilt = v.voxels.copy()
        spoilt[5, 5, 5] = np.nan
        self.refuses(65, "finite", trephine.contour, make(spoilt), field=True)
        self.refuses(80, "inside", trephine.contour, make(np.zeros((4, 4, 4), np.float32) - 1), field=True)
        thin = np.lib.stride_tricks.as_strided(np.zeros(1, np.float32), (70000, 1, 1), (0, 0, 0))
        with self.assertRaisesRegex(ValueError, "70000 voxels"):
            trephine.contour(make(thin))

    def test_what_is_no_parameter_is_refused(self):
        full = self.full.value
        error = self.refuses(65, "max_deviation", trephine.decimate, full, max_deviation=0.1)
        self.refuses(65, "max_deviation_mm", trephine.decimate, full, max_deviation_mm=-1)
        self.refuses(65, "max_deviation_mm", trephine.decimate, full, max_deviation_mm="much")
        self.refuses(65, "method", trephine.smooth, full, method="none")
        for wrong in (np.nan, np.float64("inf"), [1, np.nan], object()):
            with self.assertRaisesRegex(ValueError, "^max_deviation_mm: "):
                trephine.decimate(full, max_deviation_mm=wrong)
        self.assertGreater(len(trephine.decimate(full, max_deviation_mm=np.float32(0.25)).value.triangles), 0)
        self.refuses(64, "reference", trephine.smooth, full, total_deviation_mm=0.1)
        for stage in (trephine.decimate, trephine.smooth, trephine.repair, trephine.remesh, trephine.normals, trephine.measure,
                      trephine.check, lambda mesh: trephine.cut(mesh, []), lambda mesh: trephine.burr_hole(mesh, [0, 0, 1])):
            for wrong in (None, 3, full.points_mm):
                with self.assertRaises(TypeError):
                    stage(wrong)
        for wrong in ([], [{"kind": "mesh"}], [{"kind": "mesh", "mesh": None}]):
            with self.assertRaisesRegex(ValueError, "cutters"):
                trephine.cut(full, wrong)
        self.refuses(65, r"cutters\[0\]", trephine.cut, full, [{"kind": "cylinder"}])
        self.refuses(65, r"cutters\[0\]", trephine.cut, full, [{"kind": "sphere", "position_mm": [0, 0, 0], "radius_mm": -3}])

    def test_results_outlive_what_made_them(self):
        made = trephine.decimate(self.full.value, keep_ratio=0.5).value
        points, copy = made.points_mm, made.points_mm.copy()
        self.assertTrue(np.shares_memory(points, made.points_mm))
        del made
        gc.collect()
        rubbish = [np.full(points.nbytes, 0xAA, np.uint8) for _ in range(16)]
        np.testing.assert_array_equal(points, copy)
        del rubbish

    def test_other_threads_go_on_and_ctrl_c_ends(self):
        large = trephine.contour(common.ball(60, 192, 0.8, (-76.4, -76.4, 23.6)), field=True).value
        done, turns = threading.Event(), 0
        begin_s = time.process_time()
        worker = threading.Thread(target=lambda: (trephine.decimate(large, max_deviation_mm=0.05), done.set()))
        worker.start()
        while not done.is_set():
            turns += 1
            time.sleep(0.001)
        worker.join()
        whole_s = time.process_time() - begin_s
        self.assertGreater(turns, 20)

        def interrupt():
            while time.process_time() < begin_s + 0.1 * whole_s:
                time.sleep(0.001)
            _thread.interrupt_main()

        begin_s = time.process_time()
        interrupter = threading.Thread(target=interrupt)
        interrupter.start()
        # Where signals are not looked at, the stage ends first, and the exception comes all the same.
        with self.assertRaises(KeyboardInterrupt):
            trephine.decimate(large, max_deviation_mm=0.05)
        self.assertLess(time.process_time() - begin_s, 0.5 * whole_s)
        interrupter.join()

    def test_a_child_that_is_not_there_is_an_error(self):
        there = _native.__file__.rsplit("/", 1)[0] + "/trephine-worker"
        _native.set_child_program("/bin/false")
        try:
            self.refuses(80, "the child ended with status 1 and no result", trephine.cut, self.full.value,
                         [{"kind": "sphere", "position_mm": [0, 0, 120], "radius_mm": 5}])
        finally:
            _native.set_child_program(there)


if __name__ == "__main__":
    unittest.main()
