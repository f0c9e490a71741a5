"""The experiments with soft bodies and cloth: what the simulator is told, what is done and measured. See experiments.py."""
import soft_models
from experiments import Cases, Experiment, chirp, slow, steps

BAR = """schema: 1
name: {name}
time_step: 10 ms
duration: 1 s
solver: {{velocity_tolerance: 1e-5}}
bodies:
  - {{name: hand, kind: moving, shape: {{box: {{size: [0.05, 0.05, 0.01]}}}}, collides: false, path: [{{time: 0, position: [0, 0, 0]}}]}}
  - {{name: frame, kind: static, shape: {{box: {{size: [0.01, 0.01, 0.01]}}}}, collides: false}}
  - {{name: weight, kind: rigid, shape: {{box: {{size: [0.04, 0.04, 0.02]}}}}, mass: {weight}, pose: {{position: [0, 0, {end}]}}, collides: false}}
  - name: bar
    kind: soft
    shape: {{bar: {{size: [0.1, {width}, {width}], divisions: [4, 1, 1], nodes_per_element: 4}}}}
    pose: {{position: [0, 0, {middle}], rotation: [0, {turn}, 0]}}
    material: {{density: 1000, youngs_modulus: 100 kPa, poisson_ratio: 0}}
joints:
  - {{name: guide, type: prismatic, parent: frame, child: weight, axis: [0, 0, 1]}}
stitches:  # the bar may grow thinner at its ends, too
  - {{soft: bar, rigid: hand, low: [-0.0501, -1, -1], high: [-0.0499, 1, 1], stiffness: 1e7, direction: [0, 0, 1]}}
  - {{soft: bar, rigid: hand, low: [-0.0501, -1, -1], high: [-0.0499, 1, 1], stiffness: 10, direction: [1, 0, 0]}}
  - {{soft: bar, rigid: hand, low: [-0.0501, -1, -1], high: [-0.0499, 1, 1], stiffness: 10, direction: [0, 1, 0]}}
  - {{soft: bar, rigid: weight, low: [0.0499, -1, -1], high: [0.0501, 1, 1], stiffness: 1e7, direction: [0, 0, 1]}}
  - {{soft: bar, rigid: weight, low: [0.0499, -1, -1], high: [0.0501, 1, 1], stiffness: 10, direction: [1, 0, 0]}}
  - {{soft: bar, rigid: weight, low: [0.0499, -1, -1], high: [0.0501, 1, 1], stiffness: 10, direction: [0, 1, 0]}}
"""
SWING = """schema: 1
name: swing
time_step: 10 ms
duration: 1 s
solver: {velocity_tolerance: 1e-5}
bodies:
  - {name: hand, kind: moving, shape: {box: {size: [0.02, 0.06, 0.02]}}, collides: false, path: [{time: 0, position: [0, 0, 0]}]}
cloths:
  - name: strip
    shape: {sheet: {size: [0.3, 0.04], divisions: [16, 1]}}
    pose: {z: -0.15, pitch: 90 deg}
    material: {area_density: 0.3, thickness: 1 mm, stretch: 2000, shear: 200, bending: 1.5e-5}
stitches:
  - {cloth: strip, rigid: hand, low: [-0.1501, -1, -1], high: [-0.1499, 1, 1], stiffness: 1e4}
"""


def markers(body, end, middle, noise):
    return [f"{{columns: [{name}_x, {name}_y, {name}_z], kind: marker, body: {body}, point: [{x}, 0, 0], unit: m, noise: {noise}}}"
            for name, x in (("end", end), ("middle", middle))]


COLUMNS = [f"{name}_{axis}" for name in ("end", "middle") for axis in "xyz"]


def bar(name, side, width, weight):
    scene = BAR.format(name=name, weight=weight, width=width, end=side * 0.11, middle=side * 0.05, turn="90 deg" if side < 0 else "-90 deg")
    return Experiment(
        name, soft_models.Bar(side, width, weight), scene,
        [((), 1.0, steps([0, 0], 1), "fit"), ((), 1.0, steps([0, 0.015, -0.005], 0.5), "fit"), ((), 1.0, chirp(0.003, 1, 4, 1.5), "fit"),
         ((), 1.0, steps([0, -0.01, 0.01, 0.0], 0.35, 0.12), "held_out")],
        COLUMNS, markers("bar", 0.05, 0, 2e-4), 2e-4, "bar", "bar", ["driven", "free"], ("body/hand/position", ["hand_x", "hand_y", "hand_z"], 2))


def soft_experiments():
    return {
        "hanging": bar("hanging", -1, 0.02, 0.3),
        "standing": bar("standing", 1, 0.03, 0.6),
        "swing": Experiment(
            "swing", soft_models.Swing(), SWING,
            [((), 1.0, steps([0, 0.03, 0.0], 0.5, 0.25), "fit"), ((), 1.0, chirp(0.006, 0.5, 3, 1.5), "fit"), ((), 1.0, slow(-0.03, 0.9), "fit"),
             ((), 1.0, steps([0, -0.035, 0.01], 0.6, 0.3), "held_out")],
            COLUMNS, markers("strip", 0.15, 0, 1e-3), 1e-3, "strip", "strip", ["driven", "free"],
            ("body/hand/position", ["hand_x", "hand_y", "hand_z"], 0)),
    }


BRAKES = ["linear_drag", "mass_proportional_damping", "joint_viscous_friction"]  # the same of a motion that is nearly one mode
SOFT = Cases(
    singles=[
        ("hanging", "kelvin_voigt_damping", None, {"viscosity": 30.0}, []),
        ("hanging", "hysteretic_damping", None, {"loss": 0.03}, []),
        ("hanging", "strain_stiffening", None, {"stiffening": 1.0}, []),
        ("hanging", "creep", None, {"rate": 0.05}, []),
        ("hanging", "joint_viscous_friction", "guide", {"damping": 0.1}, BRAKES),
        ("hanging", "joint_coulomb_friction", "guide", {"effort": 0.05}, []),
        ("standing", "plastic_yield", None, {"yield_strain": 0.1}, []),
        ("standing", "creep", None, {"rate": 0.05}, []),
        ("standing", "kelvin_voigt_damping", None, {"viscosity": 30.0}, []),
        ("swing", "mass_proportional_damping", None, {"rate": 0.3}, ["linear_drag"]),
        ("swing", "quadratic_drag", None, {"drag": 2e-3}, []),
        ("swing", "constant_force", None, {"x": 1e-3, "y": 0.0, "z": 0.0}, ["gravity_tilt"]),
    ],
    retunes=[
        ("hanging", "retune_youngs_modulus", None, {"value": 1e4}, 1e5, []),
        ("standing", "retune_mass", "weight", {"value": 0.05}, 0.6, ["payload_mass"]),
        ("swing", "retune_gravity", "scene", {"value": 0.3}, soft_models.G, ["clock_rate"]),
    ],
    off_library=[("hanging", "magnet", {"strength": 0.1}), ("swing", "fan", {"strength": 5e-3})],
    pairs=[
        ("hanging", [("kelvin_voigt_damping", "bar", {"viscosity": 30.0}), ("joint_coulomb_friction", "guide", {"effort": 0.05})]),
        ("standing", [("creep", "bar", {"rate": 0.1}), ("kelvin_voigt_damping", "bar", {"viscosity": 30.0})]),
        ("swing", [("quadratic_drag", "strip", {"drag": 4e-3}), ("constant_force", "strip", {"x": 1e-3, "y": 0.0, "z": 0.0})]),
    ],
)
