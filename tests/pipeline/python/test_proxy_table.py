"""scripts/policy/proxy_table.sh with programs that only write down what they are told."""

import json
import unittest

import test_train_and_evaluate as training

SCRIPT = training.SCRIPT.parent / "policy/proxy_table.sh"


class ProxyTable(unittest.TestCase):
    setUp = training.TrainAndEvaluate.setUp

    def run_script(self, *words, **variables):
        return training.run_table(self, SCRIPT, words, ("GRIPPER", "JUDGED", "OBSERVATION"), variables)

    def begin(self, verdict):
        """A folder whose recordings and diagnosis are there already."""
        out = self.folder / "out"
        (out / "recordings").mkdir(parents=True)
        (out / "diagnosis").mkdir()
        (out / "diagnosis/report.json").write_text(json.dumps({"verdict": verdict}))
        return str(out)

    def test_all_are_judged_in_reality(self):
        out = self.begin("effect")
        process, told = self.run_script(out)
        self.assertEqual(process.returncode, 0, process.stderr)
        judged = [line for line in told if line.startswith("lerobot-eval")]
        self.assertEqual(len(judged), 4)
        for line in judged:
            self.assertIn(f"--env.task={out}/reality.yaml", line)
        made = [line.split()[2] for line in told if line.startswith("phyvisgen generate")]
        self.assertEqual(made, [f"{out}/{name}.yaml" for name in ("nominal", "nominal", "truth", "diagnosis/scene_amended")])
        reality = (self.folder / "out/reality.yaml").read_text()
        self.assertIn("effects:\n  - {effect: joint_viscous_friction", reality)
        self.assertIn("time_step: 10 ms", reality)
        self.assertNotIn("effects:", (self.folder / "out/nominal.yaml").read_text())
        knowing = {name for name in ("nominal", "truth", "reality", "reality_knows")
                   if "  feedforward: friction\n" in (self.folder / f"out/{name}.yaml").read_text()}
        self.assertEqual(knowing, {"nominal", "truth", "reality_knows"})
        rows = (self.folder / "out/proxy.csv").read_text().split()
        self.assertEqual(rows[1], "none,expert,,1,2,0.095,0.905")
        self.assertEqual(rows[2], "none,expert_knows,,1,2,0.095,0.905")
        self.assertIn("amended,act,1,2,2,0.342,1.000", rows)

    def test_it_goes_on_where_it_was_stopped_and_adds_seeds(self):
        out = self.begin("effect")
        (self.folder / "lerobot-eval").rename(self.folder / "whole")
        (self.folder / "lerobot-eval").write_text("#!/bin/sh\nexit 3\n")
        (self.folder / "lerobot-eval").chmod(0o755)
        process, _ = self.run_script(out)
        self.assertNotEqual(process.returncode, 0)  # stopped after its first training
        (self.folder / "whole").rename(self.folder / "lerobot-eval")
        for name in ("nominal", "rigid", "truth", "amended"):  # no training really runs here
            (self.folder / f"out/{name}/act_1/checkpoints/last").mkdir(parents=True)
        process, told = self.run_script(out)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(len([line for line in told if line.startswith("train_states.py")]), 1)
        before = len(told)
        process, told = self.run_script(out, "1", "2")
        self.assertEqual(process.returncode, 0, process.stderr)
        again = [line.split()[0] for line in told[before:] if not line.startswith(("phyvisgen generate", "phyvisgen pack"))]
        self.assertEqual(again, ["train_states.py", "lerobot-eval"] * 4)  # of seed 2 alone
        self.assertIn("rigid,act,2,2,2,0.342,1.000", (self.folder / "out/proxy.csv").read_text().split())

    def test_nothing_named_is_told(self):
        process, told = self.run_script(self.begin("none"))
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("the verdict is none, so there is no amended task", process.stdout)
        self.assertFalse([line for line in told if "scene_amended" in line])

    def test_mistakes_are_one_sentence(self):
        out = str(self.folder / "out")
        for words, variables, sentence in (
            ((), {}, "name a folder"),
            ((out, "one"), {}, "the seed one is no whole number"),
            ((out,), {"GRIPPER": "rigid"}, "are set by this script"),
            ((out,), {"TRAINING_PROGRAMS": "/nowhere"}, "scripts/install_lerobot.sh makes it"),
        ):
            process, told = self.run_script(*words, **variables)
            self.assertEqual((process.returncode, told), (2, []), process.stderr)
            self.assertIn(sentence, process.stderr)
            self.assertEqual(process.stderr.count("\n"), 1)


if __name__ == "__main__":
    unittest.main()
