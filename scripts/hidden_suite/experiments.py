"""The experiments of the hidden-effect suite: what the simulator is told (a scene), what was done and measured (runs and
channels), and the independent model that stands for nature.
"""
import math
from collections import namedtuple

import models

RATE = 100.0  # samples per second

PENDULUM = """schema: 1
name: pendulum
time_step: 5 ms
duration: 2.5 s
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: cube, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 1, pose: {position: [0, 0, -0.2]}, collides: false}
joints:
  - {name: hinge, type: revolute, parent: base, child: cube, axis: [0, 1, 0]}
"""
FLIGHT = """schema: 1
name: flight
time_step: 5 ms
duration: 0.9 s
bodies:
  - {name: ball, kind: rigid, shape: {sphere: {radius: 0.05, subdivisions: 2}}, mass: 0.2, collides: false}
"""
SLIDE = """schema: 1
name: slide
time_step: 5 ms
duration: 1.2 s
contact: {activation_distance: 0.1 mm, stiffness: 10 MPa, friction_velocity: 1e-3}
bodies:
  - {name: floor, kind: half_space, normal: [0, 0, 1]}
  - {name: block, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.04]}}, mass: 0.4, pose: {position: [0, 0, 0.02009]}}
pair_friction:
  - {first: floor, second: block, coefficient: 0.3}
"""
DRIVEN = """schema: 1
name: driven_joint
time_step: 5 ms
duration: 3 s
gravity: [0, 0, 0]
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: arm, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 1, pose: {position: [0.15, 0, 0]}, collides: false}
joints:
  - {name: shoulder, type: revolute, parent: base, child: arm, axis: [0, 0, 1], drive: {stiffness: 20, damping: 0.6, target: 0}}
"""


def chirp(amplitude, low, high, length):
    return lambda t: amplitude * math.sin(2 * math.pi * (low + (high - low) * t / length / 2) * t) if t > 0 else 0.0


def steps(levels, hold, rise=0.1):
    """Levels one after the other, with smooth rises."""

    def command(t):
        if t <= 0:
            return levels[0]
        i = min(int(t / hold), len(levels) - 1)
        before = levels[i - 1] if i > 0 else levels[0]
        s = min((t - i * hold) / rise, 1.0)
        return before + (levels[i] - before) * s * s * (3 - 2 * s)

    return command


def slow(amplitude, period):
    return lambda t: amplitude * (1 - math.cos(2 * math.pi * max(t, 0) / period)) / 2


def as_recorded(command, length, rate):
    """The command that the drive is given: straight lines between the samples that the recording has."""
    samples = [command(k / rate) for k in range(int(length * rate) + 2)]

    def lines(t):
        k = min(max(math.floor(t * rate), 0), len(samples) - 2)
        return samples[k] + (samples[k + 1] - samples[k]) * min(max(t * rate - k, 0.0), 1.0)

    return lines


class Experiment:
    """A model, its scene, its runs (start, length, command, role) and its channels."""

    def __init__(self, name, model, scene, runs, columns, channels, noise, target, body, phases, command=None, rate=RATE,
                 initial="first_sample", files=None):
        """command: target, its columns, which of them is commanded (the others are zero); rate: samples per second;
        files: what the scene names, by name."""
        self.name, self.model, self.scene, self.columns = name, model, scene, columns
        self.runs = [(start, length, command and as_recorded(command, length, rate), role) for start, length, command, role in runs]
        self.rate, self.initial, self.files = rate, initial, files or {}
        self.channels, self.noise, self.target, self.body, self.phases = channels, noise, target, body, phases
        self.command = command
        self.unchanged = None  # what change_of compares with, once it is known


def experiments():
    return {
        "pendulum": Experiment(
            "pendulum", models.Pendulum(), PENDULUM,
            [((1.0, 0.0), 2.5, None, "fit"), ((0.4, 0.0), 2.5, None, "fit"), ((-0.7, 2.0), 2.5, None, "fit"),
             ((1.4, -1.0), 2.5, None, "held_out")],
            ["q"], ["{column: q, kind: position, joint: hinge, unit: rad, noise: 0.001}"], 1e-3, "hinge", "cube", ["free"]),
        "flight": Experiment(
            "flight", models.Flight(), FLIGHT,
            [((0, 0, 1, 4, 0, 3), 0.8, None, "fit"), ((0, 0, 1, 0, 8, 2), 0.8, None, "fit"), ((0.2, 0, 2, -2, -1, 0), 0.8, None, "fit"),
             ((0, 0.2, 1, 6, -4, 4), 0.9, None, "held_out")],
            ["x", "y", "z"], ["{columns: [x, y, z], kind: position, body: ball, unit: m, noise: 0.001}"], 1e-3, "ball", "ball", ["free"]),
        "slide": Experiment(
            "slide", models.Slide(), SLIDE,
            [((0, 0, 1.0, 0), 0.7, None, "fit"), ((0, 0, 0, 1.6), 0.9, None, "fit"), ((0, 0, -0.5, -0.5), 0.6, None, "fit"),
             ((0, 0, 1.4, -1.2), 1.0, None, "held_out")],
            ["x", "y", "z"], ["{columns: [x, y, z], kind: position, body: block, unit: m, noise: 0.0005}"], 5e-4, "floor/block", "block", ["slide", "stick", "rest"]),
        "driven": Experiment(
            "driven", models.DrivenJoint(), DRIVEN,
            [((0, 0), 3.0, chirp(0.4, 0.3, 3.0, 3.0), "fit"), ((0, 0), 3.0, steps([0, 0.5, -0.3, 0.2], 0.75), "fit"),
             ((0, 0), 3.0, slow(0.6, 1.5), "fit"), ((0, 0), 3.0, steps([0, -0.6, 0.4, 0.0], 0.7, 0.2), "held_out")],
            ["q"], ["{column: q, kind: position, joint: shoulder, unit: rad, noise: 0.001}"], 1e-3, "shoulder", "arm", ["driven"],
            ("joint/shoulder/position", ["command"], 0)),
    }


# singles: experiment, effect's name, target (None: the experiment's), parameters at unit strength, what else says the same;
# retunes: likewise, with the scene's number before the last; off_library: without target; pairs: experiment, its effects
Cases = namedtuple("Cases", "singles retunes off_library pairs")
SINGLES = [
    ("pendulum", "joint_viscous_friction", None, {"damping": 1e-2}, ["linear_drag", "mass_proportional_damping"]),
    ("pendulum", "joint_coulomb_friction", None, {"effort": 1e-2}, []),
    ("pendulum", "joint_stribeck_friction", None, {"effort": 5e-3, "extra": 1e-2, "stribeck_velocity": 0.5}, []),
    ("pendulum", "joint_spring", None, {"stiffness": 0.05, "preload": 0.02}, []),
    ("pendulum", "center_of_mass_offset", "cube", {"x": 2e-3, "y": 0, "z": 3e-3}, []),
    ("pendulum", "quadratic_drag", "cube", {"drag": 0.1}, []),
    ("pendulum", "bias", None, {"x": 1e-2}, ["gravity_tilt", "center_of_mass_offset", "joint_spring"]),
    ("pendulum", "clock_rate", None, {"rate": 1e-3}, ["retune_gravity"]),
    ("flight", "linear_drag", "ball", {"drag": 0.02}, ["mass_proportional_damping"]),
    ("flight", "quadratic_drag", "ball", {"drag": 0.005}, []),
    ("flight", "constant_force", "ball", {"x": 0.02, "y": -0.03, "z": 0}, ["gravity_tilt"]),
    ("flight", "gravity_tilt", "scene", {"about_x": 0.01, "about_y": 0.02}, ["constant_force"]),
    ("flight", "length_scale", None, {"scale": 5e-3}, ["retune_gravity", "clock_rate"]),
    ("slide", "velocity_dependent_friction", None, {"change": 0.3, "velocity": 0.1}, []),
    ("slide", "anisotropic_friction", None, {"change": 0.2}, []),
    ("slide", "quadratic_drag", "block", {"drag": 0.05}, []),
    ("slide", "gravity_tilt", "scene", {"about_x": 0.01, "about_y": 0.01}, ["constant_force"]),
    ("driven", "joint_viscous_friction", None, {"damping": 0.02}, ["linear_drag", "mass_proportional_damping"]),
    ("driven", "joint_coulomb_friction", None, {"effort": 0.05}, []),
    ("driven", "joint_stribeck_friction", None, {"effort": 0.02, "extra": 0.05, "stribeck_velocity": 0.3}, []),
    ("driven", "backlash", None, {"play": 0.01}, []),
    ("driven", "joint_spring", None, {"stiffness": 0.3, "preload": 0.1}, []),
    ("driven", "actuator_lag", None, {"time_constant": 0.005}, []),
    ("driven", "actuator_delay", None, {"delay": 0.005}, ["clock_offset"]),
    ("driven", "actuator_gain", None, {"gain": 0.1}, ["retune_mass"]),
    ("driven", "payload_mass", "arm", {"mass": 0.1}, ["retune_mass"]),
    ("driven", "bias", None, {"x": 1e-2}, ["joint_spring"]),
]
RETUNES = [
    ("pendulum", "retune_gravity", "scene", {"value": 0.3}, models.G, ["clock_rate"]),
    ("flight", "retune_gravity", "scene", {"value": 0.3}, models.G, []),
    ("slide", "retune_friction", None, {"value": 0.03}, 0.3, []),
    ("driven", "retune_drive_stiffness", None, {"value": 3.0}, 20.0, []),
    ("driven", "retune_drive_damping", None, {"value": 0.1}, 0.6, []),
    ("driven", "retune_mass", "arm", {"value": 0.1}, 1.0, ["payload_mass", "actuator_gain"]),
]
OFF_LIBRARY = [
    ("pendulum", "magnet", {"strength": 0.5}),
    ("flight", "vortex", {"strength": 0.1}),
    ("flight", "tether", {"stiffness": 1.0, "length": 1.5}),
    ("slide", "rough_strip", {"extra": 0.3}),
    ("flight", "magnus", {"lift": 0.01}),
    ("driven", "cogging", {"strength": 0.2}),
    ("driven", "bumper", {"stiffness": 5.0}),
]
PAIRS = [
    ("pendulum", [("joint_viscous_friction", "hinge", {"damping": 1e-2}), ("joint_spring", "hinge", {"stiffness": 0.05, "preload": 0.02})]),
    ("pendulum", [("joint_coulomb_friction", "hinge", {"effort": 1e-2}), ("center_of_mass_offset", "cube", {"x": 3e-3, "y": 0, "z": 3e-3})]),
    ("flight", [("quadratic_drag", "ball", {"drag": 0.005}), ("constant_force", "ball", {"x": 0.03, "y": -0.02, "z": 0})]),
    ("driven", [("backlash", "shoulder", {"play": 0.02}), ("joint_viscous_friction", "shoulder", {"damping": 0.03})]),
    ("driven", [("joint_coulomb_friction", "shoulder", {"effort": 0.05}), ("actuator_delay", "shoulder", {"delay": 0.01})]),
    ("pendulum", [("quadratic_drag", "cube", {"drag": 0.1}), ("joint_spring", "hinge", {"stiffness": 0.05, "preload": 0.02})]),
    ("pendulum", [("joint_viscous_friction", "hinge", {"damping": 1e-2}), ("bias", "hinge", {"x": 1e-2})]),
    ("flight", [("linear_drag", "ball", {"drag": 0.02}), ("gravity_tilt", "scene", {"about_x": 0.01, "about_y": 0.02})]),
    ("slide", [("anisotropic_friction", "floor/block", {"change": 0.2}), ("gravity_tilt", "scene", {"about_x": 0.01, "about_y": 0.01})]),
    ("driven", [("joint_viscous_friction", "shoulder", {"damping": 0.04}), ("payload_mass", "arm", {"mass": 0.1})]),
    ("driven", [("backlash", "shoulder", {"play": 0.02}), ("actuator_lag", "shoulder", {"time_constant": 0.005})]),
    ("driven", [("joint_spring", "shoulder", {"stiffness": 0.6, "preload": 0.2}), ("actuator_delay", "shoulder", {"delay": 0.005})]),
]
RIGID = Cases(SINGLES, RETUNES, OFF_LIBRARY, PAIRS)
