"""The environment that lerobot knows, and checkpoints in the loop; skipped where lerobot is not installed."""

import contextlib
import importlib.util
import io
import subprocess
import sys
import tempfile
import types
import unittest
from pathlib import Path

import phyvisgen
from phyvisgen import evaluate
from small_task import TASK

HAS_LEROBOT = all(importlib.util.find_spec(name) for name in ("lerobot", "lerobot_env_phyvisgen"))
ROOT = Path(__file__).resolve().parents[3]
WIDTH, HEIGHT = 32, 24


def save_untrained(folder):
    """A small ACT that has learned nothing, on joints and one camera."""
    from lerobot.configs.types import FeatureType, PolicyFeature
    from lerobot.policies.act.configuration_act import ACTConfig
    from lerobot.policies.act.modeling_act import ACTPolicy
    from lerobot.policies.factory import make_pre_post_processors

    config = ACTConfig(
        input_features={
            "observation.state": PolicyFeature(FeatureType.STATE, (8,)),
            "observation.images.front": PolicyFeature(FeatureType.VISUAL, (3, HEIGHT, WIDTH)),
        },
        output_features={"action": PolicyFeature(FeatureType.ACTION, (8,))},
        device="cpu", pretrained_backbone_weights=None, chunk_size=2, n_action_steps=2, dim_model=32, n_heads=2,
        dim_feedforward=32, n_encoder_layers=1, n_vae_encoder_layers=1, latent_dim=4,
    )
    ACTPolicy(config).save_pretrained(folder)
    for processor in make_pre_post_processors(config):
        processor.save_pretrained(folder)


def judged(*words):
    """Exit code, and what is told on stderr."""
    told = io.StringIO()
    with contextlib.redirect_stderr(told), contextlib.redirect_stdout(io.StringIO()):
        code = evaluate.main([str(TASK), "-n", "1", "--length", "2", *words])
    return code, told.getvalue()


@unittest.skipUnless(HAS_LEROBOT, "lerobot is not installed; run scripts/install_lerobot.sh and set PVG_PYTHON")
class LeRobot(unittest.TestCase):
    def test_unknown_cameras_are_refused(self):
        from lerobot_env_phyvisgen import PhyVisGenEnv

        for obs_type in ("pixels_agent_pos", "state"):
            with self.assertRaisesRegex(ValueError, "push_beaker has no camera 'back', but front"):
                PhyVisGenEnv(task=str(TASK), obs_type=obs_type, cameras=["front", "back"])
        known = PhyVisGenEnv(task=str(TASK), obs_type="pixels_agent_pos", cameras=["front"], width=WIDTH, height=HEIGHT)
        self.assertEqual(set(known.features), {"action", "agent_pos", "pixels/front"})
        self.assertEqual(known.features["pixels/front"].shape, (HEIGHT, WIDTH, 3))

    def test_a_policy_is_judged_on_pictures_of_its_size_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            save_untrained(folder)
            policy = ("--policy", f"lerobot:{folder}", "--picture-width", str(WIDTH))
            code, told = judged(*policy, "--picture-height", str(WIDTH))
            self.assertEqual(code, 2, told)
            self.assertIn(f"trained on pictures of {WIDTH} x {HEIGHT} pixels of camera front, not {WIDTH} x {WIDTH}", told)
            code, told = judged(*policy, "--picture-height", str(HEIGHT))
            self.assertEqual(code, 0, told)

    def test_batches_have_their_share_of_starts_and_noise_that_falls(self):
        import numpy as np

        sys.path.insert(0, str(ROOT / "scripts/policy"))
        self.addCleanup(sys.path.remove, str(ROOT / "scripts/policy"))
        import torch
        import train_pictures as training

        episode = np.repeat([3, 4, 7], [4, 2, 30])
        rows = types.SimpleNamespace(episode=episode, numbers={"action": torch.zeros(36, 2)}, pictures={})
        w = types.SimpleNamespace(device="cpu", chunk=2, batch=400, start_share=0.25, joint_noise=0.1, last_joint_noise=0.01, steps=100)
        batches = training.Batches(rows, [4, 7], w)
        self.assertEqual(list(batches.chosen[batches.starts]), [4, 6])
        drawn = batches.chosen[batches.drawn(np.random.default_rng(1), w)]
        self.assertEqual(len(drawn), 400)
        self.assertLessEqual(set(drawn[:100]), {4, 6})
        self.assertEqual(set(drawn), set(range(4, 36)))
        for step, noise in ((0, 0.1), (50, 0.055), (100, 0.01)):
            told = training.noise_of_joints(["joint", "gripper_width"], step, w)
            np.testing.assert_allclose(told, [noise, noise / 10], rtol=1e-6)

    def test_policies_that_were_trained_on_pictures_are_checkpoints(self):
        if not (ROOT / ".venv-pack").is_dir():
            self.skipTest("packing needs pyarrow; run scripts/install_pack.sh")
        with tempfile.TemporaryDirectory() as folder:
            made, packed, without = (f"{folder}/{name}" for name in ("set", "packed", "without"))
            size = ["--width", str(WIDTH), "--height", str(HEIGHT)]
            program = str(phyvisgen.find_program())
            for words in (
                [program, "generate", str(TASK), "-n", "2", *size, "-o", made],
                [program, "pack", made, "--environment-state", "-o", packed],
                [program, "pack", made, "--no-pictures", "-o", without],
            ):
                subprocess.run(words, check=True, capture_output=True)
            train = [sys.executable, str(ROOT / "scripts/policy/train_pictures.py"), "--steps", "2", "--batch", "4"]
            train += ["--left-out", "1"]
            for network in ("keypoints", "resnet18"):
                out = f"{folder}/{network}"
                words = [*train, "--network", network, "--data", packed, "--output", out]
                words += ["--look", "2"] if network == "keypoints" else []
                done = subprocess.run(words, capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual("look 2: mean error of normalised poses" in done.stdout, network == "keypoints")
                self.assertIn("step 2: mean error of normalised actions", done.stdout)
                code, told = judged("--policy", f"lerobot:{out}/pretrained_model", "--picture-width", str(WIDTH),
                                    "--picture-height", str(HEIGHT))
                self.assertEqual(code, 0, told)
            done = subprocess.run([*train, "--data", without, "--output", out], capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn("holds no pictures; pack a set that was rendered", done.stderr)


if __name__ == "__main__":
    unittest.main()
