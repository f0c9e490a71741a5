"""Gymnasium environments: a policy sees joints, poses and pictures, and says where the joints are to be."""

from __future__ import annotations

import math
import operator
import os
from typing import Any, ClassVar, Sequence

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from .server import Answer, Facts, Server, World, action_numbers

__all__ = ["EVALUATION_SEED", "TaskEnvironment", "chosen_cameras", "observation_names", "planned_length"]

# Seeds of sets from here on belong to evaluation: `generate` refuses them, so that no policy is judged on what it saw.
EVALUATION_SEED = 2**63

# names of observations, by obs_type
OBSERVATION_TYPES = {
    "state": ("agent_pos", "environment_state"),
    "pixels": ("pixels",),
    "pixels_agent_pos": ("pixels", "agent_pos"),
    "pixels_state": ("pixels", "agent_pos", "environment_state"),
}
FARTHEST = 1e3  # bound of observed numbers [m or rad]
LENGTH_OF_PLAN = 1.25  # of an episode, where none is given: what the planned motion of the first start takes, and more


def observation_names(obs_type: str) -> tuple[str, ...]:
    """What an observation of this type holds."""
    if obs_type not in OBSERVATION_TYPES:
        raise ValueError(f"obs_type is one of {', '.join(OBSERVATION_TYPES)}, not {obs_type!r}")
    return OBSERVATION_TYPES[obs_type]


def chosen_cameras(facts: Facts, names: Sequence[str] | None) -> list[str]:
    """Those named, in the task's order, or all where none is named; a name that the task lacks is refused."""
    names = [names] if isinstance(names, str) else names
    for name in names or ():
        if name not in facts.cameras:
            known = ", ".join(facts.cameras) or "none"
            raise ValueError(f"cameras: the task {facts.task} has no camera {name!r}, but {known}; name one of these")
    return [camera for camera in facts.cameras if names is None or camera in names]


def planned_length(server: World, set_seed: int) -> int:
    """Periods of an episode: what the planned motion of the first start takes, and a quarter more."""
    server.reset(set_seed, 0)
    plan = server.request("plan").head
    if plan["periods"] == 0:
        raise ValueError(
            f"how long an episode of {server.facts.task} is goes by the motion planned for its first start, and there is "
            f"none ({plan['reason'] or 'it takes less than a period'}); say how long: episode_length, or --length of "
            "evaluate policy"
        )
    return max(1, math.ceil(LENGTH_OF_PLAN * plan["periods"]))


class TaskEnvironment(gymnasium.Env[dict[str, Any], NDArray[np.float64]]):
    """An episode of a task, from its start to `episode_length` actions [periods].

    Observations, by `obs_type`: agent_pos [n_columns, rad or m], environment_state [n_objects x 7 + n_cloths x 24]
    (position and quaternion x, y, z, w of each object, then 8 keypoints of each cloth), pixels/<camera> [height, width, 3] sRGB. An action says where the joints are
    to be at the end of the period; the targets go there on straight lines. Reward 1 where the episode ends in success,
    else 0. `is_success` is in `info` at the end only: the task's conditions judge the whole episode.

    `reset(seed=k)` begins start k, always the same. Starts for evaluation are none that `generate` makes
    (EVALUATION_SEED). A step that cannot be simulated ends the episode as failed, with its reason in `info`.
    `episode_length` is what ends it, not `max_episode_steps` of `gymnasium.make`, of which `info` would not know.

    Bounds of the action space are the stops of the joints. An action may go beyond them, which `events` tell of an arm as
    `out_of_reach`. What is no action at all (other shape, not finite) is refused and changes nothing.

    world: one of a server that already serves this task, instead of a process of its own; task and what comes after
    `cameras` are then those of that server.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array"], "render_fps": 10}

    def __init__(
        self,
        task: str | os.PathLike[str],
        obs_type: str = "state",
        episode_length: int | None = None,
        set_seed: int = EVALUATION_SEED,
        cameras: Sequence[str] | None = None,
        width: int | None = None,
        height: int | None = None,
        samples: int | None = None,
        fps: float | None = None,
        gripper: str | None = None,
        device: str | None = None,
        render_mode: str | None = None,
        world: World | None = None,
    ) -> None:
        self._shows = observation_names(obs_type)
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode is None or 'rgb_array', not {render_mode!r}")
        if episode_length is not None and operator.index(episode_length) < 1:
            raise ValueError(f"episode_length is a number of periods from 1, not {episode_length}")
        self._has_pictures = "pixels" in self._shows
        self._owned = None if world else Server(
            task,
            render=self._has_pictures or render_mode is not None,
            width=width,
            height=height,
            samples=samples,
            fps=fps,
            gripper=gripper,
            device=device,
        )
        self._server: World = world or self._owned
        facts = self._server.facts
        self.render_mode = render_mode
        self.task = facts.task
        self.task_description = facts.task.replace("_", " ")
        fps = facts.frames_per_second
        self.metadata = {**TaskEnvironment.metadata, "render_fps": int(fps) if fps.is_integer() else fps}
        self._set_seed = set_seed
        try:
            self._cameras = chosen_cameras(facts, cameras)
            if self._has_pictures and not self._cameras:
                raise ValueError(f"obs_type {obs_type!r} shows pictures, but no camera is named or {facts.task} has none")
            self._max_episode_steps = episode_length or planned_length(self._server, set_seed)
        except BaseException:
            self.close()
            raise
        self._picture: NDArray[np.uint8] | None = None
        self._n_periods = 0
        self._ended: Answer | None = None
        n, m = len(facts.columns), len(facts.environment)
        everything = {
            "agent_pos": spaces.Box(-FARTHEST, FARTHEST, (n,), np.float64),
            "environment_state": spaces.Box(-FARTHEST, FARTHEST, (m,), np.float64),
            "pixels": spaces.Dict(
                {name: spaces.Box(0, 255, (*facts.cameras[name][::-1], 3), np.uint8) for name in self._cameras}
            ),
        }
        self.observation_space = spaces.Dict({name: everything[name] for name in self._shows})
        self.action_space = spaces.Box(
            np.array([column.low for column in facts.columns]),
            np.array([column.high for column in facts.columns]),
            dtype=np.float64,
        )

    @property
    def server(self) -> World:
        return self._server

    def _wish(self) -> list[str]:
        return self._cameras if self._has_pictures else []

    def _observation(self, answer: Answer) -> dict[str, Any]:
        pictures = {name: picture.copy() for name, picture in answer.pictures.items()}
        self._picture = answer.pictures[self._cameras[0]] if pictures else None
        everything: dict[str, Any] = {name: array.copy() for name, array in answer.arrays.items()}
        everything["pixels"] = pictures
        return {name: everything[name] for name in self._shows}

    # reset and step in two halves each, so that several environments may ask together (vector.py)

    def reset_request(self, seed: int | None) -> dict[str, Any]:
        super().reset(seed=seed)
        self._start = int(self.np_random.integers(2**31)) if seed is None else int(seed)
        return {"do": "reset", "seed": self._set_seed, "episode": self._start, "pictures": self._wish()}

    def after_reset(self, answer: Answer) -> tuple[dict[str, Any], dict[str, Any]]:
        self._n_periods = 0
        self._ended = None
        return self._observation(answer), {"start": self._start}

    def step_request(self, action: NDArray[np.float64]) -> dict[str, Any]:
        if self._ended is not None:
            raise RuntimeError("the episode has ended; call reset before the next step")
        return {"do": "step", "action": action_numbers(action), "pictures": self._wish()}

    def after_step(self, answer: Answer) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        self._n_periods += 1
        is_last = self._n_periods >= self._max_episode_steps
        info: dict[str, Any] = {}
        if answer.is_over or is_last:
            self._ended = answer
            info = {"is_success": answer.is_success, "failure": answer.failure, "reason": answer.reason}
            info["events"] = [event["name"] for event in answer.events]
        reward = float(info.get("is_success", False))
        return self._observation(answer), reward, answer.is_over, is_last and not answer.is_over, info

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        return self.after_reset(self._server.request(**self.reset_request(seed)))

    def step(self, action: NDArray[np.float64]) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        return self.after_step(self._server.request(**self.step_request(action)))

    def render(self) -> NDArray[np.uint8] | None:  # type: ignore[override]
        """What the first camera sees. [height, width, 3] sRGB; None without a camera or `render_mode`"""
        if self.render_mode is None or not self._cameras:
            return None
        if self._picture is None:
            self._picture = self._server.observe(self._cameras[:1]).pictures[self._cameras[0]]
        return self._picture.copy()  # whoever draws on it changes no observation

    def close(self) -> None:
        if self._owned:
            self._owned.close()
