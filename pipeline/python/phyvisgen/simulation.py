"""One scene, stepped by `phyvisgen serve` (docs/reference/serve.md): states, contacts and forces as NumPy arrays.

SI units, radians, the world's frame, z up. Arrays are read-only views of memory that the program writes: they show the
state at which they were asked for until the next `step()` or `reset()`, after which the memory is used again. Copy what
is to last (`simulation.positions.copy()`).
"""

from __future__ import annotations

import operator
import os
from pathlib import Path
from types import TracebackType
from typing import Any, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .connection import Connection, ServeError, SharedMemory, read_array
from .counted import counted
from .program import find_program, find_scene, serve_words
from .scene_facts import Contacts, Forces, SceneFacts, find

__all__ = ["Simulation", "StepFailure"]

_Arrays = dict[str, NDArray[Any]]
_Numbers = NDArray[np.float64]
_FIRST_BYTES = 1 << 16  # of memory, which grows to what an answer takes


class StepFailure(ServeError):
    """A step could not be done; the sentence names body, element and time. The simulation is where the step before it
    has led: `n_done` steps of those that were asked for are done, and it can be stepped on or reset."""

    def __init__(self, sentence: str, n_done: int) -> None:
        super().__init__(sentence)
        self.n_done = n_done


class Simulation:
    """A scene that is reset and stepped, with the bits of `phyvisgen simulate`.

    scene: a file (YAML, MJCF, URDF), or the name of one of the program's own. width, height [pixels] and samples [per
    pixel]: of pictures, instead of what the scene says. With `socket` it asks a server that already runs there, whose
    scene is brought to its start; the other arguments are those of that server, arrays come through the socket, and
    views last. What the program refuses is a ServeError of one sentence, what does not fit the scene a ValueError; both
    leave the simulation as it was. A request that is interrupted (Ctrl-C) ends it. It is of the process that makes it: a
    forked one is refused, and it cannot be pickled.
    """

    facts: SceneFacts
    """What never changes: bodies, joints, cameras, time step."""

    def __init__(
        self,
        scene: str | os.PathLike[str] = "",
        *,
        program: Path | None = None,
        socket: str | os.PathLike[str] | None = None,
        render: bool = True,
        width: int | None = None,
        height: int | None = None,
        samples: int | None = None,
        device: str | None = None,
    ) -> None:
        words: list[str] = []
        if socket is None:
            program = program or find_program()
            options = {"width": width, "height": height, "samples": samples, "device": device}
            words = serve_words(program, find_scene(scene, program), render, options)
        self._memory: dict[str, SharedMemory] = {}
        self._known: dict[str, _Arrays] = {}  # answers about the present state
        self._time, self._n_steps = 0.0, 0
        self._connection = Connection(words, socket)
        self.facts = self._connection.greeting(SceneFacts.read)
        try:
            self.reset()
        except BaseException:
            self.close()
            raise

    # ---- what moves it

    def reset(self) -> None:
        """Back to the start. What follows has the bits that it had the first time."""
        self._move({"do": "reset"})

    def step(self, n: int = 1, targets: ArrayLike | None = None) -> None:
        """n time steps of `facts.time_step` [s].

        targets: what the drives are told, a number for each joint of `facts.driven` [rad, m; of drives of velocity rad/s,
        m/s; of torque N m, N]: [n_driven], the same in all n steps, or [n, n_driven], a row for each step (n may then be
        left out). Without targets drives are told what the scene file says of that time. Raises StepFailure where a step
        cannot be done.
        """
        n = operator.index(n)
        if n < 1:
            raise ValueError(f"step was asked for {n} steps; give n = 1 or more")
        if targets is None:
            return self._move({"do": "step", "n": n})
        self._move({"do": "step", "targets": self._rows(targets, n)})

    def _rows(self, targets: ArrayLike, n: int) -> _Numbers:
        rows, n_driven = np.asarray(targets, dtype=np.float64), len(self.facts.driven)
        if rows.ndim == 1:
            rows = np.tile(rows, (n, 1))
        if rows.ndim != 2 or rows.shape[1] != n_driven or len(rows) == 0 or (n != 1 and len(rows) != n):
            raise ValueError(
                f"targets has the shape {np.shape(targets)}; the scene has {counted(n_driven, 'joint')} with a drive: give "
                f"[{n_driven}], or [n, {n_driven}] with a row for each of the n steps"
            )
        if not np.isfinite(rows).all():
            raise ValueError("targets holds what is not a finite number")
        return rows

    def _move(self, request: Mapping[str, Any]) -> None:
        head, _ = self._connection.request(request)
        if "error" in head and "n_steps" not in head:
            raise ServeError(head["error"])
        n_before, self._time, self._n_steps = self._n_steps, head["time"], head["n_steps"]
        self._known = {}
        if "error" in head:
            raise StepFailure(head["error"], self._n_steps - n_before)

    # ---- where everything is

    @property
    def time(self) -> float:
        """Since the start [s]."""
        return self._time

    @property
    def n_steps(self) -> int:
        """Since the start."""
        return self._n_steps

    @property
    def positions(self) -> _Numbers:
        """Nodes of all soft bodies, then cloths, in the order of `facts.bodies`. [n_nodes, 3], m, world"""
        return self._state()["X_"]

    @property
    def velocities(self) -> _Numbers:
        """Of the same nodes. [n_nodes, 3], m/s, world"""
        return self._state()["V_"]

    @property
    def poses(self) -> _Numbers:
        """Of all rigid bodies, body to world: x = A X + p as [A | p]. [n_rigid, 3, 4]"""
        return self._state()["T_rigid"]

    @property
    def twists(self) -> _Numbers:
        """Of all rigid bodies: velocity of the body frame's origin [m/s], angular velocity [rad/s]. [n_rigid, 6], world"""
        return self._state()["V_rigid"]

    @property
    def joints(self) -> _Numbers:
        """Position of each of `facts.joints`, 0 of fixed and spherical ones. [n_joints], rad or m"""
        return self._state()["joint/position"]

    @property
    def targets(self) -> _Numbers:
        """What drives were told in the last step. [n_driven]"""
        return self._state()["a"]

    def nodes(self, body: str) -> _Numbers:
        """Where the nodes of a soft body or cloth are. [n, 3], m, world"""
        nodes: _Numbers = self.positions[self._rows_of(body)]
        return nodes

    def pose(self, body: str) -> _Numbers:
        """Of a rigid body, body to world: x = A X + p as [A | p]; A is a rotation up to a strain of some 1e-6. [3, 4]"""
        pose: _Numbers = self.poses[self._rigid(body)]
        return pose

    def velocity(self, body: str) -> _Numbers:
        """Of a rigid body as a row of `twists` [6]; of another that of each node [n, 3]. m/s, rad/s, world"""
        if find("body", body, self.facts.bodies).is_rigid:
            twist: _Numbers = self.twists[self._rigid(body)]
            return twist
        velocities: _Numbers = self.velocities[self._rows_of(body)]
        return velocities

    def joint(self, name: str) -> float:
        """Position of a joint [rad or m]."""
        return float(self.joints[self.facts.joints.index(find("joint", name, self.facts.joints))])

    # ---- what acts

    def contacts(self) -> Contacts:
        """What touched in the last step; none before the first."""
        return Contacts.of(self.facts, self._ask("contacts"))

    def forces(self) -> Forces:
        """What contacts and joints did to the bodies in the last step; none before the first."""
        return Forces.of(self.facts, self._ask("forces"))

    def intersection(self) -> str:
        """Bodies whose surfaces intersect now, by an exact test of its own, such as "cube and floor"; empty: none."""
        head, _ = self._answer({"do": "intersection"})
        return str(head["bodies"])

    def render(self, camera: str = "") -> NDArray[np.uint8]:
        """What a camera sees now, the first one where none is named; scenes without cameras have one named `overview`.
        It lasts, and is read-only. [height, width, 3], sRGB"""
        cameras = self.facts.cameras
        camera = camera or next(iter(cameras))
        if camera not in cameras:
            raise ValueError(f"the scene has no camera `{camera}`; it has {', '.join(cameras)}")
        head, data = self._answer({"do": "observe", "pictures": [camera]})
        return read_array(head["arrays"][0], data, None)

    # ---- how it is asked

    def _rigid(self, body: str) -> int:
        found = find("body", body, self.facts.bodies)
        if not found.is_rigid:
            raise ValueError(f"{body}, of kind {found.kind}, has no pose; ask nodes('{body}')")
        return self.facts.bodies.index(found)  # rigid bodies come first

    def _rows_of(self, body: str) -> slice:
        found = find("body", body, self.facts.bodies)
        if found.is_rigid:
            raise ValueError(f"{body}, of kind {found.kind}, has no nodes; ask pose('{body}')")
        first = sum(before.n_nodes for before in self.facts.bodies[: self.facts.bodies.index(found)])
        return slice(first, first + found.n_nodes)

    def _state(self) -> _Arrays:
        return self._ask("state")

    def _answer(self, request: Mapping[str, Any]) -> tuple[dict[str, Any], bytes]:
        head, data = self._connection.request(request)
        if "error" in head:
            raise ServeError(head["error"])
        return head, data

    def _ask(self, do: str) -> _Arrays:
        if do in self._known:
            return self._known[do]
        memory: SharedMemory | None = None
        request = {"do": do}
        if self._connection.is_process:
            if do not in self._memory:
                self._memory[do] = SharedMemory(_FIRST_BYTES)
            memory = self._memory[do]
            request["memory"] = memory.path
        head, data = self._connection.request(request)
        if memory and "error" in head and "bytes" in head:  # that it takes
            memory.resize(head["bytes"])
            head, data = self._connection.request(request)
        if "error" in head:
            raise ServeError(head["error"])
        arrays = {array["name"]: read_array(array, data, memory) for array in head["arrays"]}
        for letter in ("X_", "V_") if do == "state" else ():
            # those of all bodies lie one after the other, and so are one array
            rows = [array for array in head["arrays"] if array["name"].startswith((letter + "gripper/", letter + "deform/"))]
            n_nodes = sum(array["shape"][0] for array in rows)
            first = rows[0] if rows else {"type": "<f8", "offset": 0}
            arrays[letter] = read_array({**first, "shape": [n_nodes, 3]}, data, memory)
        self._known[do] = arrays
        return arrays

    def close(self) -> None:
        """Ends the program. Views that were taken stay readable."""
        self._connection.close()
        for memory in self._memory.values():
            memory.close()
        self._memory = {}

    def __enter__(self) -> Simulation:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
