"""The rows of a set packed for lerobot, all in memory: 10,000 pictures of 96 x 96 pixels take 280 MB."""
from dataclasses import dataclass
from pathlib import Path

import av
import numpy as np
import torch
from lerobot.datasets.lerobot_dataset import LeRobotDataset


@dataclass(frozen=True)
class Rows:
    numbers: dict  # observation.state, action: [n, n_columns, rad or m]; observation.environment_state where the set has it
    pictures: dict  # by key of the camera: [n, 3, height, width] u8, sRGB
    episode: np.ndarray  # [n], ascending
    names: list  # of the columns
    features: dict  # as in meta/info.json
    stats: dict  # as in meta/stats.json


def read_pictures(root, camera):
    """Of every row in its order; whole videos are decoded faster than rows. [n, 3, height, width] u8"""
    files = sorted(Path(root).glob(f"videos/{camera}/chunk-*/file-*.mp4"))
    frames = [frame.to_ndarray(format="rgb24") for file in files for frame in av.open(str(file)).decode(video=0)]
    return torch.from_numpy(np.stack(frames)).permute(0, 3, 1, 2)


def read_rows(folder):
    data = LeRobotDataset("local/set", root=folder, video_backend="pyav")
    columns = data.hf_dataset.with_format("numpy")
    pictures = {camera: read_pictures(folder, camera) for camera in data.meta.camera_keys}
    for camera, each in pictures.items():
        if len(each) != len(data):
            raise SystemExit(f"train_pictures: {folder} has {len(data)} rows, but {len(each)} pictures of {camera}; "
                             "pack the set anew")
    features = data.meta.features
    known = ("observation.state", "action", "observation.environment_state")
    numbers = {key: torch.tensor(columns[key][:]) for key in known if key in features}
    names = features["observation.state"]["names"]
    return Rows(numbers, pictures, np.array(data.hf_dataset["episode_index"]), names, features, data.meta.stats)
