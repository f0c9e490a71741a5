#!/usr/bin/env python3
"""Trains a policy of lerobot on joints and pictures, the picture network included, with or without a GPU.

    scripts/policy/train_pictures.py --data SET --output FOLDER [--network keypoints] [--steps 5000] ...

SET is a set packed for lerobot, FOLDER/pretrained_model becomes a checkpoint as lerobot-train writes it. Networks:

    keypoints   four convolutions and a spatial softmax (lerobot_policy_phyvisgen), minutes on two cores
    resnet18    ResNet-18 as ACT has it; wants a GPU

Few demonstrations are learned by heart, with the noise of their pixels and the traces of their video. So no picture is
seen twice as it is: each batch is shifted, recoloured and made noisy anew, and joints get noise, too.

Joints tell where a motion goes once it has begun, and then nothing teaches to look. At the start, which the first row of
a packed set shows, they tell nothing: a share of each batch is first rows (--start-share). Much noise on joints at first
makes all rows teach to look; little noise at the end teaches to go on from where the joints are (--joint-noise,
--last-joint-noise).

Actions teach `keypoints` late where to look. --look STEPS teaches this first, from a set packed with --environment-state: a
linear layer, which is dropped then, tells from the keypoints where objects and cloths are. The policy itself gets joints
and pictures only.
"""
import argparse
import math
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from lerobot.configs.types import FeatureType, NormalizationMode
from lerobot.policies.act.configuration_act import ACTConfig
from lerobot.policies.act.modeling_act import ACTPolicy
from lerobot.policies.factory import make_pre_post_processors
from lerobot.utils.feature_utils import dataset_to_policy_features
from lerobot_policy_phyvisgen.configuration_keypoint_act import KeypointACTConfig
from lerobot_policy_phyvisgen.modeling_keypoint_act import KeypointACTPolicy
from picture_rows import read_rows
from torch import nn
from torchvision.ops.misc import FrozenBatchNorm2d

NETWORKS = {"keypoints": (KeypointACTConfig, KeypointACTPolicy), "resnet18": (ACTConfig, ACTPolicy)}
# noise of joints [rad] first and last, and the share of first rows; what each network was measured with
RECIPES = {
    "keypoints": {"joint_noise": 0.1, "last_joint_noise": 0.01, "start_share": 0.25},
    "resnet18": {"joint_noise": 0.01, "last_joint_noise": 0.01, "start_share": 0.0},
}
WARM_UP = 200  # steps in which the learning rate rises; it falls as a cosine until the end
SETTLED = 0.8  # share of steps after which batch normalisation keeps its statistics, which the policy will have
STATE, ACTION, ENVIRONMENT = "observation.state", "action", "observation.environment_state"
LOOKING_RATE, LOOKING_WARM_UP = 2e-3, 50  # learning rate of --look and the steps in which it rises


def words():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--data", required=True)
    parser.add_argument("--output", required=True)
    parser.add_argument("--network", choices=NETWORKS, default="keypoints")
    parser.add_argument("--weights", help="of resnet18, such as ResNet18_Weights.IMAGENET1K_V1; else drawn at random")
    parser.add_argument("--device", default="cpu", help="cpu or cuda (cpu)")
    parser.add_argument("--steps", type=int, default=5000)
    parser.add_argument("--look", type=int, default=0, help="keypoints: steps before, which teach where objects are (0)")
    parser.add_argument("--batch", type=int, default=32)
    parser.add_argument("--chunk", type=int, default=20, help="actions that are predicted (20)")
    parser.add_argument("--executed", type=int, default=10, help="actions that are done before the policy is asked again (10)")
    parser.add_argument("--learning-rate", type=float, default=5e-4)
    parser.add_argument("--dropout", type=float, default=0.0)
    parser.add_argument("--shift", type=float, default=3.0, help="of pictures, at most [pixels] (3)")
    parser.add_argument("--colour", type=float, default=0.15, help="largest change of a channel's gain (0.15)")
    parser.add_argument("--pixel-noise", type=float, default=0.06, help="largest standard deviation, of 1 (0.06)")
    parser.add_argument("--joint-noise", type=float, help="standard deviation at first [rad], of widths a tenth [m] (0.1; resnet18: 0.01)")
    parser.add_argument("--last-joint-noise", type=float, help="to which it falls as a cosine until the end (0.01)")
    parser.add_argument("--start-share", type=float, help="of each batch that are first rows, 0 to 1 (0.25; resnet18: 0, as any row)")
    parser.add_argument("--left-out", type=int, default=5, help="last demonstrations, on which the error is told (5)")
    parser.add_argument("--seed", type=int, default=1)
    parser.set_defaults(**RECIPES[parser.parse_known_args()[0].network])
    w = parser.parse_args()
    if not 0 <= w.start_share <= 1:
        raise SystemExit(f"train_pictures: --start-share {w.start_share:g} is no share from 0 to 1")
    return w


def untrained(features, w):
    """features: of the set, as in its meta/info.json"""
    known = dataset_to_policy_features(features)
    seen = {key: each for key, each in known.items() if key == STATE or each.type is FeatureType.VISUAL}
    if not any(each.type is FeatureType.VISUAL for each in seen.values()):
        raise SystemExit(f"train_pictures: {w.data} holds no pictures; pack a set that was rendered, without --no-pictures")
    if w.weights and w.network != "resnet18":
        raise SystemExit(f"train_pictures: --weights {w.weights} needs --network resnet18; {w.network} has none")
    make_config, make_policy = NETWORKS[w.network]
    config = make_config(
        input_features=seen,
        output_features={ACTION: known[ACTION]},
        normalization_mapping={name: NormalizationMode.MEAN_STD for name in ("STATE", "VISUAL", "ACTION")},
        device=w.device, push_to_hub=False, pretrained_backbone_weights=w.weights, chunk_size=w.chunk,
        n_action_steps=w.executed, dim_model=128, dim_feedforward=512, n_heads=4, n_encoder_layers=2, use_vae=False,
        dropout=w.dropout,
    )
    return make_policy(config)


def exchanged(module, old, new):
    """The module, whose normalisations of class `old` have become `new`, with the same numbers."""
    for name, child in module.named_children():
        if type(child) is old:
            norm = new(child.weight.shape[0], eps=child.eps)
            norm.load_state_dict(child.state_dict(), strict=False)  # one counts batches, the other does not
            setattr(module, name, norm)
        else:
            exchanged(child, old, new)
    return module


def seen_anew(pictures, w):
    """pictures [n, 3, height, width] in 0 to 1, each with a shift, a gain of every channel and noise of its own"""
    n, size = len(pictures), torch.tensor(pictures.shape[:1:-1], device=pictures.device)  # width, height

    def drawn(*shape):
        return 2 * torch.rand(*shape, device=pictures.device) - 1

    place = torch.eye(2, 3, device=pictures.device).repeat(n, 1, 1)
    place[:, :, 2] = drawn(n, 2) * w.shift * 2 / size  # a picture is 2 wide
    grid = F.affine_grid(place, pictures.shape, align_corners=False)
    moved = F.grid_sample(pictures, grid, padding_mode="border", align_corners=False)
    noise = w.pixel_noise * drawn(n, 1, 1, 1).abs() * torch.randn_like(moved)
    return (moved * (1 + w.colour * drawn(n, 3, 1, 1)) + noise).clamp(0, 1)


def noise_of_joints(names, step, w):
    """Standard deviation of each column's noise. [n_columns, rad or m]"""
    now = w.last_joint_noise + (w.joint_noise - w.last_joint_noise) * (1 + math.cos(math.pi * step / w.steps)) / 2
    return torch.tensor([now / (10 if "gripper_width" in name else 1) for name in names])


class Batches:
    """Rows of some demonstrations with the actions that follow, which end with the demonstration."""

    def __init__(self, rows, demonstrations, w):
        self.rows, self.device = rows, w.device
        last = np.searchsorted(rows.episode, rows.episode, side="right") - 1
        ahead = np.arange(len(last))[:, None] + np.arange(w.chunk)
        self.is_pad = torch.from_numpy(ahead > last[:, None])
        self.actions = rows.numbers[ACTION][np.minimum(ahead, last[:, None])]
        self.chosen = np.flatnonzero(np.isin(rows.episode, demonstrations))
        is_first = np.append(True, np.diff(rows.episode[self.chosen]) != 0)
        self.starts = np.flatnonzero(is_first)  # of the chosen, the first row of each demonstration
        self.pictures = {key: pictures.to(w.device) for key, pictures in rows.pictures.items()}

    def drawn(self, generator, w):
        """Rows of a batch: some of them starts, the others any."""
        n_starts = round(w.start_share * w.batch)
        starts = self.starts[generator.integers(len(self.starts), size=n_starts)]
        return np.append(starts, generator.integers(len(self.chosen), size=w.batch - n_starts))

    def take(self, which):
        """which: of the rows of these demonstrations"""
        at = self.chosen[which]
        pictures = {key: each[torch.from_numpy(at).to(self.device)].float() / 255 for key, each in self.pictures.items()}
        return {
            STATE: self.rows.numbers[STATE][at], ACTION: self.actions[at], "action_is_pad": self.is_pad[at], **pictures
        }


def left_out_error(policy, prepare, batches, which):
    """Mean error of the actions for rows of the demonstrations that training does not see, in standard deviations."""
    policy.eval()
    with torch.no_grad():
        parts = np.array_split(which, math.ceil(len(which) / 256))
        losses = [float(policy(prepare(batches.take(part)))[0]) for part in parts]
    return float(np.average(losses, weights=[len(part) for part in parts]))


def rate_at(step, steps, rate, warm_up):
    """It rises in the first steps and falls as a cosine until the end."""
    return rate * min(1, step / warm_up) * (1 + math.cos(math.pi * step / steps)) / 2


def look(rows, policy, prepare, seen, unseen, generator, w):
    """Trains the keypoints alone, on where objects and cloths are. seen, unseen: Batches"""
    if w.network != "keypoints":
        raise SystemExit(f"train_pictures: --look needs --network keypoints; {w.network} has no keypoints")
    if ENVIRONMENT not in rows.numbers:
        raise SystemExit(f"train_pictures: --look: {w.data} has no {ENVIRONMENT}; pack the set with --environment-state")
    mean, deviation = (torch.as_tensor(rows.stats[ENVIRONMENT][key]).float().reshape(-1) for key in ("mean", "std"))
    # what hardly moves has a deviation of its own below that of the statistics, and teaches nothing
    moves = rows.numbers[ENVIRONMENT].std(0) > 0.9 * deviation
    if not moves.any():
        raise SystemExit(f"train_pictures: --look: nothing of {ENVIRONMENT} moves in {w.data}; leave --look out")
    wanted = ((rows.numbers[ENVIRONMENT] - mean) / deviation)[:, moves].to(w.device)
    head = nn.Linear(2 * policy.config.n_keypoints * len(rows.pictures), wanted.shape[1]).to(w.device)
    trained = [*policy.model.backbone.parameters(), *head.parameters()]
    optimizer = torch.optim.AdamW(trained, weight_decay=1e-4)

    def error(batches, which, is_anew):
        batch = batches.take(which)
        if is_anew:
            batch |= {camera: seen_anew(batch[camera], w) for camera in rows.pictures}
        ready = prepare(batch)
        places = [policy.model.backbone(ready[camera])["feature_map"].flatten(1) for camera in rows.pictures]
        return (head(torch.cat(places, 1)) - wanted[torch.from_numpy(batches.chosen[which])]).abs().mean()

    policy.train()
    losses = []
    for step in range(1, w.look + 1):
        for group in optimizer.param_groups:
            group["lr"] = rate_at(step, w.look, LOOKING_RATE, LOOKING_WARM_UP)
        loss = error(seen, generator.integers(len(seen.chosen), size=w.batch), True)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(float(loss.detach()))
        if step % 200 == 0 or step == w.look:
            told = ""
            if w.left_out:
                policy.eval()
                with torch.no_grad():
                    told = f"; of demonstrations left out {float(error(unseen, np.arange(len(unseen.chosen)), False)):.4f}"
                policy.train()
            print(f"look {step}: mean error of normalised poses {np.mean(losses[-200:]):.4f}{told}", flush=True)


def train(rows, policy, prepare, w):
    """Trains the policy in place. rows: as of picture_rows"""
    episodes = np.unique(rows.episode)
    if not 0 <= w.left_out < len(episodes):
        raise SystemExit(f"train_pictures: --left-out {w.left_out} of {len(episodes)} demonstrations leaves none to train on")
    n_seen = len(episodes) - w.left_out
    seen, unseen = Batches(rows, episodes[:n_seen], w), Batches(rows, episodes[n_seen:], w)
    norms = [module for module in policy.modules() if isinstance(module, nn.BatchNorm2d)]
    optimizer = torch.optim.AdamW(policy.parameters(), weight_decay=1e-4)
    generator = np.random.default_rng(w.seed)
    if w.look:
        look(rows, policy, prepare, seen, unseen, generator, w)
    losses = []
    for step in range(1, w.steps + 1):
        policy.train()
        if step > SETTLED * w.steps:
            for norm in norms:
                norm.eval()
        for group in optimizer.param_groups:
            group["lr"] = rate_at(step, w.steps, w.learning_rate, WARM_UP)
        batch = seen.take(seen.drawn(generator, w))
        batch[STATE] = batch[STATE] + noise_of_joints(rows.names, step, w) * torch.randn_like(batch[STATE])
        for camera in rows.pictures:
            batch[camera] = seen_anew(batch[camera], w)
        loss, _ = policy(prepare(batch))
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(policy.parameters(), 10.0)
        optimizer.step()
        losses.append(float(loss.detach()))
        if step % 200 == 0 or step == w.steps:
            told = ""
            if w.left_out:
                everywhere, at_starts = np.arange(len(unseen.chosen)), unseen.starts
                told = (f"; of demonstrations left out {left_out_error(policy, prepare, unseen, everywhere):.4f}, "
                        f"at their starts {left_out_error(policy, prepare, unseen, at_starts):.4f}")
            print(f"step {step}: mean error of normalised actions {np.mean(losses[-200:]):.4f}{told}", flush=True)


def main():
    w = words()
    torch.manual_seed(w.seed)
    rows = read_rows(w.data)
    policy = untrained(rows.features, w)
    prepare, restore = make_pre_post_processors(policy.config, dataset_stats=rows.stats)
    # ACT normalises by fixed statistics, which random weights do not have yet: they are found in training
    exchanged(policy, FrozenBatchNorm2d, nn.BatchNorm2d).to(w.device)
    train(rows, policy, prepare, w)
    if w.network == "resnet18":
        exchanged(policy, nn.BatchNorm2d, FrozenBatchNorm2d)
    folder = Path(w.output) / "pretrained_model"
    policy.save_pretrained(folder)
    prepare.save_pretrained(folder)
    restore.save_pretrained(folder)


if __name__ == "__main__":
    main()
