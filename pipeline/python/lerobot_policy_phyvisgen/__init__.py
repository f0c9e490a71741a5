"""Makes the policy `keypoint_act` known to lerobot 0.6, which imports installed packages of such names by itself."""

from .configuration_keypoint_act import KeypointACTConfig

__all__ = ["KeypointACTConfig"]
