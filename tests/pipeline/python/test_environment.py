"""Gymnasium's contract, and the same bits however many environments run, in one process or in several."""

import tempfile
import unittest
import warnings
from pathlib import Path
from unittest.mock import patch

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import check_env

import phyvisgen
from small_task import PERIODS, TASK

SHORT = {"task": TASK, "episode_length": PERIODS}
SMALL = {**SHORT, "width": 32, "height": 24}  # of those that make pictures


def make(obs_type="state"):
    return phyvisgen.TaskEnvironment(obs_type=obs_type, **(SMALL if "pixels" in obs_type else SHORT))


def trajectory(environments, seeds):
    """Observations of a policy that goes by what it sees, one list per environment."""
    seen, _ = environments.reset(seed=seeds)
    rows = [seen]
    for _ in range(PERIODS - 1):
        # down and toward where the beaker is
        action = seen["agent_pos"].copy()
        action[:, 0] += 0.05 * seen["environment_state"][:, 8]
        action[:, 1] += 0.01
        seen, *_ = environments.step(action)
        rows.append(seen)
    return {key: np.stack([row[key] for row in rows], axis=1) for key in rows[0]}


class Environment(unittest.TestCase):
    def test_gymnasiums_checker_finds_nothing(self):
        for obs_type in ("pixels_state",):  # which holds every kind of observation
            environment = gymnasium.make(
                "phyvisgen/Task-v0", obs_type=obs_type, render_mode="rgb_array", **SMALL
            ).unwrapped
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                # a recommendation: ours are absolute targets [rad, m], as those of the data sets
                warnings.filterwarnings("ignore", message=".*symmetric and normalized space.*")
                check_env(environment, skip_close_check=True)
            environment.close()

    def test_one_and_four_workers_sync_and_async_give_equal_bits(self):
        seeds = [3, 1, 4, 159]
        with_four = gymnasium.vector.SyncVectorEnv([make] * 4)
        expected = trajectory(with_four, seeds)
        with_four.close()
        beside = gymnasium.vector.AsyncVectorEnv([make] * 4, context="forkserver")
        for key, values in trajectory(beside, seeds).items():
            np.testing.assert_array_equal(values, expected[key], err_msg=key)
        beside.close()
        alone = gymnasium.vector.SyncVectorEnv([make])
        for i, seed in enumerate(seeds):
            for key, values in trajectory(alone, [seed]).items():
                np.testing.assert_array_equal(values[0], expected[key][i], err_msg=f"{key} of seed {seed}")
        alone.close()
        self.assertGreater(np.ptp(expected["environment_state"][:, 0, 8]), 1e-4)  # the starts differ

    def test_worlds_that_step_together_have_the_bits_they_have_alone(self):
        seeds = [3, 1, 4]
        alone = gymnasium.vector.SyncVectorEnv([make] * 3)
        together = gymnasium.make_vec("phyvisgen/Task-v0", num_envs=3, vectorization_mode="vector_entry_point", **SHORT)
        self.assertIsInstance(together, phyvisgen.TaskVectorEnvironment)
        self.assertEqual(together.observation_space, alone.observation_space)
        for environments in (alone, together):  # to the end of the episode, past it, and some of them anew
            environments.rows = [environments.reset(seed=seeds)]
            action = environments.rows[0][0]["agent_pos"].copy()
            for period in range(PERIODS + 3):
                action[:, 0] += [0.01, 0.02, 0]
                environments.rows.append(environments.step(action))
            mask = np.array([False, True, True])
            environments.rows.append(environments.reset(seed=[None, 7, None], options={"reset_mask": mask}))
            environments.rows.append(environments.step(action))
            environments.close()
        for expected, got in zip(alone.rows, together.rows, strict=True):
            for a, b in zip(expected[:-1], got[:-1], strict=True):
                if not isinstance(a, dict):
                    a, b = {"": a}, {"": b}
                for key in a:
                    np.testing.assert_array_equal(a[key], b[key], err_msg=key)
            self.assertEqual(sorted(expected[-1]), sorted(got[-1]))
        # the starts differ, and the episodes ended with their reason
        self.assertGreater(np.ptp(together.rows[0][0]["environment_state"][:, 8]), 1e-4)
        self.assertTrue(together.rows[PERIODS][3].all())
        self.assertIn("position error", together.rows[PERIODS][4]["failure"][0])

    def test_worlds_have_their_own_pictures_and_errors(self):
        with phyvisgen.Server(TASK, width=32, height=24, worlds=2) as server:
            both = [{"world": i, "do": "reset", "seed": 1, "episode": 4 + i, "pictures": True} for i in range(2)]
            answers = server.together(both)
            for i, answer in enumerate(answers):
                again = server.world(i).observe().pictures["front"]
                np.testing.assert_array_equal(answer.pictures["front"], again)
            self.assertFalse(np.array_equal(answers[0].pictures["front"], answers[1].pictures["front"]))
            with patch.object(phyvisgen.server, "MOST_MEMORIES", 1), phyvisgen.Server(TASK, width=32, height=24, worlds=2) as piped:
                for answer, other in zip(answers, piped.together(both), strict=True):
                    np.testing.assert_array_equal(answer.pictures["front"], other.pictures["front"])
            with self.assertRaisesRegex(phyvisgen.ServeError, "two requests of world 0"):
                server.together([{"do": "observe"}, {"do": "observe"}])
            with self.assertRaisesRegex(ValueError, "none of the 2"):
                server.world(2)

    def test_actions_and_seeds_are_one_for_each_environment(self):
        together = phyvisgen.TaskVectorEnvironment(num_envs=2, **SHORT)
        action = together.reset(seed=(3, 4))[0]["agent_pos"]
        for wrong in (action[:1], action[0], np.concatenate([action, action])):
            with self.assertRaisesRegex(ValueError, r"give \[2, 8\], a row for each environment"):
                together.step(wrong)
        with self.assertRaisesRegex(ValueError, "1 seed was given for 2 environments; give one each"):
            together.reset(seed=[3])
        _, infos = together.reset(seed=np.array([5, 3]))
        self.assertEqual(infos["start"].tolist(), [5, 3])
        together.close()

    def test_success_is_told_at_the_end_alone(self):
        environment = make()
        seen, info = environment.reset(seed=0)
        self.assertEqual(info, {"start": 0})
        for period in range(PERIODS):
            seen, reward, terminated, truncated, info = environment.step(seen["agent_pos"])
            self.assertEqual("is_success" in info, period == PERIODS - 1)
            self.assertEqual((terminated, truncated), (False, period == PERIODS - 1))
        self.assertFalse(info["is_success"])
        self.assertIn("position error", info["failure"])
        with self.assertRaisesRegex(RuntimeError, "reset"):
            environment.step(seen["agent_pos"])
        environment.close()

    def test_pictures_are_those_of_the_cameras(self):
        environment = phyvisgen.TaskEnvironment(obs_type="pixels_agent_pos", render_mode="rgb_array", **SMALL)
        seen, _ = environment.reset(seed=0)
        kept = seen["pixels"]["front"].copy()
        environment.render()[:] = 0
        np.testing.assert_array_equal(environment.render(), kept)
        np.testing.assert_array_equal(seen["pixels"]["front"], kept)
        self.assertEqual(list(seen["pixels"]), ["front"])
        self.assertEqual(seen["pixels"]["front"].shape, (24, 32, 3))
        self.assertGreater(seen["pixels"]["front"].std(), 10)
        self.assertTrue(environment.observation_space.contains(seen))
        environment.close()

    def test_the_programs_tasks_are_registered(self):
        self.assertIn("phyvisgen/WeighBeaker-v0", gymnasium.registry)
        self.assertEqual(phyvisgen.environment_id("fold_towel"), "phyvisgen/FoldTowel-v0")
        environment = gymnasium.make("phyvisgen:phyvisgen/Task-v0", obs_type="state", **SHORT)
        self.assertEqual(environment.unwrapped.task, "push_beaker")
        environment.close()

    def test_mistakes_are_named(self):
        with self.assertRaisesRegex(ValueError, "obs_type is one of"):
            make("smell")
        with self.assertRaisesRegex(ValueError, "no camera 'back', but front"):
            phyvisgen.TaskEnvironment(cameras=["back"], **SHORT)
        with self.assertRaisesRegex(ValueError, "'pixels' shows pictures, but no camera is named"):
            phyvisgen.TaskEnvironment(obs_type="pixels", cameras=[], **SMALL)
        environment = phyvisgen.TaskEnvironment(cameras="front", fps=0.4, **SHORT)
        self.assertEqual(environment.metadata["render_fps"], 0.4)
        environment.close()
        with self.assertRaisesRegex(ValueError, "episode_length is a number of periods from 1, not 0"):
            phyvisgen.TaskEnvironment(**{**SHORT, "episode_length": 0})
        far = (TASK.parent / TASK.name).read_text().replace("../../../data", str(TASK.parents[3] / "data"))
        far = far.replace("gripper.yaml", str(TASK.parent / "gripper.yaml")).replace("[-60 mm, 0, 60 mm]", "[5, 0, 60 mm]")
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "far.yaml"
            file.write_text(far)
            with self.assertRaisesRegex(ValueError, "there is none .*far.yaml.*motion element 1.*; say how long: episode_length"):
                phyvisgen.TaskEnvironment(file)
        with self.assertRaisesRegex(FileNotFoundError, "nor one of"):
            phyvisgen.TaskEnvironment("juggle")
        with self.assertRaisesRegex(ValueError, "width is for pictures, and none are made"):
            phyvisgen.TaskEnvironment(obs_type="state", **SMALL)
        with self.assertRaisesRegex(ValueError, "samples is for pictures"):
            phyvisgen.Server(TASK, render=False, samples=4)


if __name__ == "__main__":
    unittest.main()
