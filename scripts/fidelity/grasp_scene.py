"""Scenes of one grasp: the gripper of data/grippers/umi_finray stands still, closes around an object of a task and opens.

The fingers are one soft body of two pieces, so that both have one material. What a scene is told is in Grasp; what the
nominal model and reality differ in is in Model. Lengths in m, times in s, angles in rad.
"""
import dataclasses
import pathlib
import subprocess
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "data"))
import asset_tools as tools  # noqa: E402

TOOL_Z = 0.1166667  # of the gripper file's tool_center
SLIDE_Z, FOOT_GAP, PAD_AT_ZERO = 0.058, 0.002, 0.002  # of gripper.urdf and gripper.yaml
OPEN = 0.040
CAMERA = dict(width=256, height=144, field=63)  # the wrist camera of the tasks; pixels, degrees

# above: of the tool centre above the object's origin as the task grasps; open, closed: slide positions of the fitted run
OBJECTS = {
    "beaker": dict(above=0.073, open=0.034, closed=0.018),
    "flask": dict(above=0.113, open=0.018, closed=0.002),
    "dish": dict(above=0.036, open=0.037, closed=0.021),
}


@dataclasses.dataclass
class Model:
    """What a simulation assumes."""
    step: float = 0.020
    integrator: str = "implicit_euler"
    modulus: float = 10e6
    friction: float = 0.8
    finger: str = "nominal.obj"
    rigid: bool = False
    distortion: float = 0.0
    effects: tuple = ()


@dataclasses.dataclass
class Grasp:
    """What is done, the same in all models: where the object stands and where the slides are told to be."""
    thing: str
    offset: tuple  # of the object from below the tool centre, x and y
    yaw: float
    closed: float
    closing: float  # durations, one after the other
    holding: float
    opening: float

    @property
    def opens_at(self):
        return round(self.closing + self.holding, 4)

    @property
    def duration(self):
        return round(self.opens_at + self.opening, 4)

    def command(self, t):
        closed = smooth(t / self.closing) - smooth((t - self.opens_at) / self.opening)
        return self.closed + (OBJECTS[self.thing]["open"] - self.closed) * (1 - closed)


def smooth(s):
    s = min(max(s, 0.0), 1.0)
    return s * s * s * (10 - 15 * s + 6 * s * s)


def read_obj(path):
    points, faces = [], []
    for line in pathlib.Path(path).read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        if words[:1] == ["f"]:
            faces.append(tuple(int(w.split("/")[0]) - 1 for w in words[1:]))
    return tools.Surface(points, faces)


def write_fingers(path, opening, *arguments):
    """Both fingers at the slides' position `opening`, in the gripper's frame; arguments: of make_gripper.py"""
    single = path.with_suffix(".single.obj")
    subprocess.run([sys.executable, ROOT / "data/grippers/umi_finray/make_gripper.py", *arguments, "--finger-only", single],
                   check=True)
    finger = read_obj(single)
    left = finger.moved(y=opening + PAD_AT_ZERO, z=SLIDE_Z + FOOT_GAP)
    right = tools.Surface(left.points * [-1, -1, 1], left.faces)
    tools.write_obj(str(path), tools.joined(left, right), "two fingers of make_gripper.py [m]")
    tools.write_obj(str(path.with_name(path.stem + "_left.obj")), left, "of make_gripper.py [m]")
    tools.write_obj(str(path.with_name(path.stem + "_right.obj")), right, "of make_gripper.py [m]")


def text(grasp, model, folder):
    """The scene file; folder: where the fingers' meshes are"""
    set_up = OBJECTS[grasp.thing]
    height = set_up["above"] + TOOL_Z  # of the gripper's origin over the table
    times = [round(0.01 * i, 4) for i in range(round(grasp.duration / 0.01) + 1)]
    targets = [round(grasp.command(t), 7) for t in times]
    frame = f"position: [0, 0, {height:.7f}], rotation: [180 deg, 0, 0]"
    opening = set_up["open"]
    lines = [f"""schema: 1
name: grasp_{grasp.thing}
time_step: {1000 * model.step:g} ms
duration: {grasp.duration} s
contact: {{activation_distance: 0.5 mm, stiffness: 10 MPa, friction_velocity: 0.1 mm/s, friction_lag_passes: 1}}
solver: {{integrator: {model.integrator}, velocity_tolerance: 1 mm/s, max_newton: 60}}
bodies:
  - {{name: gripper_base, kind: static, shape: {{box: {{size: [0.01, 0.01, 0.01]}}}}, collides: false, pose: {{position: [0, 0, {height + 0.1:.7f}]}}}}
  - {{name: table, kind: half_space, friction: 0.5}}
  - name: {grasp.thing}
    kind: rigid
    shape: {{mesh: {ROOT}/data/objects/{grasp.thing}.obj}}
    density: 2230
    friction: 0.5
    pose: {{position: [{grasp.offset[0]}, {grasp.offset[1]}, 0.0005], rotation: [0, 0, {grasp.yaw}]}}"""]
    for side, turn in (("left", 1), ("right", -1)):
        y = -turn * (opening + PAD_AT_ZERO + 0.0155)
        lines.append(f"""  - {{name: {side}_carriage, kind: rigid, shape: {{box: {{size: [0.026, 0.033, 0.010]}}}}, mass: 0.06, collides: false, pose: {{position: [0, {y:.7f}, {height - SLIDE_Z + 0.005:.7f}]}}}}""")
    if model.rigid:
        for side in ("left", "right"):
            lines.append(f"""  - {{name: finger_{side}, kind: rigid, shape: {{mesh: {folder}/nominal_{side}.obj}}, density: 1200, friction: {model.friction}, pose: {{{frame}}}, visuals: [{{mesh: {folder}/nominal_{side}.obj, material: tpu, crease_angle: 0.3}}]}}""")
    else:
        lines.append(f"""  - name: fingers
    kind: soft
    shape: {{filled: {{surface: {{mesh: {folder}/{model.finger}}}, radius_edge_ratio: 1.6, keeps_surface: true, nodes_per_element: 10}}}}
    material: {{density: 1200, youngs_modulus: {model.modulus:.6g}, poisson_ratio: 0.45}}
    friction: {model.friction}
    pose: {{{frame}}}
    visuals: [{{mesh: {folder}/{model.finger}, material: tpu, crease_angle: 0.3}}]""")
    lines.append("joints:")
    for side, turn in (("left", -1), ("right", 1)):
        lines.append(f"""  - {{name: {side}_slide, type: prismatic, parent: gripper_base, child: {side}_carriage, axis: [0, {turn}, 0], initial: {opening}, limits: [0, {OPEN}], drive: {{stiffness: 2e4, target_times: {times}, target: {targets}}}}}""")
        if model.rigid:
            lines.append(f"""  - {{name: {side}_foot, type: fixed, parent: {side}_carriage, child: finger_{side}}}""")
    if not model.rigid:
        lines.append("stitches:")
        for side, low, high in (("left", 0.0, 0.2), ("right", -0.2, 0.0)):
            lines.append(f"""  - {{soft: fingers, rigid: {side}_carriage, low: [-0.02, {low}, 0.05], high: [0.02, {high}, {SLIDE_Z + FOOT_GAP + 0.0005}], stiffness: 1e5}}""")
    for finger in (["finger_left", "finger_right"] if model.rigid else ["fingers"]):
        lines.append(("pair_friction:\n" if finger != "finger_right" else "")
                     + f"  - {{first: {grasp.thing}, second: {finger}, coefficient: {model.friction}}}")
    if model.effects:
        lines.append("effects:")
        lines += [f"  - {effect}" for effect in model.effects]
    lens = f", distortion: [{model.distortion:.5f}, 0, 0, 0]" if model.distortion else ""
    at, to = (0.082, 0, height - 0.020), (0.014, 0, height - 0.125)
    lines.append(f"""materials: [{{name: tpu, kind: diffuse, color: [0.025, 0.12, 0.44]}}]
cameras:
  - {{name: wrist, width: {CAMERA["width"]}, height: {CAMERA["height"]}, vertical_field_of_view: {CAMERA["field"]} deg, position: [{at[0]}, {at[1]}, {at[2]:.7f}], look_at: [{to[0]}, {to[1]}, {to[2]:.7f}], up: [1, 0, 0]{lens}}}
""")
    return "\n".join(lines)
