"""The experiments that two sensors look at: an encoder at a joint and a marker on the arm, which a camera follows. What is
wrong may be one of them: late, turned, or fastened elsewhere. See experiments.py.
"""
import numpy as np

import models
from experiments import DRIVEN, PENDULUM, Cases, Experiment, chirp, slow, steps

NOISE = 5e-4  # [rad], [m]
BEFORE = 0.1  # that a swing has gone on for when its recording begins [s]: what is late, too, shows a motion there
MARKER = [0.04, 0.02, 0.05]  # of the arm's frame
COLUMNS = ["q", "m_x", "m_y", "m_z"]


def turned(vectors, by):
    """Vectors [n, 3] turned by a rotation vector: x cos a + (u cross x) sin a + u (u . x) (1 - cos a), Rodrigues."""
    angle = np.linalg.norm(by)
    if angle == 0:
        return vectors
    u = np.asarray(by) / angle
    return vectors * np.cos(angle) + np.cross(u, vectors) * np.sin(angle) + np.outer(vectors @ u, u) * (1 - np.cos(angle))


class Watched:
    """A body on a hinge as an encoder and a camera see it; seen: its angle, the marker's place. Effects of the sensors: one
    is late, the marker sits elsewhere on the body, the camera's frame is turned."""

    def __init__(self, model, axis, centre, before, late):
        """model: its first column is the angle; axis: of the hinge, at the origin; centre: of the body's frame at angle 0;
        late: which sensor may be, 0 the encoder, 1 the camera."""
        self.model, self.axis, self.centre, self.before, self.late = model, np.array(axis), np.array(centre), before, late

    def see(self, start, times, effects, command=None):
        delay = effects.get("latency", {}).get("latency", 0)
        angle, seen_angle = (
            self.model.see(start, np.maximum(times + self.before - (delay if self.late == sensor else 0), 0), effects, command)[:, 0]
            for sensor in (1, 0))
        offset, turn = (effects.get(name, {"x": 0, "y": 0, "z": 0}) for name in ("marker_offset", "frame_misalignment"))
        arm = self.centre + MARKER + [offset["x"], offset["y"], offset["z"]]
        marker = np.vstack([turned(arm[None], q * self.axis) for q in angle])
        return np.column_stack([seen_angle, turned(marker, [turn["x"], turn["y"], turn["z"]])])


def channels(joint, body):
    return [f"{{column: q, kind: position, joint: {joint}, unit: rad, noise: {NOISE}}}",
            f"{{columns: [m_x, m_y, m_z], kind: marker, body: {body}, point: {MARKER}, unit: m, noise: {NOISE}}}"]


def sensor_experiments():
    return {
        "watched": Experiment(
            "watched", Watched(models.DrivenJoint(), [0, 0, 1], [0.15, 0, 0], 0, late=1), DRIVEN,
            [((0, 0), 2.0, chirp(0.4, 0.3, 3.0, 2.0), "fit"), ((0, 0), 2.0, steps([0, 0.5, -0.3, 0.2], 0.5), "fit"),
             ((0, 0), 2.0, slow(0.6, 1.0), "held_out")],
            COLUMNS, channels("shoulder", "arm"), NOISE, "m_x", "arm", ["driven"], ("joint/shoulder/position", ["command"], 0)),
        "tracked": Experiment(
            "tracked", Watched(models.Pendulum(), [0, 1, 0], [0, 0, -0.2], BEFORE, late=0), PENDULUM,
            [((1.0, 0.0), 1.5, None, "fit"), ((-0.7, 2.0), 1.5, None, "fit"), ((1.4, -1.0), 1.5, None, "held_out")],
            COLUMNS, channels("hinge", "cube"), NOISE, "m_x", "cube", ["free"]),
    }


OFFSET = {"x": 3e-3, "y": -2e-3, "z": 4e-3}
TURN = {"x": 0.01, "y": -0.02, "z": 0.015}
SENSOR = Cases(
    singles=[
        ("watched", "latency", "m_x", {"latency": 5e-3}, []),
        ("watched", "marker_offset", "m_x", OFFSET, []),
        ("watched", "frame_misalignment", "recording", TURN, []),
        ("watched", "joint_coulomb_friction", "shoulder", {"effort": 0.05}, []),
        ("tracked", "latency", "q", {"latency": 5e-3}, []),
        ("tracked", "marker_offset", "m_x", OFFSET, []),
        ("tracked", "frame_misalignment", "recording", TURN, []),
    ],
    retunes=[("watched", "retune_mass", "arm", {"value": 0.1}, 1.0, ["payload_mass", "actuator_gain"])],
    off_library=[],
    pairs=[("watched", [("latency", "m_x", {"latency": 5e-3}), ("joint_coulomb_friction", "shoulder", {"effort": 0.05})])],
)
