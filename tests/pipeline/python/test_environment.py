"""Gymnasium's contract, and the same bits however many environments run, in one process or in several."""

import unittest
import warnings

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import check_env

import phyvisgen
from small_task import PERIODS, TASK

SMALL = {"task": TASK, "episode_length": PERIODS, "width": 32, "height": 24}


def make(obs_type="state"):
    return phyvisgen.TaskEnvironment(obs_type=obs_type, **SMALL)


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
        environment = make("pixels_agent_pos")
        seen, _ = environment.reset(seed=0)
        self.assertEqual(list(seen["pixels"]), ["front"])
        self.assertEqual(seen["pixels"]["front"].shape, (24, 32, 3))
        self.assertGreater(seen["pixels"]["front"].std(), 10)
        self.assertTrue(environment.observation_space.contains(seen))
        environment.close()

    def test_the_programs_tasks_are_registered(self):
        self.assertIn("phyvisgen/WeighBeaker-v0", gymnasium.registry)
        self.assertEqual(phyvisgen.environment_id("fold_towel"), "phyvisgen/FoldTowel-v0")
        environment = gymnasium.make("phyvisgen:phyvisgen/Task-v0", obs_type="state", **SMALL)
        self.assertEqual(environment.unwrapped.task, "push_beaker")
        environment.close()

    def test_mistakes_are_named(self):
        with self.assertRaisesRegex(ValueError, "obs_type is one of"):
            make("smell")
        with self.assertRaisesRegex(ValueError, "no camera 'back', but front"):
            phyvisgen.TaskEnvironment(cameras=["back"], **SMALL)
        with self.assertRaisesRegex(FileNotFoundError, "nor one of"):
            phyvisgen.TaskEnvironment("juggle")


if __name__ == "__main__":
    unittest.main()
