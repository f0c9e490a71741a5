"""What a checkpoint of lerobot takes as observations, from its `config.json`; lerobot itself is not needed."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping

from numpy.typing import NDArray

from .counted import counted

__all__ = ["Inputs"]

PICTURES = "observation.images."
NUMBERS = {"observation.state": "agent_pos", "observation.environment_state": "environment_state"}


@dataclass(frozen=True)
class Inputs:
    file: Path
    pictures: dict[str, tuple[int, int]]  # (width, height) by camera [pixels]
    numbers: dict[str, int]  # agent_pos, environment_state: how many

    @staticmethod
    def read(folder: str | os.PathLike[str]) -> Inputs:
        """folder: `pretrained_model` of a checkpoint."""
        file = Path(folder) / "config.json"
        if not file.is_file():
            raise FileNotFoundError(f"{folder} has no config.json; name the folder `pretrained_model` of a checkpoint")
        features = json.loads(file.read_text()).get("input_features") or {}
        shapes = {key: feature["shape"] for key, feature in features.items()}
        for key in shapes:
            if not key.startswith(PICTURES) and key not in NUMBERS:
                raise ValueError(
                    f"{file}: the policy takes {key!r}, which no task shows; train it on {', '.join(NUMBERS)} or "
                    f"{PICTURES}<camera>"
                )
        pictures = {
            key.removeprefix(PICTURES): (shape[2], shape[1])  # channels, height, width
            for key, shape in shapes.items()
            if key.startswith(PICTURES)
        }
        return Inputs(file, pictures, {NUMBERS[key]: shape[0] for key, shape in shapes.items() if key in NUMBERS})

    def check(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Refuses an observation of other sizes than those of training, by `name` of `Answer.arrays`."""
        for camera, (width, height) in self.pictures.items():
            seen_height, seen_width = arrays[f"pictures/{camera}"].shape[:2]
            if (seen_width, seen_height) != (width, height):
                raise ValueError(
                    f"{self.file}: the policy was trained on pictures of {width} x {height} pixels of camera {camera}, "
                    f"not {seen_width} x {seen_height}; add --picture-width {width} --picture-height {height}"
                )
        for name, count in self.numbers.items():
            if arrays[name].shape != (count,):
                raise ValueError(
                    f"{self.file}: the policy was trained on {counted(count, 'number')} of {name}, the task has "
                    f"{arrays[name].size}; judge it on the task that it was trained on"
                )
