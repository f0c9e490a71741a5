"""Loads a packed set of the layout 2.1 with lerobot 0.3.3, which checks all time stamps. Argument: the folder of the set."""
import sys

from lerobot.datasets.lerobot_dataset import LeRobotDataset

dataset = LeRobotDataset("local/packed", root=sys.argv[1], video_backend="pyav")
row = dataset[len(dataset) - 1]
for key, feature in dataset.meta.features.items():
    shape = tuple(feature["shape"])
    if feature["dtype"] == "video":
        shape = (shape[2], shape[0], shape[1])
    assert tuple(row[key].shape) in (shape, ()), (key, row[key].shape)
print(f"check_lerobot2: {len(dataset)} frames of {dataset.num_episodes} episodes, task `{row['task']}`")
