# SPDX-License-Identifier: GPL-3.0-or-later
import gc
import shutil
import unittest

import numpy as np

import common  # which finds the reader
import read_case
import trephine


class LoadCase(common.Case):
    def setUp(self):
        self.folder = common.sample_case()
        self.case = trephine.load_case(self.folder, ct=True)

    def test_is_what_an_independent_reader_reads(self):
        other = read_case.load(str(self.folder))
        self.assertEqual(self.case.manifest, other.manifest)
        self.assertEqual(self.case.token, "sample")
        self.assertGreater(len(self.case.surfaces), 0)
        self.assertEqual(self.case.surfaces.keys(), other.surfaces.keys())
        for name, surface in self.case.surfaces.items():
            np.testing.assert_array_equal(surface.points_mm, other.surfaces[name].points)
            np.testing.assert_array_equal(surface.triangles, other.surfaces[name].triangles)
            np.testing.assert_allclose(surface.normals, other.surfaces[name].normals, atol=1e-6)
            self.assertAlmostEqual(surface.volume_mm3 / 1000, other.surfaces[name].volume_ml(), 6)
        for ours, theirs in ((self.case.haptic, other.haptic), (self.case.hardness, other.hardness), (self.case.ct, other.ct)):
            self.assertEqual(ours is None, theirs is None)
            if ours is None:
                continue
            np.testing.assert_array_equal(ours.voxels, theirs.voxels)
            np.testing.assert_allclose(ours.position_mm([2, 3, 4]), theirs.position(2, 3, 4), atol=1e-9)
            np.testing.assert_allclose(ours.index(ours.position_mm([2, 3, 4])), [2, 3, 4], atol=1e-9)
            np.testing.assert_allclose(ours.affine @ [2, 3, 4, 1], [*theirs.position(2, 3, 4), 1], atol=1e-9)
        self.assertIsNotNone(self.case.haptic)
        points = {**self.case.landmarks, **self.case.targets}
        self.assertEqual(points.keys(), other.points().keys())
        for name, at in points.items():
            np.testing.assert_array_equal(at, other.points()[name])
        shape = self.case.manifest["haptic"]["shapes"][0]["name"]
        np.testing.assert_array_equal(self.case.shape(shape), other.shape(shape))
        first = self.case.manifest["anatomies"][0]
        self.assertEqual(self.case.deviations_mm[first["name"]], first["deviation_mm"])
        self.assertIsNone(trephine.load_case(self.folder).ct)

    def test_arrays_are_views_that_cannot_be_written_to(self):
        surface = next(iter(self.case.surfaces.values()))
        for once, again in ((surface.points_mm, surface.points_mm), (surface.triangles, surface.triangles),
                            (surface.normals, surface.normals), (self.case.haptic.voxels, self.case.haptic.voxels)):
            self.assertTrue(np.shares_memory(once, again))
            self.assertFalse(once.flags.owndata)
            with self.assertRaises(ValueError):
                once[0] = 0
            with self.assertRaises(ValueError):
                once.flags.writeable = True

    def test_arrays_outlive_the_case(self):
        surface = next(iter(self.case.surfaces.values()))
        kept = [surface.points_mm, surface.triangles, surface.normals, self.case.haptic.voxels]
        copies = [a.copy() for a in kept]
        del surface
        self.case = None
        gc.collect()
        rubbish = [np.full(a.nbytes, 0xAA, np.uint8) for a in kept for _ in range(8)]
        for array, copy in zip(kept, copies):
            np.testing.assert_array_equal(array, copy)
        del rubbish

    def test_errors_carry_code_and_line(self):
        error = self.refuses(66, "^trephine: .*case.json", trephine.load_case, common.WORK / "none")
        self.assertIn("none", error.file)
        damaged = common.WORK / "damaged"
        shutil.copytree(self.folder, damaged)
        file = damaged / self.case.manifest["files"][0]["name"]
        data = bytearray(file.read_bytes())
        data[len(data) // 2] ^= 1
        file.write_bytes(data)
        error = self.refuses(65, "checksum", trephine.load_case, damaged)
        self.assertEqual(error.field, "checksum")
        self.assertIn(file.name, error.file)
        file.unlink()
        self.refuses(66, file.name, trephine.load_case, damaged)
        with self.assertRaises(TypeError):
            trephine.load_case(5)
        with self.assertRaises(KeyError):
            self.case.shape("none")

    def test_the_independent_reader_names_the_version_before_the_checksum(self):
        folder = common.WORK / "versions"
        shutil.copytree(self.folder, folder)
        file = folder / "case.json"
        data = file.read_bytes()
        for version, remedy in (("1.0", ": make the case again with `trephine run`"), ("3.1", "")):
            file.write_bytes(data.replace(b"trephine-case 2.0", b"trephine-case " + version.encode(), 1))
            line = rf"case\.json: format: version {version}, this program reads versions? 2\.[0*]{remedy}"
            self.refuses(65, line, trephine.load_case, folder)
            with self.assertRaisesRegex(read_case.CaseError, line):
                read_case.load(folder)
        for spoilt, pattern in ((data.replace(b"LPS", b"RAS", 1), "checksum: "), (b"{}", "format: not a case.json")):
            file.write_bytes(spoilt)
            with self.assertRaisesRegex(read_case.CaseError, pattern):
                read_case.load(folder)


if __name__ == "__main__":
    unittest.main()
