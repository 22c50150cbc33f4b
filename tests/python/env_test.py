# SPDX-License-Identifier: GPL-3.0-or-later
import json
import unittest

import numpy as np

import common
import trephine
from trephine.env import CaseEnv

DOWN = np.array([0, 0, -1, 0, 0, 0, 1], np.float32)


def drilling(**more):
    return CaseEnv(common.sample_case("drill"), tool="ball", tool_diameter_mm=4, axis=(0, 0, 1), step_mm=0.3, **more)


class Environment(common.Case):
    def test_the_interface(self):
        env = drilling(max_steps=5)
        self.assertTrue(env.observation_space.contains(env.reset(seed=3)[0]))
        env.action_space.seed(4)
        action = env.action_space.sample()
        self.assertTrue(env.action_space.contains(action))
        for step in range(5):
            observation, reward, terminated, truncated, info = env.step(action)
            self.assertTrue(env.observation_space.contains(observation))
            self.assertEqual((type(reward), terminated, truncated), (float, False, step == 4))
        self.assertEqual(set(info), {"touched", "removed_mm3", "events", "faults"})
        self.assertEqual(info["faults"], [])
        with self.assertRaisesRegex(RuntimeError, "reset"):
            env.step(action)
        self.assertIs(env.unwrapped, env)
        self.assertTrue(env.observation_space.contains(env.observation_space.sample()))
        env.close()

    def test_the_hand_goes_where_the_action_says(self):
        env = drilling(drill=False, ticks_per_step=7)
        begin = env.reset()[0]
        hit = env.session.first_hit(begin["tip_mm"], begin["tip_mm"] - [0, 0, 50])
        self.assertAlmostEqual(begin["tip_mm"][2] - hit.point_mm[2], 10)
        now = env.step([1, -1, 0.5, 0, 0, 0, 0])[0]
        np.testing.assert_allclose(now["tip_mm"] - begin["tip_mm"], [0.3, -0.3, 0.15], atol=1e-12)
        turned = env.step([0, 0, 0, 1, 0, 0, 0])[0]["axis"]
        np.testing.assert_allclose(turned, [0, -np.sin(0.05), np.cos(0.05)], atol=1e-12)
        far = env.step([9, 0, 0, 0, 0, 0, 0])[0]
        np.testing.assert_allclose(far["tip_mm"] - now["tip_mm"], [0.3, 0, 0], atol=1e-12)

    def test_an_episode_repeats_to_the_bit(self):
        env = drilling(jitter_mm=0.5)

        def episode(seed):
            seen = [env.reset(seed=seed)[0]]
            rewards = []
            for _ in range(45):
                observation, reward, *_ = env.step(DOWN)
                seen.append(observation)
                rewards.append(reward)
            return b"".join(o[n].tobytes() for o in seen for n in sorted(o)), sum(rewards)

        one, cut = episode(1)
        self.assertEqual(one, episode(1)[0])
        self.assertNotEqual(one, episode(2)[0])
        self.assertGreater(cut, 1)

    def test_drilling_through_ends_it(self):
        env = drilling(max_steps=400)
        file = common.WORK / "through.servo"
        env.reset(options={"record": file})
        total, pressed = 0.0, 0.0
        for _ in range(400):
            observation, reward, terminated, truncated, info = env.step(DOWN)
            total += reward
            pressed = max(pressed, observation["force_n"][2])
            if terminated or truncated:
                break
        self.assertTrue(terminated)
        self.assertIn("breach", info["events"])
        self.assertGreater(pressed, 0.1)
        self.assertAlmostEqual(total, info["removed_mm3"]["skull"])
        env.close()
        self.assertTrue(trephine.read_recording(file).header["outcome"]["breached"])
        self.assertIn("replayed bit for bit", common.run(common.SIM, "replay", common.sample_case("drill"), file))

    def test_it_can_be_closed_before_it_begins(self):
        env = drilling()
        env.close()
        with self.assertRaisesRegex(RuntimeError, "reset"):
            env.step(DOWN)
        again, env = env.reset(seed=1)[0], drilling(begin_mm=(1, -20, 400.0))
        self.assertTrue(env.observation_space.contains(again))
        np.testing.assert_array_equal(env.reset()[0]["tip_mm"], [1, -20, 400])

    def test_a_reward_of_ones_own(self):
        env = drilling(reward=lambda frames, removed: -float(np.linalg.norm(frames["force_n"], axis=1).max()))
        env.reset()
        self.assertLess(min(env.step(DOWN)[1] for _ in range(45)), -0.05)

    def test_what_is_wrong_is_refused(self):
        env = drilling()
        with self.assertRaisesRegex(RuntimeError, "reset"):
            env.step(DOWN)
        env.reset()
        for wrong in (np.zeros(6), [np.nan] * 7, np.zeros((7, 1)), 3):
            with self.assertRaisesRegex(ValueError, "7 finite numbers"):
                env.step(wrong)
        for params in (dict(ticks_per_step=0), dict(max_steps=1.5), dict(patch_size="a"), dict(jitter_mm=-1), dict(step_mm=np.nan),
                       dict(axis=(0, 0, 0)), dict(axis=(0, np.nan, 1)), dict(axis="up"), dict(patch_size=257),
                       dict(begin_mm=(0, 0)), dict(begin_mm=(0, 0, np.inf)), dict(begin_mm="here"), dict(begin_mm=400.0),
                       dict(lesson="ventriculostomy"), dict(participant="r-07"), dict(task="left")):
            with self.assertRaisesRegex(ValueError, "^" + next(iter(params)) + ":"):
                CaseEnv(common.sample_case("drill"), **params)

    def test_a_lesson_is_scored(self):
        folder, file = common.sample_case("head"), common.WORK / "lesson.servo"
        rubric, report = common.WORK / "rubric.json", common.WORK / "report.json"
        common.run(common.TREPHINE, "rubric", common.SOURCE / "configs/rubrics/ventriculostomy.yaml", "--output", rubric)
        session = trephine.Session(folder, lesson="ventriculostomy", participant="r-07", record=file)
        self.assertEqual(session.header["lesson"]["module"], "ventriculostomy")
        tools = [t["name"] for t in session.header["lesson"]["tools"]]
        up = np.array([0.0, 0.0, 1.0])
        # The burr is taken in the air and goes down on the head with its pedal down; then the lesson is finished.
        middle = session.volume.position_mm((np.array(session.volume.voxels.shape[::-1]) - 1) / 2)
        hit = session.first_hit(middle + 300 * up, middle)
        burr = tools.index("burr") << 8
        tips = hit.point_mm + np.linspace(20, -4, 3000)[:, None] * up
        session.run(tips, up, burr + 1)
        session.run(tips[::-1].copy(), up, burr)
        session.run(tips[:5].copy(), up, burr + (3 << 16))
        session.finish()
        common.run(common.SIM, "score", file, "--case", folder, "--rubric", rubric, "--json", report)
        scored = json.loads(report.read_text())
        self.assertEqual(scored["participant"], "r-07")
        self.assertIn("replayed bit for bit", common.run(common.SIM, "replay", folder, file))


if __name__ == "__main__":
    unittest.main()
