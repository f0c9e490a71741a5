"""What a served scene is, what touches in it and which forces act, as typed data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Sequence, TypeVar

import numpy as np
from numpy.typing import NDArray

from .connection import ServeError

__all__ = ["Body", "Contacts", "Forces", "Joint", "SceneFacts"]


@dataclass(frozen=True)
class Body:
    name: str
    kind: str  # rigid, static, moving, half_space, soft or cloth
    n_nodes: int  # of a soft body or cloth; 0 of a rigid one

    @property
    def is_rigid(self) -> bool:
        """It has a pose: moving freely, as told or not at all."""
        return self.kind not in ("soft", "cloth")


@dataclass(frozen=True)
class Joint:
    name: str
    type: str  # fixed, revolute, prismatic or spherical
    parent: str
    child: str
    drive: str | None  # what its targets are: position, velocity or torque


_Named = TypeVar("_Named", Body, Joint)


def find(kind: str, name: str, known: Sequence[_Named]) -> _Named:
    for each in known:
        if each.name == name:
            return each
    raise ValueError(f"the scene has no {kind} `{name}`; it has {', '.join(each.name for each in known) or 'none'}")


@dataclass(frozen=True)
class SceneFacts:
    """What never changes of a scene."""

    scene: str
    program: str
    time_step: float  # [s]
    duration: float  # for which the scene file says what drives are told [s]; steps may go on
    gravity: tuple[float, float, float]  # [m/s^2]
    bodies: tuple[Body, ...]  # rigid ones first, then soft ones, then cloths
    joints: tuple[Joint, ...]
    driven: tuple[str, ...]  # joints with a drive, the columns of targets
    cameras: dict[str, tuple[int, int]]  # (width, height) [pixels]

    @classmethod
    def read(cls, head: Mapping[str, Any]) -> SceneFacts:
        if "task" in head:
            raise ServeError(f"{head['task']} is a task; step it with phyvisgen.Server")
        x, y, z = head["gravity"]
        return cls(
            head["scene"],
            head["program"],
            head["time_step"],
            head["duration"],
            (x, y, z),
            tuple(Body(body["name"], body["kind"], body["nodes"]) for body in head["bodies"]),
            tuple(Joint(*(joint[key] for key in ("name", "type", "parent", "child", "drive"))) for joint in head["joints"]),
            tuple(head["driven"]),
            {camera["name"]: (camera["width"], camera["height"]) for camera in head["cameras"]},
        )


@dataclass(frozen=True)
class Contacts:
    """What touched in a step: n contacts of surfaces, whose forces act on the first body, the opposite on the second."""

    facts: SceneFacts
    bodies: NDArray[np.int64]  # [n, 2], of facts.bodies
    kind: NDArray[np.int64]  # [n], 0 point-triangle, 1 edge-edge, 2 point-plane
    points: NDArray[np.float64]  # [n, 3], midway between the closest points, world [m]
    normal: NDArray[np.float64]  # [n, 3], unit, from the second body to the first
    gap: NDArray[np.float64]  # [n], m
    normal_force: NDArray[np.float64]  # [n], N, >= 0
    friction_force: NDArray[np.float64]  # [n, 3], N
    pair_bodies: NDArray[np.int64]  # [m, 2], pairs of bodies that touch
    pair_normal: NDArray[np.float64]  # [m, 3], N, sum of the pair's normal forces on its first body
    pair_friction: NDArray[np.float64]  # [m, 3], N, likewise of friction

    @classmethod
    def of(cls, facts: SceneFacts, arrays: Mapping[str, NDArray[Any]]) -> Contacts:
        names = ("bodies", "kind", "points", "normal", "gap", "normal_force", "friction_force")
        pairs = ("bodies", "normal", "friction")
        return cls(facts, *(arrays[f"contact/{name}"] for name in names), *(arrays[f"pair_force/{name}"] for name in pairs))

    def __len__(self) -> int:
        return len(self.gap)

    def between(self, first: str, second: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Sums of the normal and of the friction forces that `second` exerts on `first`. [3] each, N, world; zero where
        they do not touch"""
        a, b = (self.facts.bodies.index(find("body", name, self.facts.bodies)) for name in (first, second))
        for bodies, normal, friction in zip(self.pair_bodies, self.pair_normal, self.pair_friction):
            if tuple(bodies) == (a, b):
                return normal.copy(), friction.copy()
            if tuple(bodies) == (b, a):
                return -normal, -friction
        return np.zeros(3), np.zeros(3)


@dataclass(frozen=True)
class Forces:
    """What contacts do to bodies, and what joints transmit."""

    facts: SceneFacts
    force: NDArray[np.float64]  # [n_bodies, 3], N, world: sum of all contacts on each body
    moment: NDArray[np.float64]  # [n_bodies, 3], N m, world; about the centre of mass, of a soft body the mean of its nodes
    drive: NDArray[np.float64]  # [n_joints], effort of the drive along the joint [N m or N]
    stop: NDArray[np.float64]  # [n_joints], of the stops
    damping: NDArray[np.float64]  # [n_joints], of the joint's own damping
    joint_force: NDArray[np.float64]  # [n_joints, 3], N: of the child on the parent, in the joint frame on the child
    joint_moment: NDArray[np.float64]  # [n_joints, 3], N m, likewise, about the joint frame's origin; NaN of prismatic joints

    @classmethod
    def of(cls, facts: SceneFacts, arrays: Mapping[str, NDArray[Any]]) -> Forces:
        of_joint = ("drive", "stop", "damping", "load_force", "load_torque")
        return cls(facts, arrays["force/net"], arrays["force/torque"], *(arrays[f"joint/{name}"] for name in of_joint))

    def on(self, body: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Force [3, N] and moment [3, N m] of all contacts on a body, world."""
        index = self.facts.bodies.index(find("body", body, self.facts.bodies))
        return self.force[index], self.moment[index]

    def in_joint(self, joint: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Force [3, N] and moment [3, N m] of a joint's child on its parent, along the axes of the joint frame on the
        child; a moment about the axis of a revolute joint is its drive's and no part of it. NaN of a prismatic joint."""
        index = self.facts.joints.index(find("joint", joint, self.facts.joints))
        return self.joint_force[index], self.joint_moment[index]
