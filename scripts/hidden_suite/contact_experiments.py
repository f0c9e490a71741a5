"""The experiments with bodies that spin, roll and hit: what the simulator is told, what was done and measured. See
experiments.py."""
import numpy as np

import contact_models
from experiments import Cases, Experiment

WHIRL = """schema: 1
name: whirl
time_step: 5 ms
duration: 0.8 s
bodies:
  - {name: ball, kind: rigid, shape: {sphere: {radius: 0.05, subdivisions: 2}}, mass: 0.2, inertia: [2e-4, 2e-4, 2e-4], collides: false}
"""
ROLL = """schema: 1
name: roll
time_step: 2 ms
duration: 1 s
solver: {integrator: bdf2}
contact: {activation_distance: 2 mm, stiffness: 10 kPa, friction_velocity: 1e-3}
bodies:
  - {name: floor, kind: half_space, normal: [0, 0, 1]}
  - {name: wheel, kind: rigid, shape: {cylinder: {radius: 0.05, length: 0.04, sides: 64}}, mass: 0.2,
     inertia: [1.5e-4, 1.5e-4, 2.5e-4], pose: {position: [0, 0, 0.0514], rotation: [90 deg, 0, 0]}}
pair_friction:
  - {first: floor, second: wheel, coefficient: 0.3}
"""
PLACE, TURN = 5e-4, 1e-2  # noise [m], [rad]
ALONG = 1e-3  # of the wheel's place [m]


def contact_experiments():
    return {
        "whirl": Experiment(
            "whirl", contact_models.Whirl(), WHIRL,
            [((0, 0, 1, 1, 0, 3, 0, 20, 0), 0.6, None, "fit"), ((0, 0, 1, 0, 2, 3, 10, 5, -5), 0.6, None, "fit"),
             ((0, 0, 1, 2, -1, 3, -8, 0, 12), 0.6, None, "held_out")],
            ["x", "y", "z", "qx", "qy", "qz", "qw"],
            [f"{{columns: [x, y, z], kind: position, body: ball, unit: m, noise: {PLACE}}}",
             f"{{columns: [qx, qy, qz, qw], kind: orientation, body: ball, noise: {TURN}}}"],
            np.array([PLACE] * 3 + [TURN] * 3), "ball", "ball", ["free"]),
        "roll": Experiment(
            "roll", contact_models.Wheel(), ROLL,
            [((0, 0.8), 0.8, None, "fit"), ((0.1, -0.5), 0.8, None, "fit"), ((-0.1, 0.65), 0.8, None, "held_out")],
            ["x"], [f"{{column: x, kind: position, body: wheel, axis: [1, 0, 0], unit: m, noise: {ALONG}}}"], ALONG,
            "wheel/floor", "wheel", ["slide", "roll", "stick"]),
    }


CONTACT = Cases(
    singles=[
        ("whirl", "spin_drag", None, {"drag": 1e-4}, []),
        ("whirl", "center_of_mass_offset", None, {"x": 2e-3, "y": -1e-3, "z": 1e-3}, []),
        ("whirl", "quadratic_drag", None, {"drag": 0.01}, []),
        ("roll", "rolling_resistance", None, {"arm": 1e-4}, []),
        ("roll", "quadratic_drag", "wheel", {"drag": 0.05}, []),
    ],
    retunes=[("roll", "retune_friction", None, {"value": 0.03}, 0.3, [])],
    off_library=[("roll", "felt", {"arm": 1e-3})],
    pairs=[],
)
