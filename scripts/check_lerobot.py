"""Loads a packed set with lerobot, as its training does, and takes one step of ACT. Argument: the folder of the set."""
import sys
import time

import torch
from lerobot.configs.types import FeatureType
from lerobot.datasets.factory import resolve_delta_timestamps
from lerobot.datasets.lerobot_dataset import LeRobotDataset, LeRobotDatasetMetadata
from lerobot.datasets.utils import dataset_to_policy_features
from lerobot.policies.act.configuration_act import ACTConfig
from lerobot.policies.factory import make_policy, make_pre_post_processors

root = sys.argv[1]
torch.manual_seed(0)
meta = LeRobotDatasetMetadata("local/packed", root=root)
features = dataset_to_policy_features(meta.features)
outputs = {key: feature for key, feature in features.items() if feature.type is FeatureType.ACTION}
inputs = {key: feature for key, feature in features.items() if key not in outputs}
config = ACTConfig(input_features=inputs, output_features=outputs, pretrained_backbone_weights=None, device="cpu",
                   push_to_hub=False)
dataset = LeRobotDataset("local/packed", root=root, delta_timestamps=resolve_delta_timestamps(config, meta))
policy = make_policy(config, ds_meta=meta)
preprocess, _ = make_pre_post_processors(config, dataset_stats=meta.stats)
loader = torch.utils.data.DataLoader(dataset, batch_size=4, shuffle=True, generator=torch.Generator().manual_seed(0))
optimizer = torch.optim.AdamW(policy.parameters(), lr=1e-5)
batch = preprocess(next(iter(loader)))
losses = []
for _ in range(3):
    start = time.process_time()
    loss, _ = policy.forward(batch)
    optimizer.zero_grad()
    loss.backward()
    optimizer.step()
    losses.append(loss.item())
    seconds = time.process_time() - start
assert all(torch.isfinite(torch.tensor(losses))) and losses[-1] < losses[0], losses
images = ", ".join(sorted(config.image_features))
print(f"check_lerobot: {len(dataset)} frames of {meta.total_episodes} episodes, task `{dataset[0]['task']}`; ACT sees {images} "
      f"and {config.robot_state_feature.shape[0]} joints; loss over three steps on one batch: "
      f"{', '.join(f'{loss:.3f}' for loss in losses)}; {seconds:.1f} CPU s a step")
