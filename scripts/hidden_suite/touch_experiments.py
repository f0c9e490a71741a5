"""The experiments with a plate on a soft floor, dropped or pulled off: what the simulator is told, what was done and measured.
See experiments.py."""
import models
from experiments import Cases, Experiment, steps
from touch_models import Plate

PLATE = """schema: 1
name: {name}
time_step: 1 ms
duration: 1 s
solver: {{integrator: bdf2}}
contact: {{activation_distance: {distance}, stiffness: {stiffness}}}
bodies:
  - {{name: floor, kind: half_space, normal: [0, 0, 1]}}
  - {{name: frame, kind: static, shape: {{box: {{size: [0.01, 0.01, 0.01]}}}}, collides: false}}
  - {{name: plate, kind: rigid, shape: {{box: {{size: [0.1, 0.1, 0.01]}}}}, mass: 0.4, pose: {{position: [0, 0, {height}]}}}}
joints:
  - {{name: guide, type: prismatic, parent: frame, child: plate, axis: [0, 0, 1]{drive}}}
"""
NOISE = 3e-4
CHANNEL = [f"{{column: q, kind: position, joint: guide, unit: m, noise: {NOISE}}}"]
SPRING, DAMPER = 300, 10  # that pull [N/m, N s/m]
REST = 0.928e-3  # gap at which the weight rests in a floor of 1 mm and 20 kPa


def touch_experiments():
    drop = PLATE.format(name="drop", distance="20 mm", stiffness=2000, height=0.025, drive="")
    pull = PLATE.format(name="pull", distance="1 mm", stiffness=20000, height=0.005 + REST,
                        drive=f", drive: {{stiffness: {SPRING}, damping: {DAMPER}, target: 0}}")
    return {
        "drop": Experiment(
            "drop", Plate(0.02, 2000, 0.02), drop,
            [((0.12, 0.0), 0.8, None, "fit"), ((0.02, 0.0), 0.8, None, "fit"), ((0.06, -0.3), 0.8, None, "held_out")],
            ["q"], CHANNEL, NOISE, "floor/plate", "plate", ["impact", "free", "stick", "slide"]),
        "pull": Experiment(
            "pull", Plate(1e-3, 20000, REST, SPRING, DAMPER), pull,
            [((), 0.8, steps([0, 0.03], 0.1, 0.6), "fit"), ((), 0.8, steps([0, -0.01, 0.02, 0.02], 0.15, 0.1), "fit"),
             ((), 0.8, steps([0, 0.025, -0.01, 0.03], 0.2, 0.15), "held_out")],
            ["q"], CHANNEL, NOISE, "floor/plate", "plate", ["impact", "driven", "stick", "rest"], ("joint/guide/position", ["pull"], 0),
            initial="{joint/guide/position: 0, joint/guide/velocity: 0}"),
    }


STIFFER = ["retune_mass", "payload_mass"]  # only their ratio counts
TOUCH = Cases(
    singles=[
        ("drop", "contact_dissipation", None, {"dissipation": 0.1}, []),
        ("drop", "joint_viscous_friction", "guide", {"damping": 0.1}, ["linear_drag", "mass_proportional_damping"]),
        ("drop", "joint_coulomb_friction", "guide", {"effort": 0.1}, []),
        ("drop", "quadratic_drag", "plate", {"drag": 0.1}, []),
        ("pull", "adhesion", None, {"energy": 0.02}, []),
    ],
    retunes=[
        ("drop", "retune_contact_stiffness", "scene", {"value": 200}, 2000, STIFFER),
        ("drop", "retune_gravity", "scene", {"value": 0.3}, models.G, []),
        ("pull", "retune_mass", "plate", {"value": 0.02}, 0.4, ["payload_mass", "retune_gravity", "constant_force"]),
    ],
    off_library=[("drop", "tether", {"stiffness": 5.0})],
    pairs=[],
)
