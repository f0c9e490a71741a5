"""scripts/train_and_evaluate.sh with programs that only write down what they are told: demonstrations and evaluation get
the same words."""

import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[3] / "scripts/train_and_evaluate.sh"
PROGRAM = """#!{python}
import json, pathlib, sys
words = sys.argv[1:]
with open("{told}", "a") as told:
    print(pathlib.Path(sys.argv[0]).name, *words, file=told)
if words[0] == "evaluate":
    result = {{"policy": "blind", "episodes": 2, "episodes_detail": [{{"success": True}}, {{"success": False}}]}}
    print(json.dumps({{**result, "baselines": {{"nearest": result}}}}))
for word in words:
    if word.startswith("--output_dir=") and "eval_" in word:
        folder = pathlib.Path(word.split("=")[1])
        folder.mkdir(exist_ok=True)
        (folder / "eval_info.json").write_text('{{"overall": {{"pc_success": 100.0}}}}')
"""


class KeptRows(unittest.TestCase):
    def test_a_row_is_read_once_and_cannot_be_spoilt(self):
        class DataSet:
            reads = []

            def __getitem__(self, index):
                self.reads.append(index)
                return {"action": index}

        specification = importlib.util.spec_from_file_location("train_states", SCRIPT.parent / "policy/train_states.py")
        train_states = importlib.util.module_from_spec(specification)
        specification.loader.exec_module(train_states)
        train_states.keep_rows(DataSet)
        one, other = DataSet(), DataSet()
        one[3]["action"] = "spoilt"
        self.assertEqual([one[3], one[4], other[3]], [{"action": 3}, {"action": 4}, {"action": 3}])
        self.assertEqual(DataSet.reads, [3, 4, 3])


def run_table(test, script, words, without, variables):
    """A script of tables in the folder of `test`: the finished process, and what its programs were told, line by line."""
    environment = {name: value for name, value in os.environ.items() if name not in without}
    environment |= {"PHYVISGEN_PROGRAM": str(test.folder / "phyvisgen"), "TRAINING_PROGRAMS": str(test.folder)}
    environment |= {"LENGTH": "9", "EPISODES": "2", **variables}
    process = subprocess.run(["sh", str(script), *words], env=environment, capture_output=True, text=True)
    return process, test.told.read_text().splitlines() if test.told.exists() else []


class TrainAndEvaluate(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = Path(self.temporary.name)
        self.told = self.folder / "told"
        for name in ("phyvisgen", "lerobot-eval"):
            program = self.folder / name
            program.write_text(PROGRAM.format(python=sys.executable, told=self.told))
            program.chmod(0o755)
        # no link, since a link to the interpreter of a virtual environment would leave that environment; scripts of
        # training are written down alone
        (self.folder / "python").write_text(
            "#!/bin/sh\n"
            f'case "$1" in *.py) echo "${{1##*/}}" "$@" >>{self.told} ;; *) exec {sys.executable} "$@" ;; esac\n'
        )
        (self.folder / "python").chmod(0o755)

    def run_script(self, **variables):
        """The finished process, and the words of each program that ran, by its name and command."""
        self.told.write_text("")
        names = {"OBSERVATION", "CAMERA", "SIZE", "SAMPLES", "GRIPPER", "GENERATE", "STEPS", "BATCH", "EPISODES",
                 "NETWORK", "WEIGHTS", "TRAINING", "DEVICE", "VAE", "SAVE", "CHUNK", "EXECUTED", "LEARNING_RATE", "DROPOUT", "JUDGED"}
        environment = {name: value for name, value in os.environ.items() if name not in names}
        environment |= {"PHYVISGEN_PROGRAM": str(self.folder / "phyvisgen"), "TRAINING_PROGRAMS": str(self.folder)}
        environment |= {"LENGTH": "9", "EPISODES": "2", **variables}
        words = ["sh", str(SCRIPT), "task.yaml", str(self.folder / "out")]
        process = subprocess.run(words, env=environment, capture_output=True, text=True)
        lines = [line.split() for line in self.told.read_text().splitlines()]
        return process, {line[0] if line[0] != "phyvisgen" else line[1]: line[1:] for line in lines}

    def test_pictures_have_one_size_in_training_and_evaluation(self):
        process, told = self.run_script(OBSERVATION="pictures", CAMERA="front wrist", SIZE="128x96", SAMPLES="2")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("--width 128 --height 96 --samples 2", " ".join(told["generate"]))
        self.assertNotIn("--no-render", told["generate"])
        self.assertIn("--camera front --camera wrist", " ".join(told["generate"]))
        self.assertNotIn("--no-pictures", told["pack"])
        for word in ("--env.obs_type=pixels_agent_pos", "--env.width=128", "--env.height=96", "--env.samples=2"):
            self.assertIn(word, told["lerobot-eval"])
        self.assertIn("--env.cameras=[front,wrist]", told["lerobot-eval"])
        self.assertIn("--network keypoints --device cpu", " ".join(told["train_pictures.py"]))
        self.assertIn("--chunk 20 --executed 10", " ".join(told["train_pictures.py"]))
        self.assertNotIn("train_states.py", told)
        result = (self.folder / "out/result.csv").read_text().split()
        self.assertEqual(result[1:], ["blind,,1,2,", "nearest,,1,2,", "act,1,2,2,10"])

    def test_another_network_gets_its_weights_and_device(self):
        process, told = self.run_script(
            OBSERVATION="pictures", NETWORK="resnet18", WEIGHTS="some", DEVICE="cuda", LEARNING_RATE="2e-4",
            TRAINING="--shift 1",
        )
        self.assertEqual(process.returncode, 0, process.stderr)
        words = " ".join(told["train_pictures.py"])
        for word in ("--network resnet18 --device cuda --weights some", "--learning-rate 2e-4", "--shift 1"):
            self.assertIn(word, words)

    def test_states_need_no_pictures(self):
        process, told = self.run_script(DEVICE="cuda")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("--policy.device=cuda", told["train_states.py"])
        self.assertIn("--no-render", told["generate"])
        self.assertIn("--environment-state", told["pack"])
        self.assertIn("--env.obs_type=state", told["lerobot-eval"])
        self.assertNotIn("train_pictures.py", told)

    def test_a_policy_is_asked_as_often_as_told_and_judged_anew_where_that_changes(self):
        process, told = self.run_script(EXECUTED="5 1")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("--policy.n_action_steps=5", told["train_states.py"])
        result = (self.folder / "out/result.csv").read_text().split()
        self.assertEqual(result[-2:], ["act,1,2,2,5", "act,1,2,2,1"])
        (self.folder / "out/act_1/checkpoints/last").mkdir(parents=True)  # no training really ran
        process, told = self.run_script(EXECUTED="5 1")
        self.assertEqual(sorted(told), ["generate", "pack"])
        self.assertEqual((self.folder / "out/result.csv").read_text().split(), result)
        process, told = self.run_script(EXECUTED="5 1", EPISODES="3")
        self.assertEqual(sorted(told), ["evaluate", "generate", "lerobot-eval", "pack"])
        self.assertIn("--policy.n_action_steps=1", told["lerobot-eval"])

    def test_the_gripper_is_the_same_everywhere(self):
        for observation in ("states", "pictures"):
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            process, told = self.run_script(GRIPPER="rigid", OBSERVATION=observation)
            self.assertEqual(process.returncode, 0, process.stderr)
            self.assertIn("--gripper rigid", " ".join(told["generate"]))
            self.assertIn("--gripper rigid", " ".join(told["evaluate"]))
            self.assertIn("--env.gripper=rigid", told["lerobot-eval"])

    def test_another_task_may_judge_with_its_own_fingers(self):
        process, told = self.run_script(GRIPPER="rigid", JUDGED="reality.yaml")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("task.yaml", told["generate"])
        self.assertIn("rigid", told["generate"])
        self.assertEqual(told["evaluate"][:3], ["evaluate", "policy", "reality.yaml"])
        self.assertNotIn("--gripper", told["evaluate"])
        self.assertIn("--env.task=reality.yaml", told["lerobot-eval"])
        self.assertNotIn("--env.gripper=rigid", told["lerobot-eval"])

    def test_mistakes_are_one_sentence(self):
        for variables, sentence in (
            ({"OBSERVATION": "smell"}, "OBSERVATION=smell is neither states nor pictures"),
            ({"CAMERA": "front"}, "CAMERA=front needs OBSERVATION=pictures"),
            ({"NETWORK": "resnet18"}, "NETWORK, WEIGHTS and TRAINING need OBSERVATION=pictures"),
            ({"NETWORK": "resnet", "OBSERVATION": "pictures"}, "NETWORK=resnet is neither keypoints nor resnet18"),
            ({"WEIGHTS": "some", "OBSERVATION": "pictures"}, "WEIGHTS=some needs NETWORK=resnet18"),
            ({"VAE": "true", "OBSERVATION": "pictures"}, "VAE and SAVE need OBSERVATION=states"),
            ({"SIZE": "96"}, "SIZE=96 is not WIDTHxHEIGHT"),
            ({"SIZE": "96x9o"}, "SIZE=96x9o is not WIDTHxHEIGHT"),
            ({"EXECUTED": "5 20"}, "EXECUTED=5 20 holds 20"),
            ({"EXECUTED": "all"}, "EXECUTED=all holds all"),
            ({"GRIPPER": "hard"}, "GRIPPER=hard is neither soft nor rigid"),
            ({"GENERATE": "--worlds 2 --gripper rigid"}, "set GRIPPER=rigid"),
            ({"GENERATE": "--width=64"}, "GENERATE has --width"),
        ):
            process, told = self.run_script(**variables)
            self.assertEqual((process.returncode, told), (2, {}), variables)
            self.assertIn(sentence, process.stderr)
            self.assertEqual(process.stderr.count("\n"), 1)

    def test_a_training_that_fails_is_told(self):
        (self.folder / "python").write_text(
            f'#!/bin/sh\ncase "$1" in *.py) echo no memory; exit 3 ;; *) exec {sys.executable} "$@" ;; esac\n'
        )
        process, told = self.run_script()
        self.assertEqual(process.returncode, 1)
        self.assertIn(f"training of seed 1 failed; {self.folder}/out/train_1.log says why", process.stderr)
        self.assertEqual((self.folder / "out/train_1.log").read_text(), "no memory\n")
        self.assertNotIn("lerobot-eval", told)

    def test_a_folder_keeps_to_what_it_was_made_with(self):
        self.run_script(OBSERVATION="pictures")
        process, told = self.run_script(OBSERVATION="pictures", SIZE="64x64")
        self.assertEqual((process.returncode, told), (2, {}))
        self.assertIn("SIZE=96x96", process.stderr)


if __name__ == "__main__":
    unittest.main()
