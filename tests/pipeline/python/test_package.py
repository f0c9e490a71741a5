"""Server, records and baselines, without a simulation where none is needed."""

import io
import json
import os
import socket
import subprocess
import sys
import tempfile
import unittest
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import h5py
import numpy as np

import phyvisgen
from phyvisgen import evaluate
from phyvisgen.evaluation import EpisodeResult, PolicyResult, evaluate as evaluate_policy
from phyvisgen.film import film_failures
from phyvisgen.perturbation import Perturbed, shuffled_control
from phyvisgen.policies import BlindMean, Demonstrations, Expert, NearestDemonstration
from phyvisgen.records import EpisodeSet
from phyvisgen.server import Answer
from phyvisgen.statistics import beta_interval, paired_difference, wilson
from small_task import TASK


class WrongInput(unittest.TestCase):
    def test_files_that_are_missing_or_damaged_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(FileNotFoundError, "set.json is not there; name a folder that generate"):
                EpisodeSet(folder)
            (Path(folder) / "set.json").write_text("{")
            with self.assertRaisesRegex(ValueError, "set.json is no JSON that can be read"):
                EpisodeSet(folder)
            (Path(folder) / "states.h5").write_text("hello")
            with self.assertRaisesRegex(ValueError, "states.h5 is not there or no HDF5 file"):
                phyvisgen.records.Episode(folder)

    def test_ctrl_c_is_one_sentence(self):
        told = io.StringIO()
        with patch.object(evaluate, "_server", side_effect=KeyboardInterrupt), redirect_stderr(told):
            self.assertEqual(evaluate.main(["push.yaml", "--policy", "blind"]), 75)
        self.assertRegex(told.getvalue(), "^phyvisgen: stopped.*\n$")

    def test_a_wrong_option_is_one_sentence(self):
        for words, said in (
            (["push.yaml", "--policy", "blind", "-n", "0"], "whole number from 1, but is `0`"),
            (["push.yaml"], "--policy"),
            (["push.yaml", "--policy", "blind", "--polisy", "x"], "--polisy"),
        ):
            told = io.StringIO()
            with self.assertRaises(SystemExit) as ended, redirect_stderr(told):
                evaluate.main(words)
            self.assertEqual(ended.exception.code, 2)
            self.assertRegex(told.getvalue(), f"^phyvisgen: .*{said}.*--help.*\n$")


class Starts(unittest.TestCase):
    """Where objects and cloths are at the start of a demonstration, in the order of environment_state."""

    def episode(self, folder, name, towel_x, node_step=None):
        path = Path(folder) / "set" / name
        path.mkdir(parents=True)
        (path.parent / "set.json").write_text('{"seed": 7}')
        with h5py.File(path / "states.h5", "w") as file:
            file["time"], file["a"] = [0.1, 0.2], [[1.0], [2.0]]
            file["T_rigid"] = np.tile([[1.0, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7]], (2, 1, 1, 1))
            points = np.full((2, 9, 3), np.nan)
            points[node_step or 0] = np.arange(27).reshape(9, 3) + [towel_x, 0, 0]
            file["X_deform/towel"] = points
            if node_step is not None:
                file["node_step"] = [node_step]
        return path.parent

    def test_the_nearest_demonstration_goes_by_keypoints_of_cloths(self):
        names = ["cup_x", "cup_y", "cup_z", "cup_qx", "cup_qy", "cup_qz", "cup_qw"]
        around = (0, 1, 2, 5, 8, 7, 6, 3)
        names += [f"towel_{k}_{axis}" for k in range(8) for axis in "xyz"]
        column = phyvisgen.server.Column("joint", "rad", (0,), -1, 1)
        facts = phyvisgen.Facts(
            "fold", "", 0.1, 10, 1, True, (column,), ("joint",), ("cup",), {"towel": around}, tuple(names), {}
        )
        with tempfile.TemporaryDirectory() as folder:
            self.episode(folder, "episode_000000", 0.0)
            demonstrations = Demonstrations(self.episode(folder, "episode_000001", 0.3, node_step=1), facts)
        points = np.arange(27).reshape(9, 3)[list(around)]
        np.testing.assert_array_equal(demonstrations.starts[0], [5, 6, 7, *points.reshape(-1)])
        seen = np.concatenate([[5, 6, 7, 0, 0, 0, 1], (points + [0.2, 0, 0]).reshape(-1)])
        nearest = NearestDemonstration(demonstrations)
        nearest.reset(Answer({}, {"environment_state": seen}))
        self.assertIs(nearest._actions, demonstrations.actions[1])


    def test_demonstrations_of_other_objects_are_refused(self):
        facts = phyvisgen.Facts("fold", "", 0.1, 10, 1, True, (), ("joint",), ("cup",), {}, (), {})
        with tempfile.TemporaryDirectory() as folder:
            of = self.episode(folder, "episode_000000", 0.0)
            with h5py.File(of / "episode_000000/states.h5", "a") as file:
                file["T_rigid"].attrs["names"] = np.array([b"plate"])
            with self.assertRaisesRegex(ValueError, "the objects plate, the task fold cup; .*--demonstrations"):
                Demonstrations(of, facts)


class Recorded(unittest.TestCase):
    """A set of two episodes, and a server beside it."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.set = Path(cls.folder.name) / "set"
        words = [phyvisgen.find_program(), "generate", TASK, "-n", "2", "--seed", "5", "--no-render", "-o", cls.set]
        subprocess.run(words, check=True, capture_output=True)
        cls.server = phyvisgen.Server(TASK, render=False)

    @classmethod
    def tearDownClass(cls):
        cls.server.close()
        cls.folder.cleanup()

    def test_a_replayed_demonstration_has_its_bits(self):
        periods = self.server.facts.steps_per_period
        for episode in EpisodeSet(self.set):
            self.server.reset(episode.seed, episode.number)
            targets, q, fingers = episode["/a"], episode["/q"], episode.gripper
            for first in range(0, len(targets), periods):
                answer = self.server.follow(targets[first : first + periods])
            state = self.server.state()
            np.testing.assert_array_equal(state.arrays["q"], q[-1])
            np.testing.assert_array_equal(state.arrays["T_rigid"], episode["/T_rigid"][-1])
            for name, nodes in fingers.items():
                grid = episode.file[f"/X_gripper/{name}"].attrs["rounded_to"]  # [m]; a power of two: no rounding of its own
                np.testing.assert_array_equal(np.rint(state.arrays[f"X_gripper/{name}"] / grid) * grid, nodes[-1])
            self.assertTrue(answer.is_success, answer.failure)

    def test_what_a_record_lacks_is_named(self):
        episodes = EpisodeSet(self.set)
        (self.set / "episode_000001_kept").mkdir(exist_ok=True)
        (self.set / "episode_000001_kept/states.h5").touch()
        self.assertEqual(episodes.done, [0, 1])
        with episodes.episode(1) as episode:
            n = len(episode["/time"])
            offset = episode["/contact/offset"]
            self.assertEqual(len(episode.contacts(n - 1)["gap"]), offset[-1] - offset[-2])
            for step in (-1, n):
                with self.assertRaisesRegex(IndexError, f"has {n} steps, from 0 on; there is no step {step}"):
                    episode.contacts(step)
            with self.assertRaisesRegex(KeyError, "episode_000001 has no data set /Q; it has .*, q, "):
                episode["/Q"]
        with self.assertRaisesRegex(KeyError, "was closed"):
            episode["/q"]
        other = replace(self.server.facts, driven=("wheel",))
        with self.assertRaisesRegex(ValueError, "episode_000000 has the driven joints .*, the task push_beaker wheel"):
            Demonstrations(self.set, other)
        with self.assertRaisesRegex(ValueError, "has other joints, objects or cloths"):
            Demonstrations(self.set, replace(self.server.facts, cloths={"towel": (0, 1)}))

    def test_a_refused_request_loses_nothing(self):
        before = self.server.reset(1, 0)
        with self.assertRaisesRegex(phyvisgen.ServeError, "8 numbers"):
            self.server.step([0.0])
        with self.assertRaisesRegex(phyvisgen.ServeError, "no camera"):
            self.server.observe(["back"])
        after = self.server.observe(False)
        np.testing.assert_array_equal(before.arrays["agent_pos"], after.arrays["agent_pos"])

    def test_baselines_do_as_they_say(self):
        demonstrations = Demonstrations(self.set, self.server.facts)
        self.assertEqual(len(demonstrations.actions), 2)
        self.assertEqual(demonstrations.actions[0].shape[1], 8)
        finer = replace(self.server.facts, steps_per_period=2 * self.server.facts.steps_per_period)
        for actions, same in zip(demonstrations.actions, Demonstrations(self.set, finer).actions):
            np.testing.assert_array_equal(actions, same)  # a task of other steps judges by the same demonstrated periods
        mean = demonstrations.mean()
        np.testing.assert_allclose(mean[0], (demonstrations.actions[0][0] + demonstrations.actions[1][0]) / 2)
        start = self.server.reset(5, 1)
        np.testing.assert_array_equal(
            demonstrations.starts[1], start.arrays["environment_state"][demonstrations.is_length]
        )
        nearest = NearestDemonstration(demonstrations)
        nearest.reset(start)
        self.assertIs(nearest._actions, demonstrations.actions[1])
        length = max(len(actions) for actions in demonstrations.actions)
        for policy in (Expert(), nearest, BlindMean(demonstrations)):
            result = evaluate_policy(self.server, policy, episodes=1, length=length + 1)
            self.assertEqual(len(result.episodes), 1)
            self.assertEqual(result.episodes[0].periods, length + 1)
        self.assertTrue(evaluate_policy(self.server, Expert(), episodes=1).episodes[0].success)

    def test_baselines_stand_beside_a_policy_unasked(self):
        def names(*words):
            told = io.StringIO()
            with redirect_stdout(told), redirect_stderr(io.StringIO()):
                code = evaluate.main([str(TASK), "-n", "1", "--length", "1", "--json", *words])
            return code if code else list(json.loads(told.getvalue())["baselines"])

        demonstrations = ("--demonstrations", str(self.set))
        self.assertEqual(names("--policy", "blind", *demonstrations), ["nearest", "expert"])
        self.assertEqual(names("--policy", "expert"), [])
        self.assertEqual(names("--policy", "blind", "--baseline", "none", *demonstrations), [])
        self.assertEqual(names("--policy", "blind", "--baseline", "expert", "--baseline", "expert", *demonstrations), ["expert"])
        self.assertEqual(names("--policy", "blind", "--baseline", "none", "--baseline", "expert", *demonstrations), 2)

    def test_the_command_tells_json(self):
        words = [phyvisgen.find_program(), "evaluate", "policy", str(TASK), "--policy", "expert", "-n", "1", "--json"]
        words += ["--perturb", "latency=0:0.4", "--points", "2"]
        import os, sys

        environment = {**os.environ, "PVG_PYTHON": sys.executable}
        told = json.loads(subprocess.run(words, check=True, capture_output=True, env=environment).stdout)
        self.assertEqual(told["episodes"], 1)
        self.assertEqual(told["success"], 1.0)
        self.assertEqual(told["episodes_detail"][0]["seed"], 0)
        curve = told["perturbed"][0]
        self.assertEqual([point["amount"] for point in curve["points"]], [0.0, 0.4])
        # nothing is changed by no latency; a hand 0.4 s late is elsewhere at the end of each period, and the starts are one
        details = [point["episodes_detail"] for point in curve["points"]]
        self.assertEqual(details[0], told["episodes_detail"])
        self.assertEqual(details[1][0]["seed"], 0)


class Stays:
    """Asks the joints to stay."""

    name, cameras = "stays", ()

    def reset(self, start):
        self.action = start.arrays["agent_pos"]

    def step(self, server, seen):
        return server.step(self.action)


class Intersections(unittest.TestCase):
    def test_surfaces_that_meet_are_an_event_where_they_are_looked_at(self):
        with phyvisgen.Server(TASK, render=False) as server:
            judged = lambda checks: evaluate_policy(server, Stays(), episodes=1, length=2, check_intersections=checks)
            self.assertNotIn("intersected", judged(True).episodes[0].events)
            with patch.object(server, "intersection", return_value="beaker and table"):
                self.assertIn("intersected", judged(True).episodes[0].events)
                self.assertNotIn("intersected", judged(False).episodes[0].events)


class Videos(unittest.TestCase):
    def test_failures_are_filmed_as_they_were_judged(self):
        with tempfile.TemporaryDirectory() as folder, phyvisgen.Server(TASK, width=16, height=12, samples=1) as server:
            length = 2
            result = evaluate_policy(server, Stays(), episodes=2, length=length)
            files = film_failures(server, Stays(), result, Path(folder), "front", length, most=1)
            self.assertEqual([file.name for file in files], ["failure_0_front.mp4"])
            words = ["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames,width", "-of", "csv=p=0"]
            self.assertEqual(subprocess.check_output([*words, files[0]], text=True).strip(), f"16,{length}")
            other = PolicyResult("stays", [replace(result.episodes[0], reason="it was another failure")])
            with self.assertRaisesRegex(phyvisgen.ServeError, "did not repeat start 0"):
                film_failures(server, Stays(), other, Path(folder), "front", length, most=1)


class Figures(unittest.TestCase):
    def test_wilsons_interval(self):
        low, high = wilson(16, 20)  # 0.584 to 0.919, as tables give it
        self.assertAlmostEqual(low, 0.584, 3)
        self.assertAlmostEqual(high, 0.919, 3)
        self.assertEqual(wilson(0, 0), (0.0, 1.0))

    def test_the_beta_interval_holds_what_it_says(self):
        # no success of one: density 2 (1 - x), distribution function 1 - (1 - x)^2
        low, high = beta_interval(0, 1)
        self.assertAlmostEqual(low, 1 - 0.975**0.5, 12)
        self.assertAlmostEqual(high, 1 - 0.025**0.5, 12)
        # trapezoids of the density under the interval of 16 of 20
        x = np.linspace(*beta_interval(16, 20), 20001)
        inside = np.trapezoid(x**16 * (1 - x) ** 4, x) * 21 * 4845  # 1 / B(17, 5) = 21 (20 over 16)
        self.assertAlmostEqual(inside, 0.95, 6)

    def test_a_paired_difference_goes_by_the_starts_on_which_two_differ(self):
        # 6 starts gained and none lost of 20: p = 2 / 2^6, (7 - 1) / 22 +- 1.96 sqrt((8 / 22 - (6 / 22)^2) / 22)
        told = paired_difference([True] * 20, [False] * 6 + [True] * 14)
        self.assertEqual((told["gained"], told["lost"], told["difference"]), (6, 0, 0.3))
        self.assertEqual(told["p"], 2 / 64)
        self.assertAlmostEqual(told["low"], 6 / 22 - 1.959964 * (8 / 22 - (6 / 22) ** 2) ** 0.5 / 22**0.5, 6)
        same = paired_difference([True, False], [True, False])
        self.assertEqual((same["difference"], same["p"], same["low"]), (0.0, 1.0, -same["high"]))
        with self.assertRaisesRegex(ValueError, "no pairs"):
            paired_difference([True], [])

    def test_a_shuffled_control_knows_chance(self):
        # two amounts, four starts, all well at one and none at the other: of the 16 ways to shuffle each start's pair two
        # have that spread
        certain = shuffled_control([[True] * 4, [False] * 4])
        self.assertEqual(certain["spread"], 0.5)
        self.assertAlmostEqual(certain["p"], 2 / 16, delta=0.015)
        self.assertEqual(shuffled_control([[True, False], [True, False]])["p"], 1.0)  # starts differ, amounts do not

    def test_ranges_of_perturbations(self):
        self.assertEqual(Perturbed.read("friction=0.5:1.5", 3), Perturbed("friction", (0.5, 1.0, 1.5)))
        for wrong in ("friction", "friction=1", "friction=2:1", "=1:2", "friction=a:b", "friction=1:inf"):
            with self.assertRaisesRegex(ValueError, "NAME=LOW:HIGH"):
                Perturbed.read(wrong, 3)
        self.assertEqual(evaluate.main([str(TASK), "--policy", "expert", "--perturb", "friction=2:1"]), 2)

    def test_events_count_episodes(self):
        result = PolicyResult("p", [EpisodeResult(0, True, "", ["grasped"]), EpisodeResult(1, False, "no", ["bumped"])])
        self.assertEqual(result.as_json()["events"], {"bumped": 1, "grasped": 1})
        self.assertEqual(result.as_json()["success"], 0.5)

    def test_mistakes_are_one_sentence(self):
        self.assertEqual(evaluate.main(["juggle", "--policy", "expert"]), 2)
        for option in ("--picture-width", "--picture-height", "--samples"):
            told = io.StringIO()
            with redirect_stderr(told):
                self.assertEqual(evaluate.main([str(TASK), "--policy", "expert", option, "16"]), 2)
            self.assertRegex(told.getvalue(), f"^phyvisgen: {option} is for pictures, and none are made.*--camera")
        with self.assertRaises(SystemExit):
            evaluate.main(["juggle"])
        with self.assertRaises(SystemExit), redirect_stderr(io.StringIO()):
            evaluate.main([str(TASK), "--policy", "expert", "--width", "0"])

    def test_what_is_wrong_is_said_before_the_policy_is_judged(self):
        with patch.object(evaluate, "evaluate", side_effect=AssertionError("judged")):
            told = io.StringIO()
            with redirect_stderr(told):
                self.assertEqual(evaluate.main([str(TASK), "--policy", "expert", "--camera", "back"]), 2)
            self.assertRegex(told.getvalue(), "no camera 'back', but front")

    def test_what_the_program_refuses_is_said_once(self):
        words = [sys.executable, "-m", "phyvisgen.evaluate", str(TASK), "--policy", "expert", "--perturb", "joy=0.5:1"]
        environment = {**os.environ, "PYTHONPATH": str(Path(evaluate.__file__).parents[1])}
        done = subprocess.run(words, env=environment, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "^phyvisgen: [^\n]*joy[^\n]*friction[^\n]*\n$")

    def test_a_python_without_lerobot_is_named(self):
        told = io.StringIO()
        with patch.dict("sys.modules", {"torch": None}), redirect_stderr(told):
            self.assertEqual(evaluate.main([str(TASK), "--policy", "lerobot:nowhere"]), 2)
        self.assertRegex(told.getvalue(), "lerobot:nowhere needs a Python with lerobot.*PVG_PYTHON")


class Socket(unittest.TestCase):
    def test_a_server_at_a_socket_takes_one_client_after_the_other(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "task.sock"
            words = [phyvisgen.find_program(), "serve", TASK, "--no-render", "--socket", path]
            process = subprocess.Popen(words, stderr=subprocess.PIPE)
            self.assertIn(b"serves push_beaker", process.stderr.readline())
            joints = []
            for _ in range(2):
                with phyvisgen.Server(socket=path) as server:
                    joints.append(server.reset(1, 1).arrays["agent_pos"])
            np.testing.assert_array_equal(*joints)
            with socket.socket(socket.AF_UNIX) as broken:
                broken.connect(str(path))
                broken.sendall(b"\0\0")  # and gone: the server goes on
            with phyvisgen.Server(socket=path) as server:
                self.assertEqual(server.facts.task, "push_beaker")
            process.terminate()
            process.wait()
            process.stderr.close()


class Pictures(unittest.TestCase):
    def test_shared_memory_and_a_socket_bring_the_same_pictures(self):
        small = ["--samples", "1", "--width", "64", "--height", "36"]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "task.sock"
            process = subprocess.Popen(
                [phyvisgen.find_program(), "serve", TASK, *small, "--socket", path], stderr=subprocess.PIPE
            )
            while b"serves push_beaker" not in process.stderr.readline():
                pass
            with phyvisgen.Server(socket=path) as server:
                first = server.reset(1, 1, pictures=True)
            process.terminate()
            process.wait()
            process.stderr.close()
        self.assertTrue(all("offset" in array for array in first.head["arrays"]))
        with phyvisgen.Server(TASK, samples=1, width=64, height=36) as server:
            shared = server.reset(1, 1, pictures=True)
            kept = {name: picture.copy() for name, picture in shared.pictures.items()}
            server.follow_plan(pictures=True)
            self.assertTrue(any("memory_offset" in array for array in shared.head["arrays"]))
            self.assertEqual(set(shared.pictures), set(server.facts.cameras))
            for name, picture in first.pictures.items():
                self.assertEqual(picture.shape, (36, 64, 3))
                self.assertGreater(np.ptp(picture), 0)
                np.testing.assert_array_equal(picture, shared.pictures[name])
                np.testing.assert_array_equal(kept[name], shared.pictures[name])  # the next request leaves it alone


class TestWords(unittest.TestCase):
    def test_a_camera_that_there_is_not_is_refused_where_nothing_looks_through_it(self):
        told = io.StringIO()
        with redirect_stderr(told):
            self.assertEqual(evaluate.main([str(TASK), "--policy", "expert", "-n", "1", "--length", "1", "--camera", "back"]), 2)
        self.assertIn("no camera 'back', but front", told.getvalue())

    def test_a_flag_that_is_given_a_value(self):
        from phyvisgen.evaluate import main

        with self.assertRaises(SystemExit) as ended, redirect_stderr(io.StringIO()) as told:
            main(["task.yaml", "--policy", "blind", "--json=3"])
        self.assertEqual(ended.exception.code, 2)
        self.assertIn("--json takes no value, but is given `3`", told.getvalue())


if __name__ == "__main__":
    unittest.main()
