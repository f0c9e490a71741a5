"""Settings of `keypoint_act`; lerobot finds the other two modules of this package by the name of this one."""

from __future__ import annotations

from dataclasses import dataclass

from lerobot.configs.policies import PreTrainedConfig
from lerobot.policies.act.configuration_act import ACTConfig

__all__ = ["KeypointACTConfig"]


@PreTrainedConfig.register_subclass("keypoint_act")
@dataclass
class KeypointACTConfig(ACTConfig):
    """As ACT, for pictures of some 96 x 96 pixels. n_keypoints: of each camera."""

    n_keypoints: int = 32
    pretrained_backbone_weights: str | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.n_keypoints > 0:
            raise ValueError(f"n_keypoints is a number of keypoints, not {self.n_keypoints}")
