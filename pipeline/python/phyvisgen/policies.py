"""Who says where the joints are to be: baselines that see little, and servers of policies."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .records import Episode, EpisodeSet
from .server import Answer, Facts, Server

QUATERNION = ("_qx", "_qy", "_qz", "_qw")  # ends of the names in environment_state that are no lengths

__all__ = ["BlindMean", "Demonstrations", "Expert", "NearestDemonstration", "Policy"]


class Policy(Protocol):
    """`cameras`: whose pictures it looks at."""

    name: str
    cameras: tuple[str, ...]

    def reset(self, start: Answer) -> None: ...

    def step(self, server: Server, seen: Answer) -> Answer:
        """Does one period of the episode and returns what is seen then."""
        ...


class Demonstrations:
    """Actions and starts of a set: an action per period, the target at the period's end."""

    def __init__(self, folder: str | Path, facts: Facts) -> None:
        self.actions: list[NDArray[np.float64]] = []  # [n_periods, n_columns] of each demonstration
        starts: list[NDArray[np.float64]] = []
        for episode in EpisodeSet(folder):
            _check_names(episode, facts)
            targets = episode["/a"]
            steps = _steps_per_period(episode["/time"], facts)
            last = np.arange(steps - 1, len(targets), steps)
            starts.append(_start(episode, targets, facts))
            self.actions.append(_columns(targets[last], facts))
        if not self.actions:
            raise ValueError(f"{folder} holds no finished episode; make some with `phyvisgen generate`")
        self.starts = np.array(starts)  # [n_demonstrations, n_objects x 3 + n_cloths x 24, m]
        self.is_length = np.array([not name.endswith(QUATERNION) for name in facts.environment], dtype=bool)
        self.seed = EpisodeSet(folder).seed

    def mean(self) -> NDArray[np.float64]:
        """[n_periods, n_columns]; those that have ended stand still."""
        n = max(len(actions) for actions in self.actions)
        return np.mean([np.pad(a, ((0, n - len(a)), (0, 0)), mode="edge") for a in self.actions], axis=0)


def _start(episode: Episode, targets: NDArray[np.float64], facts: Facts) -> NDArray[np.float64]:
    """Its places, where it is of a task with the same joints, objects and cloths."""
    try:
        places = _places(episode, facts)
        is_same = targets.shape[1] == len(facts.driven)
    except (KeyError, IndexError):  # it has no such cloth
        is_same = False
    n_places = sum(not name.endswith(QUATERNION) for name in facts.environment)
    if not is_same or len(places) != n_places:
        raise ValueError(f"{episode.folder} has other joints, objects or cloths than {facts.task}; name a set of this task")
    return places


def _check_names(episode: Episode, facts: Facts) -> None:
    """A task of another name may be judged, but not one of other joints or objects."""
    for data, what, names in (("/a", "driven joints", facts.driven), ("/T_rigid", "objects", facts.objects)):
        recorded = [name.decode() for name in episode.file[data].attrs.get("names", [])]
        if recorded and recorded != list(names):
            raise ValueError(
                f"{episode.folder} has the {what} {', '.join(recorded)}, the task {facts.task} {', '.join(names)}; name "
                "demonstrations of that task with --demonstrations"
            )


def _steps_per_period(time: NDArray[np.float64], facts: Facts) -> int:
    """Of the demonstration itself, whose time step may be another one than that of the task it is judged in."""
    return max(1, round(1 / (facts.frames_per_second * (time[1] - time[0])))) if len(time) > 1 else facts.steps_per_period


def _columns(targets: NDArray[np.float64], facts: Facts) -> NDArray[np.float64]:
    """Targets of joints as numbers of actions: a gripper's width is the sum of its joints."""
    return np.stack([targets[:, list(column.joints)].sum(axis=1) for column in facts.columns], axis=1)


def _places(episode: Episode, facts: Facts) -> NDArray[np.float64]:
    """Positions of the objects and keypoints of the cloths at the start, in the order of environment_state; in
    records of earlier versions, which lack it, in the first step whose nodes are kept."""
    if "/start" in episode.file:
        places = [episode["/start/T_rigid"][:, :, 3].reshape(-1)]
        places += [episode[f"/start/X_deform/{name}"][list(points)].reshape(-1) for name, points in facts.cloths.items()]
        return np.concatenate(places)
    kept = episode["/node_step"][0] if "/node_step" in episode.file else 0
    places = [episode["/T_rigid"][kept, :, :, 3].reshape(-1)]
    for name, keypoints in facts.cloths.items():
        places.append(episode.file[f"/X_deform/{name}"][kept][list(keypoints)].reshape(-1))
    return np.concatenate(places)


class _Replay:
    """Goes through a list of actions, then stands still."""

    name = "replay"
    cameras: tuple[str, ...] = ()

    def __init__(self) -> None:
        self._actions: NDArray[np.float64] = np.zeros((0, 0))
        self._at = 0

    def step(self, server: Server, seen: Answer) -> Answer:
        action = self._actions[min(self._at, len(self._actions) - 1)]
        self._at += 1
        return server.step(action)


class BlindMean(_Replay):
    """The mean of all demonstrated motions: what a policy reaches that sees nothing."""

    name = "blind"

    def __init__(self, demonstrations: Demonstrations) -> None:
        super().__init__()
        self._actions = demonstrations.mean()

    def reset(self, start: Answer) -> None:
        self._at = 0


class NearestDemonstration(_Replay):
    """The demonstration whose objects and cloths start nearest to those of this episode."""

    name = "nearest"

    def __init__(self, demonstrations: Demonstrations) -> None:
        super().__init__()
        self._demonstrations = demonstrations

    def reset(self, start: Answer) -> None:
        self._at = 0
        places = start.arrays["environment_state"][self._demonstrations.is_length]
        distance = np.linalg.norm(self._demonstrations.starts - places, axis=1)
        self._actions = self._demonstrations.actions[int(distance.argmin())]


class Expert:
    """The motion that `generate` plans: what can be reached with knowledge of the start."""

    name = "expert"
    cameras: tuple[str, ...] = ()

    def reset(self, start: Answer) -> None:
        self._last: Answer | None = None
        self._has_ended = False

    def step(self, server: Server, seen: Answer) -> Answer:
        if not self._has_ended:
            answer = server.follow_plan()
            self._has_ended = bool(answer.head["plan_ended"])
            if not self._has_ended:
                return answer
        return server.follow(np.repeat(server.state().arrays["a"][None], server.facts.steps_per_period, axis=0))
