"""What a checkpoint takes, by its config.json: other pictures than those of training are refused."""

import json
import tempfile
import unittest
from pathlib import Path

import numpy as np

from phyvisgen.checkpoint import Inputs

FEATURES = {
    "observation.state": {"type": "STATE", "shape": [8]},
    "observation.images.front": {"type": "VISUAL", "shape": [3, 48, 64]},
}


def inputs(features):
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "config.json").write_text(json.dumps({"type": "act", "input_features": features}))
        return Inputs.read(folder)


def seen(width=64, height=48, joints=8):
    return {"agent_pos": np.zeros(joints), "pictures/front": np.zeros((height, width, 3), np.uint8)}


class Checkpoint(unittest.TestCase):
    def test_sizes_are_read(self):
        known = inputs(FEATURES)
        self.assertEqual(known.pictures, {"front": (64, 48)})
        self.assertEqual(known.numbers, {"agent_pos": 8})
        known.check(seen())

    def test_pictures_of_another_size_are_refused(self):
        for width, height in ((48, 64), (64, 64), (96, 48)):
            with self.assertRaises(ValueError) as refused:
                inputs(FEATURES).check(seen(width, height))
            told = str(refused.exception)
            self.assertIn("config.json: the policy was trained on pictures of 64 x 48 pixels of camera front", told)
            self.assertIn(f"not {width} x {height}; add --picture-width 64 --picture-height 48", told)

    def test_another_number_of_joints_is_refused(self):
        with self.assertRaisesRegex(ValueError, "trained on 8 numbers of agent_pos, the task has 16"):
            inputs(FEATURES).check(seen(joints=16))

    def test_what_no_task_shows_is_refused(self):
        with self.assertRaisesRegex(ValueError, "'observation.effort', which no task shows"):
            inputs({**FEATURES, "observation.effort": {"type": "STATE", "shape": [8]}})
        with self.assertRaisesRegex(FileNotFoundError, "has no config.json"):
            Inputs.read("/nowhere")


if __name__ == "__main__":
    unittest.main()
