"""Environments of one task that step together: one process, one solve for all of them (`phyvisgen serve --worlds`)."""

from __future__ import annotations

import operator
import os
from copy import deepcopy
from functools import partial
from typing import Any, Sequence

import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.vector.utils import concatenate, iterate
from numpy.typing import NDArray

from .counted import counted
from .environment import EVALUATION_SEED, TaskEnvironment, observation_names, planned_length
from .server import Answer, Server

__all__ = ["TaskVectorEnvironment"]


class TaskVectorEnvironment(SyncVectorEnv):
    """As a SyncVectorEnv of so many `TaskEnvironment`s, with the same bits, but they share a process and are simulated
    together. On a GPU that keeps it busy; on a CPU a process each is as fast or faster (docs/guide/policies.md).

    actions: [num_envs, n_columns, rad or m]; rewards, terminations and truncations are [num_envs]. Where one action is
    refused, the others have been done: reset all before going on.

    autoreset_mode: NEXT_STEP or DISABLED. Other arguments are those of `TaskEnvironment`.
    """

    def __init__(
        self,
        task: str | os.PathLike[str],
        num_envs: int = 1,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        obs_type: str = "state",
        episode_length: int | None = None,
        set_seed: int = EVALUATION_SEED,
        cameras: Sequence[str] | None = None,
        render_mode: str | None = None,
        **of_server: Any,
    ) -> None:
        mode = AutoresetMode(autoreset_mode)
        if mode == AutoresetMode.SAME_STEP:
            raise ValueError("autoreset_mode is NEXT_STEP or DISABLED; for SAME_STEP use SyncVectorEnv")
        render = "pixels" in observation_names(obs_type) or render_mode is not None
        self._together = Server(task, render=render, worlds=num_envs, **of_server)
        try:
            make = partial(
                TaskEnvironment,
                task,
                obs_type=obs_type,
                episode_length=planned_length(self._together, set_seed) if episode_length is None else episode_length,
                set_seed=set_seed,
                cameras=cameras,
                render_mode=render_mode,
            )
            makers = [partial(make, world=self._together.world(i)) for i in range(num_envs)]
            super().__init__(makers, autoreset_mode=mode)
        except BaseException:
            self._together.close()
            raise

    def _ask(self, requests: dict[int, dict[str, Any]]) -> dict[int, Answer]:
        answers = self._together.together([{**request, "world": i} for i, request in requests.items()])
        return dict(zip(requests, answers, strict=True))

    def _seen(self) -> dict[str, Any]:
        self._observations = concatenate(self.single_observation_space, self._env_obs, self._observations)
        return deepcopy(self._observations) if self.copy else self._observations

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """options: `reset_mask` [num_envs] says which of them, else all."""
        if seed is None or isinstance(seed, int):
            seeds = [None if seed is None else seed + i for i in range(self.num_envs)]
        else:
            seeds = [None if each is None else operator.index(each) for each in seed]
        if len(seeds) != self.num_envs:
            given = counted(len(seeds), "seed was", "seeds were")
            raise ValueError(f"{given} given for {counted(self.num_envs, 'environment')}; give one each")
        mask = np.asarray((options or {}).get("reset_mask", np.ones(self.num_envs, dtype=np.bool_)))
        if mask.shape != (self.num_envs,) or mask.dtype != np.bool_ or not mask.any():
            raise ValueError(f"reset_mask is an array of {self.num_envs} truth values, of which one at least is true")
        chosen = np.flatnonzero(mask).tolist()
        for flags in (self._terminations, self._truncations, self._autoreset_envs):
            flags[mask] = False
        infos: dict[str, Any] = {}
        for i, answer in self._ask({i: self.envs[i].reset_request(seeds[i]) for i in chosen}).items():
            self._env_obs[i], info = self.envs[i].after_reset(answer)
            infos = self._add_info(infos, info, i)
        return self._seen(), infos

    def step(
        self, actions: NDArray[np.float64]
    ) -> tuple[dict[str, Any], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        shape = (self.num_envs, *self.single_action_space.shape)
        if np.shape(actions) != shape:
            raise ValueError(f"actions has the shape {np.shape(actions)}; give {list(shape)}, a row for each environment")
        resets = self._autoreset_envs if self.autoreset_mode == AutoresetMode.NEXT_STEP else np.zeros(self.num_envs, bool)
        requests = {
            i: self.envs[i].reset_request(None) if resets[i] else self.envs[i].step_request(action)
            for i, action in enumerate(iterate(self.action_space, actions))
        }
        infos: dict[str, Any] = {}
        for i, answer in self._ask(requests).items():
            env = self.envs[i]
            if resets[i]:
                self._env_obs[i], info = env.after_reset(answer)
                self._rewards[i], self._terminations[i], self._truncations[i] = 0.0, False, False
            else:
                self._env_obs[i], self._rewards[i], self._terminations[i], self._truncations[i], info = env.after_step(answer)
            infos = self._add_info(infos, info, i)
        self._autoreset_envs = np.logical_or(self._terminations, self._truncations)
        return self._seen(), self._rewards.copy(), self._terminations.copy(), self._truncations.copy(), infos

    def close_extras(self, **kwargs: Any) -> None:
        super().close_extras(**kwargs)
        self._together.close()
