# SPDX-License-Identifier: GPL-3.0-or-later
import collections
import gc
import json
import shutil
import threading
import unittest

import numpy as np

import common  # which finds the reader
import read_recording
import trephine
from trephine.recording import EVENTS, names_of

TOUCHING = "0 1 -20 390\n1 1 -20 381\n2 8 -18 381\n3 -4 -24 382\n3.5 1 -20 395\n"
DRILLED = ("--tool", "ball", "--tool-diameter-mm", 4, "--drill", "--hole-diameter-mm", 8, "--approach-mm", 4,
           "--speed-mm-per-s", 15, "--tremor-mm", 0)
DRILL = dict(tool="ball", tool_diameter_mm=4, drill=True)


def bits(frames):
    """Everything of the frames but how late a clock was."""
    frames = np.array(frames)
    frames["late_us"] = 0
    return frames.tobytes()


class AsRecorded(common.Case):
    """Equal poses give the bits of a recording by trephine-sim."""

    @classmethod
    def setUpClass(cls):
        cls.folder, cls.bone = common.sample_case(), common.sample_case("drill")
        path = common.WORK / "path.txt"
        path.write_text(TOUCHING)
        cls.touched, cls.drilled = common.WORK / "touched.servo", common.WORK / "drilled.servo"
        common.run(common.SIM, "servo", cls.folder, "--device", "trajectory", "--trajectory", path, "--seconds", 3.5, "--no-paced",
                   "--record", cls.touched)
        common.run(common.SIM, "servo", cls.bone, "--no-paced", *DRILLED, "--seconds", 8, "--record", cls.drilled)

    def test_a_recording_is_what_an_independent_reader_reads(self):
        for file in (self.touched, self.drilled):
            ours = trephine.read_recording(file)
            header, columns = read_recording.read(file)
            self.assertEqual(ours.seal, "sealed")
            self.assertEqual(ours.header["case_sha256"], header["case_sha256"])
            self.assertEqual(ours.header.get("outcome"), header.get("outcome"))
            self.assertEqual(len(ours.frames), len(columns["tick"]))
            for name in ("tick", "time_s", "touched", "buttons"):
                np.testing.assert_array_equal(ours.frames[name], columns[name])
            for name, theirs in (("force_n", "force_{}_n"), ("tip_mm", "tip_{}_mm"), ("proxy_mm", "proxy_{}_mm")):
                np.testing.assert_array_equal(ours.frames[name], np.column_stack([columns[theirs.format(a)] for a in "xyz"]))
            events = ["+".join(names_of(e, EVENTS)) for e in ours.frames["events"]]
            self.assertEqual(events, columns["events"])

    def test_touching(self):
        recorded = trephine.read_recording(self.touched).frames
        self.assertGreater(np.count_nonzero(recorded["touched"]), 1000)
        self.assertGreater(np.abs(recorded["force_n"]).max(), 0.1)
        session = trephine.Session(self.folder)
        frames = [session.step(f["tip_mm"], f["axis"], int(f["buttons"])) for f in recorded]
        self.assertEqual(bits(frames), bits(recorded))
        session.reset()
        self.assertEqual(bits(session.run(recorded["tip_mm"], recorded["axis"], recorded["buttons"])), bits(recorded))

    def test_drilling_and_beginning_again(self):
        recorded = trephine.read_recording(self.drilled)
        f, outcome = recorded.frames, recorded.header["outcome"]
        self.assertGreater(outcome["removed_mm3"]["skull"], 20)
        session = trephine.Session(self.bone, **DRILL)
        voxels, begin = session.volume.voxels, session.volume.voxels.copy()
        for episode in range(2):
            again = common.WORK / f"again{episode}.servo"
            session.reset(again)
            self.assertEqual(bits(session.run(f["tip_mm"], f["axis"], f["buttons"])), bits(f))
            self.assertGreater(np.count_nonzero(voxels != begin), 100)
            self.assertEqual(session.removed_mm3["skull"], outcome["removed_mm3"]["skull"])
            self.assertEqual(session.finish(), outcome)
            # What was recorded here is what was recorded there, and the program takes it.
            self.assertEqual(bits(trephine.read_recording(again).frames), bits(f))
            said = common.run(common.SIM, "replay", self.bone, again)
            self.assertIn("replayed bit for bit", said)
            self.assertIn("the drilled volume is the same", said)
        session.reset()
        np.testing.assert_array_equal(voxels, begin)
        self.assertTrue(np.shares_memory(voxels, session.volume.voxels))

    def test_replay(self):
        for folder, file in ((self.folder, self.touched), (self.bone, self.drilled)):
            recorded = trephine.read_recording(file)
            frames, digest = trephine.replay(folder, file)
            self.assertEqual(bits(frames), bits(recorded.frames))
            if "outcome" in recorded.header:
                self.assertEqual(digest, recorded.header["outcome"]["volume_sha256"])
        self.refuses(65, "case_sha256", trephine.replay, self.folder, self.drilled)

    def test_a_recording_that_is_none(self):
        data = self.touched.read_bytes()
        for name, wrong, code, pattern in (("cut", data[:-5], 65, "frame"), ("short", data[:40], 65, ""), ("empty", b"", 65, ""),
                                           ("other", b"x" * 9000, 65, "")):
            file = common.WORK / name
            file.write_bytes(wrong)
            self.refuses(code, pattern, trephine.read_recording, file)
        self.refuses(66, "", trephine.read_recording, common.WORK / "none.servo")
        spoilt = bytearray(data)
        spoilt[-60] ^= 1
        file = common.WORK / "spoilt.servo"
        file.write_bytes(spoilt)
        self.assertEqual(trephine.read_recording(file).seal, "broken seal")


class Sessions(common.Case):
    def setUp(self):
        self.folder = common.sample_case("drill")
        self.up = np.array([0.0, 0.0, 1.0])

    def test_arrays_outlive_the_session(self):
        session = trephine.Session(self.folder, **DRILL)
        voxels, copy = session.volume.voxels, session.volume.voxels.copy()
        frames = session.run(np.tile([0.0, 0, 900], (50, 1)), self.up)
        kept = frames.copy()
        force = frames["force_n"]
        del session, frames
        gc.collect()
        rubbish = [np.full(voxels.nbytes, 0xAA, np.uint8) for _ in range(8)]
        np.testing.assert_array_equal(voxels, copy)
        np.testing.assert_array_equal(force, kept["force_n"])
        self.assertFalse(voxels.flags.writeable)
        del rubbish

    def test_what_is_no_pose_is_refused(self):
        s = trephine.Session(self.folder)
        tips = np.zeros((3, 3))
        for wrong, pattern in (((0, 0), "three numbers"), ("abc", "three numbers"), (None, "three numbers"), ((0, 0, np.nan), "finite"),
                               (np.zeros((2, 3)), "three numbers"), ((0, 0, np.inf), "finite")):
            with self.assertRaisesRegex(ValueError, "tip_mm.*" + pattern):
                s.step(wrong, self.up)
        for wrong in ((0, 0, 2), (0, 0, 0), (1, 1, 1)):
            with self.assertRaisesRegex(ValueError, "axis must have length 1"):
                s.step((0, 0, 0), wrong)
            with self.assertRaisesRegex(ValueError, "axis must have length 1"):
                s.run(tips, wrong)
        for wrong in (-1, 2 ** 32, 2 ** 70, 1.5, "a", None, np.int64(-1), np.array([1.5] * 3), np.array([1, 2 ** 32, 1])):
            with self.assertRaisesRegex(ValueError, "^buttons"):
                s.step((0, 0, 0), self.up, wrong)
            with self.assertRaisesRegex(ValueError, "^buttons"):
                s.run(tips, self.up, wrong)
        for right in (2 ** 32 - 1, np.int64(2 ** 32 - 1), np.uint32(2 ** 32 - 1), np.array(2 ** 32 - 1)):
            self.assertEqual(s.step((0, 0, 900), self.up, right)["buttons"], 2 ** 32 - 1)
            self.assertEqual(s.run(tips, self.up, right)["buttons"].tolist(), [2 ** 32 - 1] * 3)
        for kind in (np.uint8, np.int16, np.int64, np.uint64, list):
            row = [1, 0, 3] if kind is list else np.array([1, 0, 3], kind)
            self.assertEqual(s.run(tips, self.up, row)["buttons"].tolist(), [1, 0, 3])
        with self.assertRaisesRegex(ValueError, "axis has 2 rows, tip_mm has 3"):
            s.run(tips, np.tile(self.up, (2, 1)))
        with self.assertRaisesRegex(ValueError, "buttons"):
            s.run(tips, self.up, np.zeros(2, np.uint32))
        for call in (lambda: s.step((0, 0, 0), self.up, 0, (1, 0, 0)), lambda: s.run(tips, self.up, 0, (1, 0, 0))):
            with self.assertRaisesRegex(ValueError, "knows_across"):
                call()
        turned = trephine.Session(self.folder, knows_across=True)
        for call in (lambda: turned.step((0, 0, 0), self.up), lambda: turned.run(tips, self.up)):
            with self.assertRaisesRegex(ValueError, "across is missing"):
                call()
        frame = turned.step((0, 0, 900), self.up, 0, (1, 0, 0))
        np.testing.assert_array_equal(frame["across"], [1, 0, 0])
        self.assertEqual(len(s.run(np.zeros((0, 3)), self.up)), 0)
        self.assertEqual(s.step((1e300, 0, 0), self.up)["force_n"].tolist(), [0, 0, 0])

    def test_what_is_no_session_is_refused(self):
        for code, pattern, params in ((65, "tool", dict(tool="spoon")), (65, "tool_diameter_mm", dict(tool_diameter_mm=-1)),
                                      (64, "", dict(tool="point", drill=True)), (65, "speed", dict(speed=3)),
                                      (65, "rate_hz", dict(rate_hz=1e9)), (64, "shape", dict(shape="none")),
                                      (65, "lesson", dict(lesson="none")), (65, "tool", dict(lesson="ventriculostomy", tool="ball")),
                                      (64, "^trephine: participant: is of a lesson", dict(participant="r-07")),
                                      (64, "^trephine: task: is of a lesson", dict(task="left")),
                                      (64, "participant: must be 1 to 32", dict(lesson="ventriculostomy", participant="Jane Doe"))):
            self.refuses(code, pattern, trephine.Session, self.folder, **params)
        self.refuses(66, "none", trephine.Session, common.WORK / "none")
        self.refuses(73, "", trephine.Session, self.folder, record=common.WORK / "none" / "a.servo")
        case = trephine.load_case(self.folder)
        case.sha256 = "0" * 64
        with self.assertRaisesRegex(ValueError, "was changed"):
            trephine.Session(case)

    def test_a_recording_is_there_when_it_is_finished(self):
        file = common.WORK / "finished.servo"
        with trephine.Session(self.folder, record=file) as s:
            s.run(np.tile([0.0, 0, 900], (20, 1)), self.up)
            self.assertFalse(file.exists())
        self.assertEqual(len(trephine.read_recording(file).frames), 20)
        with self.assertRaisesRegex(RuntimeError, "reset"):
            s.step((0, 0, 900), self.up)
        self.assertEqual(s.torque_n_mm.tolist(), [0, 0, 0])
        dropped = common.WORK / "dropped.servo"
        with self.assertRaises(KeyError):
            with trephine.Session(self.folder, record=dropped) as s:
                s.step((0, 0, 900), self.up)
                raise KeyError
        self.assertEqual(list(common.WORK.glob("*dropped*")), [])
        # A session whose recording cannot be written can begin again.
        self.refuses(73, "", s.reset, common.WORK / "none" / "a.servo")
        self.assertEqual(s.removed_mm3["skull"], 0)
        s.reset()
        s.step((0, 0, 900), self.up)

    def test_a_recording_that_cannot_be_completed(self):
        folder = common.WORK / "removed"
        folder.mkdir()
        s = trephine.Session(self.folder, record=folder / "a.servo", **DRILL)
        hit = s.first_hit((1, -20, 400), (1, -20, 300))
        s.run(np.linspace(hit.point_mm + 5 * self.up, hit.point_mm - 3 * self.up, 1000), self.up, 1)
        cut = s.removed_mm3
        self.assertGreater(cut["skull"], 1)
        shutil.rmtree(folder)
        with self.assertRaises(trephine.Error):
            s.finish()
        self.assertEqual(s.torque_n_mm.tolist(), [0, 0, 0])
        self.assertEqual(s.removed_mm3, cut)
        for call in (lambda: s.step((0, 0, 900), self.up), lambda: s.run(np.zeros((3, 3)), self.up)):
            with self.assertRaisesRegex(RuntimeError, "reset"):
                call()
        self.assertEqual(s.finish(), {})
        s.reset()
        self.assertEqual(s.removed_mm3["skull"], 0)
        s.step((0, 0, 900), self.up)

    def test_one_thread_at_a_time(self):
        s = trephine.Session(self.folder, **DRILL)
        tips = np.tile([1.0, -20, 309], (2000, 1))
        calls = {"run": lambda: s.run(tips, self.up, 1), "step": lambda: s.step((0, 0, 900), self.up),
                 "first_hit": lambda: s.first_hit((0, 0, 900), (0, 0, 0)), "patch": lambda: s.patch((0, 0, 0)),
                 "shape_at": lambda: s.shape_at((0, 0, 0)), "removed_mm3": lambda: s.removed_mm3,
                 "header": lambda: s._hand.header, "torque_n_mm": lambda: s.torque_n_mm}
        others, refused, wrong = threading.Event(), collections.Counter(), []

        def call(name):
            try:
                calls[name]()
            except RuntimeError as error:
                refused[name] += 1
                if "another thread" not in str(error):
                    wrong.append(error)

        def run():
            while not others.is_set():
                call("run")

        worker = threading.Thread(target=run)
        worker.start()
        # Any of the two may be the one that is refused. So many calls take minutes.
        for _ in range(1000000):
            for name in calls.keys() - {"run"}:
                call(name)
            if all(refused[name] for name in calls.keys() - {"run"}):
                break
        others.set()
        worker.join()
        self.assertEqual(wrong, [])
        self.assertEqual({name for name in calls if refused[name]} | {"run"}, set(calls))

    def test_places(self):
        s = trephine.Session(self.folder)
        hit = s.first_hit((1, -20, 400), (1, -20, 300))
        self.assertEqual(s.shape_at(hit.point_mm - [0, 0, 1]), hit.shape)
        self.assertNotEqual(hit.shape, "")
        self.assertGreater(hit.normal[2], 0.5)
        self.assertEqual(s.shape_at((1, -20, 400)), "")
        self.assertIsNone(s.first_hit((1, -20, 500), (1, -20, 490)))
        for wrong in ((0, 0, np.nan), (0, 0)):
            with self.assertRaises(ValueError):
                s.first_hit(wrong, (0, 0, 0))
            with self.assertRaises(ValueError):
                s.patch(wrong)
        v = s.volume.voxels
        i, j, k = np.round(s.volume.index(hit.point_mm)).astype(int)
        padded = np.pad(v, 8)
        np.testing.assert_array_equal(s.patch(hit.point_mm, 8), padded[k + 4:k + 12, j + 4:j + 12, i + 4:i + 12])
        self.assertEqual(np.count_nonzero(s.patch((1e9, 0, 0), 5)), 0)
        for wrong in (0, -1, 257):
            with self.assertRaisesRegex(ValueError, "size must be"):
                s.patch((0, 0, 0), wrong)


if __name__ == "__main__":
    unittest.main()
