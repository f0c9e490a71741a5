"""One task, stepped by `phyvisgen serve` (docs/reference/serve.md): a step's answer takes 0.1 ms, a step of
simulation 10 to 300 ms."""

from __future__ import annotations

import operator
import os
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .connection import Connection, ServeError, SharedMemory, read_array
from .counted import counted
from .program import find_program, find_task, serve_words

__all__ = ["Answer", "Column", "Facts", "ServeError", "Server", "World"]

MOST_MEMORIES = 128  # of two open files each, of which a process may have 1024; pictures of further worlds take the pipe


@dataclass(frozen=True)
class Answer:
    """head: the JSON object of the message; arrays: by name, read-only.

    What comes of reset, step, follow, follow_plan and observe holds `agent_pos` [n_columns, rad or m] and `environment_state`
    [n_objects x 7 + n_cloths x 24]: position [m] and quaternion x, y, z, w of each object, then eight points [m] of each
    cloth, in the world's frame, named by Facts.environment. The properties below are of these alone.
    """

    head: dict[str, Any]
    arrays: dict[str, NDArray[Any]]

    @property
    def is_over(self) -> bool:
        """A step could not be done; `reason` says why."""
        return bool(self.head["over"])

    @property
    def reason(self) -> str:
        return str(self.head["reason"])

    @property
    def is_success(self) -> bool:
        """The task's conditions hold, if the episode ended now."""
        return bool(self.head["success"])

    @property
    def failure(self) -> str:
        """What speaks against success, a sentence; empty: nothing."""
        return str(self.head["failure"])

    @property
    def events(self) -> list[dict[str, Any]]:
        return list(self.head["events"])

    @property
    def pictures(self) -> dict[str, NDArray[np.uint8]]:
        """[height, width, 3] sRGB, by camera."""
        return {name.split("/", 1)[1]: array for name, array in self.arrays.items() if name.startswith("pictures/")}


@dataclass(frozen=True)
class Column:
    """A number of actions and joint observations: a joint, or the width of a gripper, the sum of its joints. Bounds
    are infinite where a joint has no stops."""

    name: str
    unit: str
    joints: tuple[int, ...]  # of Facts.driven
    low: float
    high: float


@dataclass(frozen=True)
class Facts:
    """What holds for every episode of the task."""

    task: str
    program: str
    time_step: float  # [s]
    frames_per_second: float  # actions per second
    steps_per_period: int
    grasps: bool  # the task's motion closes a gripper
    columns: tuple[Column, ...]
    driven: tuple[str, ...]  # joints with a drive, the columns of /a in states.h5
    objects: tuple[str, ...]
    cloths: dict[str, tuple[int, ...]]  # keypoints of each: points of its mesh
    environment: tuple[str, ...]  # names of the numbers of environment_state
    cameras: dict[str, tuple[int, int]]  # (width, height) [pixels]
    worlds: int = 1  # that step together


def _facts(head: Mapping[str, Any]) -> Facts:
    if "scene" in head:
        raise ServeError(f"{head['scene']} is a scene; step it with phyvisgen.Simulation")
    columns = tuple(
        Column(
            column["name"],
            column["unit"],
            tuple(column["joints"]),
            -np.inf if column["low"] is None else column["low"],
            np.inf if column["high"] is None else column["high"],
        )
        for column in head["columns"]
    )
    return Facts(
        head["task"],
        head["program"],
        head["time_step"],
        head["frames_per_second"],
        head["steps_per_period"],
        head["grasps"],
        columns,
        tuple(head["driven"]),
        tuple(head["objects"]),
        {cloth["name"]: tuple(cloth["keypoints"]) for cloth in head["cloths"]},
        tuple(head["environment"]),
        {camera["name"]: (camera["width"], camera["height"]) for camera in head["cameras"]},
        head.get("worlds", 1),
    )


def action_numbers(action: ArrayLike) -> list[float]:
    """An action as it stands in a request. [n_columns, rad or m]"""
    return _rows(action, 1)


def _rows(numbers: ArrayLike, n_dimensions: int) -> list[Any]:
    array = np.asarray(numbers, dtype=np.float64)
    if array.ndim != n_dimensions:
        raise ValueError(f"an array of {counted(n_dimensions, 'dimension')} is needed, this one has {array.ndim}")
    rows: list[Any] = array.tolist()
    return rows


class World:
    """One world that is reset and stepped: the only one of a server, or one of several."""

    facts: Facts

    def request(self, do: str, **keys: Any) -> Answer:
        """Any request of the protocol. What the server refuses is a ServeError, and the episode goes on as it was."""
        raise NotImplementedError

    def reset(self, seed: int, episode: int, pictures: bool | Sequence[str] = False) -> Answer:
        """The start of the episode that `generate` makes of this seed and number."""
        numbers = {"seed": operator.index(seed), "episode": operator.index(episode)}
        return self.request("reset", **numbers, pictures=_wish(pictures))

    def step(self, action: ArrayLike, pictures: bool | Sequence[str] = False) -> Answer:
        """One period; the targets go on straight lines to the action. [n_columns, rad or m]"""
        return self.request("step", action=action_numbers(action), pictures=_wish(pictures))

    def follow(self, targets: ArrayLike, pictures: bool | Sequence[str] = False) -> Answer:
        """As many time steps as there are rows, such as rows of /a in states.h5. [n_steps, n_driven, rad or m]"""
        return self.request("step", targets=_rows(targets, 2), pictures=_wish(pictures))

    def follow_plan(self, pictures: bool | Sequence[str] = False) -> Answer:
        """One period of the motion that `generate` plans; head["plan_ended"]: there was none left."""
        return self.request("step", plan=True, pictures=_wish(pictures))

    def observe(self, pictures: bool | Sequence[str] = True) -> Answer:
        """What is there now; nothing is done."""
        return self.request("observe", pictures=_wish(pictures))

    def state(self) -> Answer:
        """Everything that is simulated, as arrays named as in states.h5."""
        return self.request("state")

    def measured(self) -> dict[str, float | None]:
        """What the task's conditions look at, so far; names end in their units, None is no finite number."""
        return dict(self.request("measure").head["measured"])

    def intersection(self) -> str:
        """Bodies whose surfaces intersect now, by an exact test of its own, such as "beaker and table"; empty: none."""
        return str(self.request("intersection").head["bodies"])

    def planned_periods(self) -> int:
        """Periods of the motion that `generate` plans for this episode; 0: it cannot be planned."""
        return int(self.request("plan").head["periods"])


class _WorldOfServer(World):
    def __init__(self, server: Server, number: int) -> None:
        self.facts = server.facts
        self._server, self._number = server, number

    def request(self, do: str, **keys: Any) -> Answer:
        return self._server.request(do, world=self._number, **keys)


class Server(World):
    """A task that is reset and stepped; by itself it is its world 0.

    task: a file, or the name of one of the program's own. width, height [pixels], samples [per pixel] and fps [1/s]:
    instead of what the task says. gripper: "soft" or "rigid". perturb: amounts by which the task is other than it says,
    such as {"friction": 0.5}; `evaluate policy --perturb` lists the names. With `socket` it asks a server that already runs there,
    and the other arguments are those of that server; its pictures come through the socket, those of a process of its own
    through shared memory; while another client is served there it waits for its turn. worlds: so many episodes, which
    step together in one solve where `together` asks for it.

    It is of the process that makes it: a forked one is refused, and it cannot be pickled. Threads take turns, request by
    request. What the program refuses is a ServeError of one sentence, what cannot be asked for a ValueError or TypeError;
    both leave the episode as it was. A request that is interrupted (Ctrl-C) ends the server. Arrays of answers last.
    """

    def __init__(
        self,
        task: str | os.PathLike[str] = "",
        *,
        program: Path | None = None,
        socket: str | os.PathLike[str] | None = None,
        render: bool = True,
        width: int | None = None,
        height: int | None = None,
        samples: int | None = None,
        fps: float | None = None,
        gripper: str | None = None,
        device: str | None = None,
        perturb: Mapping[str, float] | None = None,
        worlds: int = 1,
    ) -> None:
        self._memory: dict[int, SharedMemory] = {}  # of each world, for pictures
        words: list[str] = []
        if socket is None:
            program = program or find_program()
            options: dict[str, object] = {"width": width, "height": height, "samples": samples, "fps": fps}
            options |= {"gripper": gripper, "device": device, "worlds": worlds if worlds != 1 else None}
            words = serve_words(program, find_task(task, program), render, options)
            for name, amount in (perturb or {}).items():
                words += ["--perturb", f"{name}={float(amount)!r}"]
        self._connection = Connection(words, socket)
        self.facts = self._connection.greeting(_facts)
        n_bytes = sum(3 * width * height for width, height in self.facts.cameras.values())
        if self._connection.is_process and render and n_bytes > 0:
            n_worlds = min(self.facts.worlds, MOST_MEMORIES)
            self._memory = {world: SharedMemory(n_bytes) for world in range(n_worlds)}

    def _answer(self, head: dict[str, Any], data: bytes, world: int) -> Answer:
        if "error" in head:
            raise ServeError(head["error"])
        arrays = {}
        for array in head.get("arrays", []):
            read = read_array(array, data, self._memory.get(world))
            if "memory_offset" in array:  # the next request overwrites the memory
                read = read.copy()
                read.flags.writeable = False
            arrays[array["name"]] = read
        return Answer(head, arrays)

    def _with_memory(self, request: Mapping[str, Any]) -> dict[str, Any]:
        memory = self._memory.get(request.get("world", 0))
        return {**request, "memory": memory.path} if memory and request.get("pictures") else dict(request)

    def request(self, do: str, **keys: Any) -> Answer:
        answer = self._connection.request(self._with_memory({"do": do, **keys}))
        return self._answer(*answer, keys.get("world", 0))

    def world(self, number: int) -> World:
        """One of the worlds, 0 to facts.worlds - 1, to reset and step by itself."""
        if not 0 <= number < self.facts.worlds:
            known = counted(self.facts.worlds, "world")
            raise ValueError(f"world {number} is none of the {known} of this server; start it with more")
        return _WorldOfServer(self, number)

    def together(self, requests: Sequence[Mapping[str, Any]]) -> list[Answer]:
        """Requests of the protocol, each of another world ({"world": 1, "do": "step", "action": [...]}), whose steps are
        simulated in one solve. What the server refuses is a ServeError; the requests of other worlds are done."""
        together = {"do": "together", "requests": [self._with_memory(request) for request in requests]}
        head, data = self._connection.request(together)
        if "error" in head:
            raise ServeError(head["error"])
        return [
            self._answer(answer, data, request.get("world", 0))
            for answer, request in zip(head["answers"], requests, strict=True)
        ]

    def close(self) -> None:
        self._connection.close()
        for memory in self._memory.values():
            memory.close()
        self._memory = {}

    def __enter__(self) -> Server:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _wish(pictures: bool | str | Sequence[str]) -> bool | list[str]:
    return pictures if isinstance(pictures, bool) else [pictures] if isinstance(pictures, str) else list(pictures)
