"""scripts/policy/relit_table.sh with programs that only write down what they are told."""

import unittest

import test_train_and_evaluate as training

SCRIPT = training.SCRIPT.parent / "policy/relit_table.sh"


class RelitTable(unittest.TestCase):
    setUp = training.TrainAndEvaluate.setUp

    def run_script(self, *words, **variables):
        return training.run_table(self, SCRIPT, words, ("JUDGED", "OBSERVATION", "CAMERA"), variables)

    def test_both_rooms_are_judged_as_captured(self):
        out = str(self.folder / "out")
        process, told = self.run_script(out)
        self.assertEqual(process.returncode, 0, process.stderr)
        made = [line.split()[2] for line in told if line.startswith("phyvisgen generate")]
        self.assertEqual(made, [f"{out}/captured.yaml", f"{out}/relit.yaml"])
        judged = [line for line in told if line.startswith("lerobot-eval")]
        self.assertEqual(len(judged), 2)
        for line in judged:
            self.assertIn(f"--env.task={out}/captured.yaml", line)
            self.assertIn("--env.cameras=[front]", line)
        captured, relit = ((self.folder / f"out/{room}.yaml").read_text() for room in ("captured", "relit"))
        self.assertEqual(relit.replace(", relit: true}", "}"), captured)
        self.assertNotEqual(relit, captured)
        self.assertIn("    visible: false\n", captured)  # of the table, which the room shows
        self.assertEqual([captured.count(key) for key in ("\nlights:", "\nenvironment:", "\nmaterials:")], [1, 0, 1])
        rows = (self.folder / "out/relit.csv").read_text().split()
        self.assertEqual(rows[0], "room,policy,training_seed,successes,episodes,executed")
        self.assertIn("captured,act,1,2,2,10", rows)
        self.assertIn("relit,act,1,2,2,10", rows)

    def test_mistakes_are_one_sentence(self):
        out = str(self.folder / "out")
        for words, variables, sentence in (
            ((), {}, "name a folder"),
            ((out, "one"), {}, "the seed one is no whole number"),
            ((out,), {"CAMERA": "front"}, "are set by this script"),
        ):
            process, told = self.run_script(*words, **variables)
            self.assertEqual((process.returncode, told), (2, []), words)
            self.assertIn(sentence, process.stderr)
            self.assertEqual(process.stderr.count("\n"), 1)


if __name__ == "__main__":
    unittest.main()
