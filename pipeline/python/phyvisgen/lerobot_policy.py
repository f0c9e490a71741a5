"""A policy that lerobot trained, from its checkpoint (lerobot 0.5 or newer, with its processors)."""

from __future__ import annotations

import os
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
import torch
from lerobot.configs.policies import PreTrainedConfig
from lerobot.policies.factory import get_policy_class, make_pre_post_processors
from lerobot.utils.import_utils import register_third_party_plugins

from .checkpoint import Inputs
from .server import Answer, Server

__all__ = ["LeRobotPolicy"]


class LeRobotPolicy:
    """checkpoint: a folder `pretrained_model`. Cameras are those that the checkpoint was trained with."""

    def __init__(self, checkpoint: str | os.PathLike[str], prompt: str, device: str = "cpu") -> None:
        folder = Path(checkpoint)
        self._inputs = Inputs.read(folder)
        register_third_party_plugins()  # policies of other packages, such as lerobot_policy_phyvisgen
        config = PreTrainedConfig.from_pretrained(str(folder))
        config.device = device
        self.name = f"lerobot:{folder}"
        self.cameras = tuple(self._inputs.pictures)
        self._prompt = prompt
        with redirect_stdout(sys.stderr):  # what lerobot tells is no part of our output
            self._policy = get_policy_class(config.type).from_pretrained(str(folder), config=config).eval()
        self._before, self._after = make_pre_post_processors(
            policy_cfg=config,
            pretrained_path=str(folder),
            preprocessor_overrides={"device_processor": {"device": device}},
        )

    def reset(self, start: Answer) -> None:
        self._inputs.check(start.arrays)
        self._policy.reset()

    def step(self, server: Server, seen: Answer) -> Answer:
        observation: dict[str, Any] = {"task": [self._prompt]}
        for name, key in (("agent_pos", "observation.state"), ("environment_state", "observation.environment_state")):
            observation[key] = torch.from_numpy(seen.arrays[name].astype(np.float32))[None]
        for name, picture in seen.pictures.items():
            pixels = torch.from_numpy(picture.copy()).permute(2, 0, 1)[None].float() / 255
            observation[f"observation.images.{name}"] = pixels
        with torch.inference_mode():
            action = self._after(self._policy.select_action(self._before(observation)))
        return server.step(action[0].cpu().numpy(), self.cameras)
