"""The examples of docs/guide/policies.md run as they stand, one after the other."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import phyvisgen
from small_task import TASK

ROOT = Path(__file__).resolve().parents[3]
PAGE = ROOT / "docs/guide/policies.md"
CASE = ROOT / "data/hidden/pendulum_joint_coulomb_friction_10x"


class Guide(unittest.TestCase):
    def test_every_example_runs(self):
        examples = re.findall(r"^```py\n(.*?)^```", PAGE.read_text(), re.M | re.S)
        self.assertEqual(len(examples), 6)
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                words = [phyvisgen.find_program(), "generate", TASK, "--no-render", "-o", "out/beaker"]
                subprocess.run(words, check=True, capture_output=True)
                words = [phyvisgen.find_program(), "diagnose", CASE, "--minutes", "1", "-o", "out/diagnosis"]
                subprocess.run(words, check=True, capture_output=True)
                for example in examples:
                    exec(compile(example, str(PAGE), "exec"), {"print": lambda *_: None})
            finally:
                os.chdir(before)


if __name__ == "__main__":
    unittest.main()
