"""ACT whose pictures pass through four convolutions and a spatial softmax in place of ResNet-18.

    p(i, j) = softmax over pixels of a_k(i, j) / t_k,   keypoint k = sum of p(i, j) (x_i, y_j),   x, y in [-1, 1]

Levine, Finn, Darrell, Abbeel 2016, "End-to-end training of deep visuomotor policies". A keypoint is a place in the
picture, finer than a pixel of the feature map; the network has 19,000 parameters where ResNet-18 has 11 million.
"""

from __future__ import annotations

from typing import Any

import torch
from lerobot.policies.act.modeling_act import ACTPolicy
from torch import Tensor, nn

from .configuration_keypoint_act import KeypointACTConfig

__all__ = ["KeypointACTPolicy", "Keypoints"]


def _convolution(n_in: int, n_out: int, size: int, stride: int) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(n_in, n_out, size, stride, padding=size // 2, bias=False), nn.BatchNorm2d(n_out), nn.ReLU()
    )


class Keypoints(nn.Module):
    """[n, 3, height, width], normalised -> feature_map [n, 2 n_keypoints, 1, 1]: x of each keypoint, then y of each."""

    def __init__(self, n_keypoints: int) -> None:
        super().__init__()
        self.activation = nn.Sequential(
            _convolution(3, 24, 5, 2),
            _convolution(24, 32, 3, 2),
            _convolution(32, 32, 3, 1),
            nn.Conv2d(32, n_keypoints, 1),
        )
        self.log_temperature = nn.Parameter(torch.zeros(n_keypoints))

    def forward(self, pictures: Tensor) -> dict[str, Tensor]:
        activation = self.activation(pictures) / self.log_temperature.exp()[:, None, None]
        height, width = activation.shape[2:]
        share = activation.flatten(2).softmax(2).unflatten(2, (height, width))  # of each pixel in its keypoint
        x = torch.linspace(-1, 1, width, device=share.device)
        y = torch.linspace(-1, 1, height, device=share.device)
        place = torch.cat([share.sum(2) @ x, share.sum(3) @ y], 1)
        return {"feature_map": place[:, :, None, None]}


class KeypointACTPolicy(ACTPolicy):
    config_class = KeypointACTConfig
    name = "keypoint_act"

    def __init__(self, config: KeypointACTConfig, **words: Any) -> None:
        super().__init__(config, **words)
        if config.image_features:
            self.model.backbone = Keypoints(config.n_keypoints)
            self.model.encoder_img_feat_input_proj = nn.Conv2d(2 * config.n_keypoints, config.dim_model, 1)
