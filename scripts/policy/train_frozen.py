#!/usr/bin/env python3
"""Trains ACT of lerobot on pictures where there is no GPU: ResNet-18 keeps its weights, so each picture goes through it
once, before training, and a training step takes a tenth of the time.

    scripts/policy/train_frozen.py --data SET --output FOLDER [--steps 1200] ...

SET is a packed set, FOLDER/pretrained_model becomes a checkpoint as lerobot-train writes it. Features of random weights
differ little from picture to picture, and ACT's projection of them (1 x 1) starts at random, too: trained so, ACT did not
look at pictures for hundreds of steps. Here the projection starts at the whitened principal components of the features.
"""
import argparse
import itertools
from pathlib import Path

import av
import numpy as np
import torch
from lerobot.configs.types import FeatureType, NormalizationMode
from lerobot.datasets.lerobot_dataset import LeRobotDataset
from lerobot.policies.act.configuration_act import ACTConfig
from lerobot.policies.act.modeling_act import ACTPolicy
from lerobot.policies.factory import make_pre_post_processors
from lerobot.utils.feature_utils import dataset_to_policy_features

LEAST_SPREAD = 1e-3  # of a principal component, relative to the first; those below are mostly noise and stay small
WARM_UP, LAST = 200, 0.3  # steps in which the learning rate rises; share of steps with a fifth of it


def words():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--data", required=True)
    parser.add_argument("--output", required=True)
    parser.add_argument("--steps", type=int, default=1200)
    parser.add_argument("--batch", type=int, default=64)
    parser.add_argument("--chunk", type=int, default=20)
    parser.add_argument("--executed", type=int, default=10)
    parser.add_argument("--learning-rate", type=float, default=5e-4)
    parser.add_argument("--dropout", type=float, default=0.0)
    parser.add_argument("--weights", help="of ResNet-18, such as ResNet18_Weights.IMAGENET1K_V1; else drawn at random")
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def untrained(meta, w):
    features = dataset_to_policy_features(meta.features)
    seen = {
        key: feature
        for key, feature in features.items()
        if key == "observation.state" or feature.type is FeatureType.VISUAL
    }
    if not any(feature.type is FeatureType.VISUAL for feature in seen.values()):
        raise SystemExit(f"train_frozen: {w.data} holds no pictures; pack a set that was rendered, without --no-pictures")
    config = ACTConfig(
        input_features=seen,
        output_features={"action": features["action"]},
        normalization_mapping={name: NormalizationMode.MEAN_STD for name in ("STATE", "VISUAL", "ACTION")},
        device="cpu", push_to_hub=False, pretrained_backbone_weights=w.weights, chunk_size=w.chunk,
        n_action_steps=w.executed, dim_model=128, dim_feedforward=512, n_heads=4, n_encoder_layers=2, use_vae=False,
        dropout=w.dropout,
    )
    return ACTPolicy(config)


def pictures(root, camera):
    """Of every row in its order, by 64. [n, 3, height, width] in 0 to 1; whole videos are decoded faster than rows"""
    files = sorted(Path(root).glob(f"videos/{camera}/chunk-*/file-*.mp4"))
    frames = (frame.to_ndarray(format="rgb24") for file in files for frame in av.open(str(file)).decode(video=0))
    while some := list(itertools.islice(frames, 64)):
        yield torch.from_numpy(np.stack(some)).permute(0, 3, 1, 2).float() / 255


def normalised(data, policy, prepare):
    """Every row as the policy takes it, pictures as features of the backbone. [n, ...]"""
    numbers = {key: torch.tensor(data.hf_dataset.with_format("numpy")[key][:]) for key in ("observation.state", "action")}
    batch = prepare(numbers)
    rows = {key: batch[key] for key in numbers}
    with torch.no_grad():
        for camera in policy.config.image_features:
            some = (prepare({camera: batch})[camera] for batch in pictures(data.root, camera))
            rows[camera] = torch.cat([policy.model.backbone(batch)["feature_map"] for batch in some])
            if len(rows[camera]) != len(data):
                raise SystemExit(f"train_frozen: {data.root} has {len(data)} rows, but {len(rows[camera])} pictures of "
                                 f"{camera}; pack the set anew")
    return rows


def start_at_principal_components(projection, maps):
    """projection: 1 x 1, to fewer channels than the features have. maps [n, channels, height, width]"""
    points = maps[:: 1 + len(maps) // 2000].permute(0, 2, 3, 1).reshape(-1, maps.shape[1]).double()
    mean = points.mean(0)
    spread, directions = torch.linalg.svd(points - mean, full_matrices=False)[1:]
    n = projection.out_channels
    spread = spread[:n, None] / len(points) ** 0.5
    weight = directions[:n] / torch.clamp(spread, min=float(spread[0]) * LEAST_SPREAD)
    with torch.no_grad():
        k = len(weight)  # few pictures have fewer components; the other channels stay random
        projection.weight[:k].copy_(weight[:, :, None, None])
        projection.bias[:k].copy_(-weight @ mean)


class Kept(torch.nn.Module):
    """In the backbone's place: what comes in are features already."""

    def forward(self, maps):
        return {"feature_map": maps}


def main():
    w = words()
    torch.set_num_threads(1)
    torch.manual_seed(w.seed)
    data = LeRobotDataset("local/set", root=w.data, video_backend="pyav")
    policy = untrained(data.meta, w)
    prepare, restore = make_pre_post_processors(policy.config, dataset_stats=data.meta.stats)
    rows = normalised(data, policy.eval(), prepare)
    backbone = policy.model.backbone
    policy.model.backbone = Kept()
    start_at_principal_components(
        policy.model.encoder_img_feat_input_proj, torch.cat([rows[key] for key in policy.config.image_features])
    )

    episode = np.array(data.hf_dataset["episode_index"])
    last = np.searchsorted(episode, episode, side="right") - 1
    ahead = np.arange(len(episode))[:, None] + np.arange(w.chunk)
    is_pad = torch.from_numpy(ahead > last[:, None])
    actions = rows.pop("action")[np.minimum(ahead, last[:, None])]
    parameters = [p for p in policy.parameters() if p.requires_grad]
    optimizer = torch.optim.AdamW(parameters, weight_decay=1e-4)
    generator = np.random.default_rng(w.seed)
    losses = []
    policy.train()
    for step in range(1, w.steps + 1):
        rate = w.learning_rate * min(1, step / WARM_UP) * (1 if step <= (1 - LAST) * w.steps else 0.2)
        for group in optimizer.param_groups:
            group["lr"] = rate
        chosen = generator.integers(len(episode), size=w.batch)
        batch = {key: values[chosen] for key, values in rows.items()}
        loss, _ = policy({**batch, "action": actions[chosen], "action_is_pad": is_pad[chosen]})
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(parameters, 10.0)
        optimizer.step()
        losses.append(float(loss.detach()))
        if step % 100 == 0 or step == w.steps:
            print(f"step {step}: mean error of normalised actions {np.mean(losses[-100:]):.4f}", flush=True)
    policy.model.backbone = backbone
    folder = Path(w.output) / "pretrained_model"
    policy.save_pretrained(folder)
    prepare.save_pretrained(folder)
    restore.save_pretrained(folder)


if __name__ == "__main__":
    main()
