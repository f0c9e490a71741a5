"""Makes `--env.type=phyvisgen` known to lerobot, which imports installed packages of such names by itself (0.6), or
with `--env.discover_packages_path=lerobot_env_phyvisgen` (0.4).

    lerobot-eval --policy.path=... --env.type=phyvisgen --env.task=weigh_beaker --eval.n_episodes=20

The starts are those of `TaskEnvironment`: seed k of lerobot is start k.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import Any, Callable

import gymnasium
from lerobot.configs.types import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig
from lerobot.utils.constants import ACTION, OBS_ENV_STATE, OBS_IMAGES, OBS_STATE

from phyvisgen import Facts, Server, TaskEnvironment
from phyvisgen.environment import chosen_cameras, observation_names

try:
    from lerobot.envs.utils import freeze_after_episode_end
except ImportError:  # before lerobot 0.6

    def freeze_after_episode_end(make: Callable[[], gymnasium.Env]) -> Callable[[], gymnasium.Env]:
        return make


def make_environment(options: dict[str, Any]) -> gymnasium.Env:
    return TaskEnvironment(**options)


@EnvConfig.register_subclass("phyvisgen")
@dataclass
class PhyVisGenEnv(EnvConfig):
    """task: a task file or the name of one of the program's own. Others: as of `TaskEnvironment`."""

    task: str | None = "weigh_beaker"
    fps: int = 10
    episode_length: int | None = None
    obs_type: str = "state"
    cameras: list[str] | None = None
    width: int | None = None
    height: int | None = None
    samples: int | None = None
    gripper: str | None = None
    render_mode: str | None = "rgb_array"
    features: dict[str, PolicyFeature] = field(default_factory=dict)
    features_map: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.task is None:
            raise ValueError("--env.task names a task file or one of the program's own tasks")
        with Server(self.task, render=False, fps=self.fps) as server:
            self._describe(server.facts)

    def _describe(self, facts: Facts) -> None:
        shown = observation_names(self.obs_type)
        n, m = (len(facts.columns),), (len(facts.environment),)
        self.features = {ACTION: PolicyFeature(type=FeatureType.ACTION, shape=n)}
        self.features_map = {ACTION: ACTION}
        if "agent_pos" in shown:
            self.features["agent_pos"] = PolicyFeature(type=FeatureType.STATE, shape=n)
            self.features_map["agent_pos"] = OBS_STATE
        if "environment_state" in shown:
            self.features["environment_state"] = PolicyFeature(type=FeatureType.ENV, shape=m)
            self.features_map["environment_state"] = OBS_ENV_STATE
        cameras = chosen_cameras(facts, self.cameras)  # named ones are looked at even where no pictures are shown
        for name in cameras if "pixels" in shown else ():
            width, height = facts.cameras[name]
            key = f"pixels/{name}"
            shape = (self.height or height, self.width or width, 3)
            self.features[key] = PolicyFeature(type=FeatureType.VISUAL, shape=shape)
            self.features_map[key] = f"{OBS_IMAGES}.{name}"

    @property
    def package_name(self) -> str:
        return "phyvisgen"

    @property
    def gym_id(self) -> str:
        return "phyvisgen/Task-v0"

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        names = "task episode_length obs_type cameras width height samples fps gripper render_mode".split()
        return {name: getattr(self, name) for name in names}

    def create_envs(
        self, n_envs: int, use_async_envs: bool = False
    ) -> dict[str, dict[int, gymnasium.vector.VectorEnv]]:
        """An environment whose episode has ended waits for the others as it is: no start is simulated for nothing."""
        make = [freeze_after_episode_end(partial(make_environment, self.gym_kwargs)) for _ in range(n_envs)]
        mode = gymnasium.vector.AutoresetMode.NEXT_STEP
        if use_async_envs and n_envs > 1:
            vector: gymnasium.vector.VectorEnv = gymnasium.vector.AsyncVectorEnv(
                make, context="forkserver", autoreset_mode=mode
            )
        else:
            vector = gymnasium.vector.SyncVectorEnv(make, autoreset_mode=mode)
        return {self.type: {0: vector}}
