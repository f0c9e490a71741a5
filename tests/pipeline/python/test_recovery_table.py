"""scripts/policy/recovery_table.sh with programs that only write down what they are told."""

import unittest

import test_train_and_evaluate as training

SCRIPT = training.SCRIPT.parent / "policy/recovery_table.sh"


class RecoveryTable(unittest.TestCase):
    setUp = training.TrainAndEvaluate.setUp

    def run_script(self, *words, **variables):
        return training.run_table(self, SCRIPT, words, ("JUDGED", "OBSERVATION", "EXECUTED"), variables)

    def test_both_are_judged_without_disturbances(self):
        out = self.folder / "out"
        process, told = self.run_script(str(out), BY="8 mm", TIMES="2")
        self.assertEqual(process.returncode, 0, process.stderr)
        made = [line.split()[2] for line in told if line.startswith("phyvisgen generate")]
        self.assertEqual(made, [f"{out}/plain.yaml", f"{out}/disturbed.yaml"])
        judged = [line for line in told if line.startswith("lerobot-eval")]
        self.assertEqual(len(judged), 4)
        for line in judged:
            self.assertIn(f"--env.task={out}/plain.yaml", line)
        self.assertNotIn("disturbance", (out / "plain.yaml").read_text())
        self.assertIn("by: [-8 mm, 8 mm], times: 2,", (out / "disturbed.yaml").read_text())
        rows = (out / "recovery.csv").read_text().split()
        self.assertEqual(rows[1], "plain,blind,,,1,2,0.095,0.905")
        self.assertIn("disturbed,act,1,1,2,2,0.342,1.000", rows)
        self.assertIn("plain,act,1,5,2,2,0.342,1.000", rows)

    def test_mistakes_are_one_sentence(self):
        out = str(self.folder / "out")
        for words, variables, sentence in (
            ((), {}, "name a folder"),
            ((out,), {"JUDGED": "task.yaml"}, "are set by this script"),
            ((out,), {"TRAINING_PROGRAMS": "/nowhere"}, "scripts/install_lerobot.sh makes it"),
        ):
            process, told = self.run_script(*words, **variables)
            self.assertEqual((process.returncode, told), (2, []), process.stderr)
            self.assertIn(sentence, process.stderr)
            self.assertEqual(process.stderr.count("\n"), 1)


if __name__ == "__main__":
    unittest.main()
