"""The experiments that only a camera measures: what the simulator is told, what is done, and the camera. A torque that is
known pushes a pendulum that hangs at rest. See experiments.py.
"""
import math

import models
from camera_models import Camera, FilmedPendulum, MaskedPendulum
from experiments import Cases, Experiment, chirp, slow, steps

SCENE = """schema: 1
name: {name}
time_step: 5 ms
duration: 1.2 s
bodies:
  - {{name: base, kind: static, shape: {{box: {{size: [0.01, 0.01, 0.01]}}}}, collides: false}}
  - {{name: cube, kind: rigid, shape: {{box: {{size: [0.1, 0.1, 0.1]}}}}, mass: 1, pose: {{position: [0, 0, -0.2]}}{visuals}}}
joints:
  - {{name: hinge, type: revolute, parent: base, child: cube, axis: [0, 1, 0]}}
cameras:
  - {{name: front, width: {width}, height: {height}, vertical_field_of_view: 45 deg, position: [0.25, -0.45, -0.02], look_at: [0.02, 0, -0.12], up: [0, 0, 1]}}
"""
LIGHT = """materials:
  - {{name: matte, kind: diffuse, color: [{albedo}, {albedo}, {albedo}]}}
environment: [{sky}, {sky}, {sky}]
"""
VISUALS = ", visuals: [{mesh: cube.obj, material: matte}]"
CUBE = """v -0.05 -0.05 -0.05
v 0.05 -0.05 -0.05
v -0.05 0.05 -0.05
v 0.05 0.05 -0.05
v -0.05 -0.05 0.05
v 0.05 -0.05 0.05
v -0.05 0.05 0.05
v 0.05 0.05 0.05
f 1 3 4 2
f 5 6 8 7
f 1 2 6 5
f 3 7 8 4
f 1 5 7 3
f 2 4 8 6
"""
SKY, ALBEDO, PIXEL_NOISE = 0.6, 0.25, 0.03  # of linear light, 1 being white; one sigma
AT_REST = (0.0, 0.0)
COMMAND = ("joint/hinge/torque", ["torque"], 0)
GIVEN = "{joint/hinge/position: 0, joint/hinge/velocity: 0}"
RUNS = [(AT_REST, 1.2, steps([0.8, -0.4, 0.3], 0.4, 0.15), "fit"), (AT_REST, 1.2, chirp(0.5, 0.4, 2.0, 1.2), "fit"),
        (AT_REST, 1.2, slow(-0.9, 0.9), "held_out")]


def camera(width, height):
    return Camera(width, height, math.radians(45), [0.25, -0.45, -0.02], [0.02, 0, -0.12])


def camera_experiments():
    masked, filmed = MaskedPendulum(camera(96, 72)), FilmedPendulum(camera(64, 48), SKY, ALBEDO, PIXEL_NOISE)
    noise = filmed.noise_of_cells()
    return {
        "masks": Experiment(
            "masks", masked, SCENE.format(name="masks", width=96, height=72, visuals=""), RUNS,
            [], ['{file: "{run}.h5", kind: mask, camera: front, part: cube}'], 1.0, "hinge", "cube", ["driven"], COMMAND,
            rate=25, initial=GIVEN),
        # cells of a picture are of no one body
        "video": Experiment(
            "video", filmed, SCENE.format(name="video", width=64, height=48, visuals=VISUALS) + LIGHT.format(sky=SKY, albedo=ALBEDO), RUNS,
            [], [f'{{file: "{{run}}.h5", kind: video, camera: front, noise: {noise:.2g}}}'], noise, "hinge", None, None, COMMAND,
            rate=12.5, initial=GIVEN, files={"cube.obj": CUBE}),
    }


BRAKES = ["linear_drag", "mass_proportional_damping"]  # the same at a hinge
CAMERA = Cases(
    singles=[
        ("masks", "lens_distortion", "front", {"k1": -0.02}, []),
        ("masks", "joint_viscous_friction", None, {"damping": 1e-2}, BRAKES),
        ("masks", "joint_coulomb_friction", None, {"effort": 1e-2}, []),
        ("masks", "quadratic_drag", "cube", {"drag": 0.1}, []),
        ("masks", "clock_offset", "recording", {"offset": -2e-3}, ["actuator_delay"]),
        ("video", "lens_distortion", "front", {"k1": 0.02}, []),
        ("video", "exposure", "front", {"gain": 0.02}, []),
        ("video", "vignetting", "front", {"v1": -0.05}, []),
        ("video", "joint_viscous_friction", None, {"damping": 1e-2}, BRAKES),
    ],
    retunes=[
        ("masks", "retune_gravity", "scene", {"value": 0.3}, models.G, []),
        ("video", "retune_gravity", "scene", {"value": 0.3}, models.G, []),
        ("masks", "retune_mass", "cube", {"value": 0.1}, 1.0, ["payload_mass", "actuator_gain"]),
    ],
    off_library=[("masks", "magnet", {"strength": 0.5}), ("video", "magnet", {"strength": 0.5})],
    pairs=[("masks", [("joint_viscous_friction", "hinge", {"damping": 1e-2}), ("lens_distortion", "front", {"k1": -0.02})])],
)
