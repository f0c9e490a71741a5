"""The systems of new_scenarios.py: each function draws one with its numbers, runs and sensors, and lists what may be
missing in it. Models: scenario_models.py.
"""
import math
from dataclasses import dataclass, field

import numpy as np

import scenario_models as models

SHAPES = {"stribeck_velocity", "velocity", "length", "width", "at", "waves"}  # parameters that are no strength


@dataclass
class Sensor:
    columns: list
    yaml: str  # what it is, without columns, noise, clock and file
    unit: str
    sees: object  # states [n, n_states] -> [n, n_columns]
    rate: float  # samples per second
    noise: float
    jitter: float = 0.0  # of its time stamps [s]
    latency: float = 0.0  # declared
    own_file: bool = False
    noise_is_told: bool = True


@dataclass
class Run:
    start: tuple
    length: float
    command: object = None  # time -> (value, rate)
    role: str = "fit"
    is_released: bool = False  # from rest: until time 0 nothing moves; else the motion has begun before
    numbers: dict = field(default_factory=dict)  # of nature, other than usual
    told: dict = field(default_factory=dict)  # `set` of the recording


@dataclass
class Scenario:
    name: str
    model: object
    numbers: dict
    scene: object  # numbers -> text
    runs: list
    sensors: list
    singles: list  # name, target, parameters, names that say the same
    unknowns: list  # name, target, parameters
    traps: list  # name, number, target, change, names that say the same
    pairs: list  # of names in singles
    rates: list = field(default_factory=list)  # of a released start: keys of `initial`
    command: str = ""  # target of the input
    command_unit: str = ""
    masses: dict = field(default_factory=dict)  # number -> body whose mass it is


def sampled(command, length, rate):
    """What a drive is told: straight lines between recorded samples; value and rate."""
    values = np.array([command(k / rate) for k in range(int(length * rate) + 2)])
    values = np.round(values, 7)

    def lines(t):
        if t <= 0:
            return values[0], 0.0
        k = min(int(t * rate), len(values) - 2)
        return values[k] + (values[k + 1] - values[k]) * min(t * rate - k, 1.0), (values[k + 1] - values[k]) * rate

    return lines


def smooth_steps(levels, hold, rise):
    def command(t):
        i = min(int(t / hold), len(levels) - 1)
        before, s = levels[max(i - 1, 0)], min((t - i * hold) / rise, 1.0)
        return before + (levels[i] - before) * s * s * (3 - 2 * s)

    return command


def commands(rng, size, length, rate):
    """Three kinds of motions to fit, another one to hold out; all start at rest at 0."""
    low, high = rng.uniform(0.2, 0.6), rng.uniform(1.5, 3.0)
    sweep = lambda t: size * math.sin(2 * math.pi * (low + (high - low) * t / length / 2) * t) * min(t / 0.2, 1)
    stairs = smooth_steps([0, *(size * rng.uniform(0.4, 1.2, 3) * [1, -1, 1])], length / 4, rng.uniform(0.08, 0.2))
    period = length / rng.uniform(1.2, 2.2)
    slow = lambda t: 1.2 * size * (1 - math.cos(2 * math.pi * t / period)) / 2
    other = smooth_steps([0, *(size * rng.uniform(0.5, 1.3, 2) * [-1, 1]), 0], length / 4, rng.uniform(0.1, 0.3))
    return [(sampled(c, length, rate), role) for c, role in ((sweep, "fit"), (stairs, "fit"), (slow, "fit"), (other, "held_out"))]


def encoder(rng, joint, states=(0,), kind="position", unit="rad", noise=None, columns=("q",)):
    return [Sensor([column], f"kind: {kind}, joint: {name}", unit, lambda y, k=k: y[:, [k]], rng.choice([100, 125, 200]),
                   noise or rng.uniform(5e-4, 2e-3), jitter=rng.uniform(0, 5e-5)) for column, name, k in zip(columns, joint, states)]


def camera(rng, body, length, arm):
    """A marker at the lower end of a bar on a hinge about y, seen from the side, with its own rate, file and latency."""
    place = lambda y: np.column_stack([-arm * np.sin(y[:, 0]), -arm * np.cos(y[:, 0])])
    return Sensor(["m_x", "m_z"], f"kind: marker, body: {body}, point: [0, 0, {-length / 2:.6g}], axes: [x, z]", "m", place,
                  rng.choice([30, 50, 60]), rng.uniform(3e-4, 1e-3), jitter=rng.uniform(0, 2e-4),
                  latency=round(rng.uniform(0.005, 0.03), 3), own_file=True)


BASE = "  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}\n"


def bar(name, length, width, mass, position):
    x, y, z = (f"{value:.6g}" for value in position)
    size = f"[{width:.6g}, {width:.6g}, {length:.6g}]"
    return f"  - {{name: {name}, kind: rigid, shape: {{box: {{size: {size}}}}}, mass: {mass:.6g}, pose: {{position: [{x}, {y}, {z}]}}, collides: false}}\n"


def head(name, duration, gravity="[0, 0, -9.81]"):
    return f"schema: 1\nname: {name}\ntime_step: 5 ms\nduration: {duration:.3g} s\ngravity: {gravity}\nbodies:\n"


def pendulum(rng):
    n = {"mass": round(rng.uniform(0.15, 1.5), 3), "length": round(rng.uniform(0.25, 0.6), 3), "width": round(rng.uniform(0.02, 0.05), 3), "gravity": models.G,
         "damping": 0.0}
    n["damping"] = float(f"{rng.choice([0, 0.02]) * n['mass'] * n['length'] ** 2:.3g}")
    duration = 2.4
    scene = lambda n: (head("pendulum", duration) + BASE + bar("bar", n["length"], n["width"], n["mass"], [0, 0, -n["length"] / 2]) + "joints:\n"
                       f"  - {{name: hinge, type: revolute, parent: base, child: bar, axis: [0, 1, 0], damping: {n['damping']:.6g}}}\n")
    is_released = rng.random() < 0.5
    runs = [Run((rng.uniform(0.7, 1.2), 0.0), duration, is_released=is_released), Run((-rng.uniform(0.3, 0.5), 0.0), duration, is_released=is_released),
            Run((rng.uniform(-0.8, -0.4), rng.uniform(1.5, 3)), duration), Run((rng.uniform(1.2, 1.5), 0.0), duration, role="held_out", is_released=is_released)]
    sensors = encoder(rng, ["hinge"])
    if rng.random() < 0.5:
        sensors.append(camera(rng, "bar", n["length"], n["length"]))
    unit = n["mass"] * 9.81 * n["length"] / 2
    viscous = ["linear_drag", "retune_joint_damping"]
    return Scenario(
        "pendulum", models.Pendulum(), n, scene, runs, sensors,
        [("joint_viscous_friction", "hinge", {"damping": 0.01 * unit}, viscous), ("joint_coulomb_friction", "hinge", {"effort": 0.01 * unit}, []),
         ("joint_stribeck_friction", "hinge", {"effort": 0.005 * unit, "extra": 0.01 * unit, "stribeck_velocity": 0.5}, []),
         ("joint_spring", "hinge", {"stiffness": 0.03 * unit, "preload": 0.02 * unit}, []), ("quadratic_drag", "bar", {"drag": 0.1}, []),
         ("gravity_tilt", "scene", {"about_y": 0.02}, ["center_of_mass_offset", "bias", "joint_spring"]),
         ("linear_drag", "bar", {"drag": 0.05 * unit}, ["joint_viscous_friction", "retune_joint_damping"])]
        + ([("latency", "m_x", {"latency": 4e-3}, []), ("marker_offset", "m_x", {"x": 3e-3, "z": 2e-3}, [])] if len(sensors) > 1 else []),
        [("unknown_magnet", "hinge", {"strength": 0.1 * unit, "width": 0.3})],
        [("retune_joint_damping", "damping", "hinge", 1.0, ["joint_viscous_friction"])] if n["damping"] else [],
        [("joint_coulomb_friction", "joint_spring"), ("joint_viscous_friction", "joint_spring"), ("quadratic_drag", "joint_coulomb_friction")]
        + ([("joint_coulomb_friction", "latency")] if len(sensors) > 1 else []),
        ["joint/hinge/velocity"], masses={"mass": "bar"})


def double_pendulum(rng):
    n = {"mass_1": round(rng.uniform(0.3, 1), 3), "mass_2": round(rng.uniform(0.2, 0.8), 3), "length_1": round(rng.uniform(0.25, 0.4), 3),
         "length_2": round(rng.uniform(0.2, 0.35), 3), "width": 0.03, "gravity": models.G}
    duration = 1.6

    def scene(n):
        return (head("double_pendulum", duration) + BASE + bar("upper", n["length_1"], n["width"], n["mass_1"], [0, 0, -n["length_1"] / 2])
                + bar("lower", n["length_2"], n["width"], n["mass_2"], [0, 0, -n["length_1"] - n["length_2"] / 2]) + "joints:\n"
                "  - {name: shoulder, type: revolute, parent: base, child: upper, axis: [0, 1, 0]}\n"
                f"  - {{name: elbow, type: revolute, parent: upper, child: lower, axis: [0, 1, 0], parent_frame: {{position: [0, 0, {-n['length_1'] / 2:.6g}]}}}}\n")

    start = lambda size: (size * rng.uniform(0.5, 1), size * rng.uniform(-0.8, 0.8), 0.0, 0.0)
    is_released = rng.random() < 0.5
    runs = [Run(start(0.7), duration, is_released=is_released), Run(start(-0.5), duration, is_released=is_released),
            Run(start(0.4), duration, is_released=is_released), Run(start(-0.8), duration, role="held_out", is_released=is_released)]
    unit = n["mass_2"] * 9.81 * n["length_2"] / 2
    return Scenario(
        "double_pendulum", models.DoublePendulum(), n, scene, runs, encoder(rng, ["shoulder", "elbow"], (0, 1), columns=("q1", "q2")),
        [("joint_viscous_friction", "elbow", {"damping": 0.01 * unit}, []), ("joint_coulomb_friction", "elbow", {"effort": 0.01 * unit}, []),
         ("joint_viscous_friction", "shoulder", {"damping": 0.02 * unit}, ["linear_drag"]), ("joint_coulomb_friction", "shoulder", {"effort": 0.02 * unit}, []),
         ("joint_spring", "elbow", {"stiffness": 0.05 * unit, "preload": 0.01 * unit}, []), ("payload_mass", "lower", {"mass": 0.02}, ["retune_mass"])],
        [("unknown_magnet", "shoulder", {"strength": 0.2 * unit, "width": 0.3}), ("unknown_magnet", "elbow", {"strength": 0.1 * unit, "width": 0.3})],
        [("retune_mass", "mass_2", "lower", 0.1, ["retune_mass at upper", "payload_mass", "retune_inertia"])],  # the ratio of the masses alone counts
        [("joint_coulomb_friction", "joint_spring")],
        ["joint/shoulder/velocity", "joint/elbow/velocity"], masses={"mass_1": "upper", "mass_2": "lower"})


def driven_inertia(n):
    return n["mass"] * ((n["length"] ** 2 + n["width"] ** 2) / 12 + n["length"] ** 2 / 4) if "length" in n else n["mass"]


def tuned_drive(rng, n):
    """Stiffness and damping of a drive from its frequency and damping ratio."""
    omega, ratio = 2 * math.pi * rng.uniform(1.5, 3.5), rng.uniform(0.3, 0.8)
    inertia = driven_inertia(n)
    n |= {"stiffness": float(f"{inertia * omega**2:.3g}"), "damping": float(f"{2 * ratio * inertia * omega:.3g}")}
    return 0.3 * n["stiffness"]  # an effort that matters


def driven_effects(joint, body, unit, n):
    """What may be wrong with a driven joint."""
    singles = [("joint_viscous_friction", joint, {"damping": 0.02 * unit}, ["linear_drag"]), ("joint_coulomb_friction", joint, {"effort": 0.02 * unit}, []),
               ("joint_stribeck_friction", joint, {"effort": 0.01 * unit, "extra": 0.02 * unit, "stribeck_velocity": 0.3}, []),
               ("backlash", joint, {"play": 0.01}, []), ("actuator_delay", joint, {"delay": 4e-3}, ["clock_offset", "actuator_lag"]),
               ("actuator_lag", joint, {"time_constant": 4e-3}, ["actuator_delay", "clock_offset"]),
               ("joint_spring", joint, {"stiffness": 0.05 * unit, "preload": 0.02 * unit}, ["bias"]),
               ("payload_mass", body, {"mass": 0.1 * n["mass"]}, ["retune_mass", "retune_inertia", "actuator_gain"])]
    traps = [("retune_drive_stiffness", "stiffness", joint, 0.1, []), ("retune_drive_damping", "damping", joint, 0.1, []),
             ("retune_mass", "mass", body, 0.1, ["payload_mass", "retune_inertia", "actuator_gain"])]
    pairs = [("backlash", "joint_viscous_friction"), ("joint_coulomb_friction", "actuator_delay"), ("joint_spring", "actuator_delay"),
             ("joint_coulomb_friction", "payload_mass")]
    unknowns = [("unknown_ripple", joint, {"strength": 0.05 * unit, "waves": 24}), ("unknown_bumper", joint, {"stiffness": unit, "at": 0.2})]
    return singles, unknowns, traps, pairs


def loads(rng, runs, number, body, n):
    """In half of the cases one fitted run carries a known load, fastened so that its inertia grows alike."""
    if rng.random() < 0.5:
        load = round(1.3 * n[number], 4)
        runs[1].numbers, runs[1].told = {number: load}, {f"body/{body}/mass": f"{load:g} kg"}


def servo(rng):
    weight = rng.random() < 0.5
    n = {"mass": round(rng.uniform(0.3, 1.2), 3), "length": round(rng.uniform(0.2, 0.4), 3), "width": 0.04, "gravity": models.G}
    unit = tuned_drive(rng, n)
    duration = 2.4
    axis, place = ("[0, 1, 0]", [0, 0, -n["length"] / 2]) if weight else ("[0, 0, 1]", [n["length"] / 2, 0, 0])

    def scene(n):
        size = [n["width"], n["width"], n["length"]] if weight else [n["length"], n["width"], n["width"]]
        return (head("servo", duration, f"[0, 0, -{models.G}]" if weight else "[0, 0, 0]") + BASE
                + f"  - {{name: arm, kind: rigid, shape: {{box: {{size: {[float(f'{s:.6g}') for s in size]}}}}}, mass: {n['mass']:.6g}, pose: {{position: {[float(f'{s:.6g}') for s in place]}}}, collides: false}}\njoints:\n"
                f"  - {{name: shoulder, type: revolute, parent: base, child: arm, axis: {axis}, drive: {{stiffness: {n['stiffness']:.6g}, damping: {n['damping']:.6g}}}}}\n")

    runs = [Run((0.0, 0.0), duration, c, role, True) for c, role in commands(rng, rng.uniform(0.3, 0.6), duration, 100)]
    loads(rng, runs, "mass", "arm", n)
    sensors = encoder(rng, ["shoulder"])
    sensors[0].rate = 100
    if weight and rng.random() < 0.5:
        sensors.append(camera(rng, "arm", n["length"], n["length"]))
    singles, unknowns, traps, pairs = driven_effects("shoulder", "arm", unit, n)
    if len(sensors) > 1:
        singles.append(("latency", "m_x", {"latency": 4e-3}, []))
    return Scenario("servo_hanging" if weight else "servo", models.Driven("shoulder", float(weight)), n, scene, runs, sensors, singles, unknowns, traps, pairs,
                    ["joint/shoulder/velocity"], "joint/shoulder/position", "rad", {"mass": "arm"})


def carriage(rng):
    n = {"mass": round(rng.uniform(0.5, 3), 3), "gravity": models.G}
    unit = 0.3 * tuned_drive(rng, n)
    duration = 2.4
    scene = lambda n: (head("carriage", duration, "[0, 0, 0]") + BASE
                       + f"  - {{name: sledge, kind: rigid, shape: {{box: {{size: [0.1, 0.06, 0.04]}}}}, mass: {n['mass']:.6g}, collides: false}}\njoints:\n"
                       f"  - {{name: rail, type: prismatic, parent: base, child: sledge, axis: [1, 0, 0], drive: {{stiffness: {n['stiffness']:.6g}, damping: {n['damping']:.6g}}}}}\n")
    runs = [Run((0.0, 0.0), duration, c, role, True) for c, role in commands(rng, rng.uniform(0.08, 0.15), duration, 100)]
    loads(rng, runs, "mass", "sledge", n)
    sensors = encoder(rng, ["rail"], unit="m", noise=rng.uniform(2e-4, 5e-4))
    sensors[0].rate = 100
    singles, unknowns, traps, pairs = driven_effects("rail", "sledge", 0.2 * unit, n)
    unknowns = [("unknown_ripple", "rail", {"strength": 0.02 * unit, "waves": 120}), ("unknown_bumper", "rail", {"stiffness": unit, "at": 0.05})]
    return Scenario("carriage", models.Driven("rail", 0.0), n, scene, runs, sensors, singles, unknowns, traps, pairs,
                    ["joint/rail/velocity"], "joint/rail/position", "m", {"mass": "sledge"})


def hung(rng):
    n = {"mass": round(rng.uniform(0.2, 1.0), 3), "gravity": models.G, "damping": 0.0}
    n["stiffness"] = float(f"{n['mass'] * (2 * math.pi * rng.uniform(1.2, 2.2)) ** 2:.3g}")
    n["damping"] = float(f"{rng.choice([0.02, 0.1]) * n['mass']:.3g}")
    rest = lambda n: -n["mass"] * models.G / n["stiffness"]
    duration = 2.4
    scene = lambda n: (head("hung_mass", duration) + BASE
                       + f"  - {{name: weight, kind: rigid, shape: {{box: {{size: [0.05, 0.05, 0.08]}}}}, mass: {n['mass']:.6g}, pose: {{position: [0, 0, -0.3]}}, collides: false}}\njoints:\n"
                       f"  - {{name: guide, type: prismatic, parent: base, child: weight, axis: [0, 0, 1], damping: {n['damping']:.6g}, drive: {{stiffness: {n['stiffness']:.6g}, target: 0}}}}\n")
    is_released = rng.random() < 0.5
    starts = [rng.uniform(0.06, 0.1), -rng.uniform(0.02, 0.05), rng.uniform(0.03, 0.05)]
    runs = [Run((rest(n) + s, 0.0), duration, is_released=is_released) for s in starts]
    runs.append(Run((rest(n) - rng.uniform(0.07, 0.11), 0.0), duration, role="held_out", is_released=is_released))
    loads(rng, runs, "mass", "weight", n)
    has_load = bool(runs[1].told)
    sensors = [Sensor(["height"], "kind: position, body: weight, axis: [0, 0, 1]", "m", lambda y: y[:, [0]] - 0.3, rng.choice([60, 100]), rng.uniform(2e-4, 8e-4),
                      jitter=rng.uniform(0, 1e-4))]
    unit = n["mass"] * 9.81
    viscous = ["linear_drag", "retune_joint_damping", "joint_viscous_friction"]
    stiff = ["joint_spring"] if has_load else ["retune_mass", "payload_mass", "joint_spring"]
    return Scenario(
        "hung", models.Hung(), n, scene, runs, sensors,
        [("joint_viscous_friction", "guide", {"damping": 0.02 * unit}, viscous), ("joint_coulomb_friction", "guide", {"effort": 0.01 * unit}, []),
         ("quadratic_drag", "weight", {"drag": 0.05 * unit}, []), ("linear_drag", "weight", {"drag": 0.02 * unit}, viscous),
         ("payload_mass", "weight", {"mass": 0.03 * n["mass"]}, ["retune_mass"] + ([] if has_load else ["retune_drive_stiffness"]))],
        [("unknown_cubic", "guide", {"stiffness": n["stiffness"] * 5}), ("unknown_bumper", "guide", {"stiffness": n["stiffness"], "at": rest(n) + 0.03})],
        [("retune_drive_stiffness", "stiffness", "guide", 0.05, stiff), ("retune_joint_damping", "damping", "guide", 1.0, viscous)],
        [("joint_coulomb_friction", "quadratic_drag"), ("joint_coulomb_friction", "payload_mass")],
        ["joint/guide/velocity"], masses={"mass": "weight"})


def flywheel(rng):
    n = {"mass": round(rng.uniform(0.5, 2), 3), "side": round(rng.uniform(0.1, 0.2), 3), "damping": 0.0}
    inertia = n["mass"] * n["side"] ** 2 / 6
    n["damping"] = float(f"{inertia * rng.choice([0.05, 0.2]):.3g}")
    duration = 2.4
    scene = lambda n: (head("flywheel", duration, "[0, 0, 0]") + BASE
                       + f"  - {{name: plate, kind: rigid, shape: {{box: {{size: [{n['side']:.6g}, {n['side']:.6g}, 0.02]}}}}, mass: {n['mass']:.6g}, collides: false}}\njoints:\n"
                       f"  - {{name: spindle, type: revolute, parent: base, child: plate, axis: [0, 0, 1], damping: {n['damping']:.6g}}}\n")
    runs = [Run((0.0, 0.0), duration, c, role, True) for c, role in commands(rng, inertia * rng.uniform(15, 30), duration, 100)]
    sensors = encoder(rng, ["spindle"])
    sensors[0].rate = 200 if sensors[0].rate == 200 else 100  # so that its table has each bend of the command
    sensors.append(Sensor(["w"], "kind: rate, joint: spindle", "rad/s", lambda y: y[:, [1]], rng.choice([50, 100]), rng.uniform(0.01, 0.04), own_file=rng.random() < 0.5))
    return Scenario(
        "flywheel", models.Flywheel(), n, scene, runs, sensors,
        [("joint_viscous_friction", "spindle", {"damping": 0.1 * inertia}, ["retune_joint_damping", "spin_drag"]), ("joint_coulomb_friction", "spindle", {"effort": 0.2 * inertia}, []),
         ("joint_stribeck_friction", "spindle", {"effort": 0.2 * inertia, "extra": 0.3 * inertia, "stribeck_velocity": 1.0}, []),
         ("joint_spring", "spindle", {"stiffness": 0.05 * inertia, "preload": 0.1 * inertia}, [])],
        [("unknown_ripple", "spindle", {"strength": inertia, "waves": 6})],
        [("retune_mass", "mass", "plate", 0.05, ["retune_inertia"]), ("retune_joint_damping", "damping", "spindle", 1.0, ["joint_viscous_friction", "spin_drag"])],
        [("joint_coulomb_friction", "joint_spring"), ("joint_coulomb_friction", "joint_viscous_friction")],
        ["joint/spindle/velocity"], "joint/spindle/torque", "N m", {"mass": "plate"})


def slide(rng):
    n = {"mass": round(rng.uniform(0.2, 0.8), 3), "friction": round(rng.uniform(0.2, 0.4), 2), "gravity_vector": [0, 0, -models.G]}
    duration = 0.8
    scene = lambda n: (head("slide", duration).replace("bodies:", "contact: {activation_distance: 0.1 mm, stiffness: 10 MPa, friction_velocity: 1e-3}\nbodies:")
                       + "  - {name: plane, kind: half_space, normal: [0, 0, 1]}\n"
                       f"  - {{name: block, kind: rigid, shape: {{box: {{size: [0.1, 0.1, 0.04]}}}}, mass: {n['mass']:.6g}, pose: {{position: [0, 0, 0.02009]}}}}\n"
                       f"pair_friction:\n  - {{first: plane, second: block, coefficient: {n['friction']:.6g}}}\n")
    speed = lambda: rng.uniform(0.8, 1.5)
    runs = [Run((0, 0, speed(), 0), 0.6), Run((0, 0, 0, speed()), 0.6), Run((0, 0, -0.7 * speed(), -0.5), 0.6), Run((0, 0, speed(), -speed()), 0.8, role="held_out")]
    if rng.random() < 0.5:  # the plane was inclined: gravity in its frame, as the user measured it
        angle = round(rng.uniform(0.05, 0.15), 3)
        g = [round(models.G * math.sin(angle), 4), 0.0, round(-models.G * math.cos(angle), 4)]
        runs[1].numbers, runs[1].told = {"gravity_vector": g}, {"gravity": str(g)}
    sensors = [Sensor(["x", "y"], "kind: marker, body: block, point: [0, 0, 0], axes: [x, y]", "m", lambda y: y[:, :2], rng.choice([100, 120]), rng.uniform(3e-4, 8e-4), jitter=rng.uniform(0, 5e-5))]
    return Scenario(
        "slide", models.Slide(), n, scene, runs, sensors,
        [("velocity_dependent_friction", "plane/block", {"change": 0.3, "velocity": 0.1}, []), ("anisotropic_friction", "plane/block", {"change": 0.2}, []),
         ("quadratic_drag", "block", {"drag": 0.05}, []), ("gravity_tilt", "scene", {"about_x": 0.01, "about_y": 0.01}, ["constant_force"])],
        [("unknown_strip", "plane/block", {"extra": 0.3})], [("retune_friction", "friction", "plane/block", 0.1, [])],
        [("anisotropic_friction", "gravity_tilt")], masses={"mass": "block"})


def flight(rng):
    n = {"mass": round(rng.uniform(0.05, 0.4), 3), "gravity": models.G}
    scene = lambda n: (head("flight", 0.8) + f"  - {{name: ball, kind: rigid, shape: {{sphere: {{radius: 0.04, subdivisions: 2}}}}, mass: {n['mass']:.6g}, collides: false}}\n")
    throw = lambda: (rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), rng.uniform(0.8, 1.5), *(rng.uniform(2, 7, 2) * rng.choice([-1, 1], 2)), rng.uniform(1, 4))
    runs = [Run(throw(), 0.7), Run(throw(), 0.7), Run(throw(), 0.7), Run(throw(), 0.8, role="held_out")]
    runs += [Run(tuple(v + d for v, d in zip(runs[0].start, rng.normal(0, 0.02, 6))), 0.7)] if rng.random() < 0.5 else []  # a repeat
    sensors = [Sensor(["x", "y", "z"], "kind: position, body: ball", "m", lambda y: y[:, :3], rng.choice([60, 100, 120]), rng.uniform(5e-4, 2e-3), jitter=rng.uniform(0, 1e-4))]
    return Scenario(
        "flight", models.Flight(), n, scene, runs, sensors,
        [("linear_drag", "ball", {"drag": 0.02}, []), ("quadratic_drag", "ball", {"drag": 0.005}, []),
         ("constant_force", "ball", {"x": 0.02, "y": -0.03}, ["gravity_tilt"]), ("gravity_tilt", "scene", {"about_x": 0.01, "about_y": 0.02}, ["constant_force"])],
        [("unknown_vortex", "ball", {"strength": 0.1}), ("unknown_tether", "ball", {"stiffness": 1.0, "length": 1.5}), ("unknown_magnus", "ball", {"lift": 0.01})],
        [("retune_gravity", "gravity", "scene", 0.02, ["length_scale"])],
        [("quadratic_drag", "constant_force"), ("linear_drag", "gravity_tilt")], masses={"mass": "ball"})


SYSTEMS = [pendulum, servo, hung, flight, flywheel, carriage, double_pendulum, slide]
