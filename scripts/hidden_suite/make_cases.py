#!/usr/bin/python3
"""Makes the hidden-effect suite: recordings whose truth is known, for `phyvisgen diagnose --suite DIR`.

    scripts/hidden_suite/make_cases.py out/hidden            # all cases
    scripts/hidden_suite/make_cases.py data/hidden --quick   # the subset that the tests run

The truth comes from models.py (Runge-Kutta steps of 0.5 ms, no line shared with the simulator). An effect's strength is
set so that what it changes over the fitted runs, beyond what other starts would, is 3, 10 or 30 times the sensor's
noise (root mean square). The sensor adds white noise, jitter of the clock and dropouts. Same seed, same files.
"""
import argparse
import copy
import json
import math
import pathlib

import numpy as np

import models

RATE, JITTER, DROPOUTS = 100.0, 3e-5, 0.01  # samples per second, of their times [s], share of samples that are missing
STRENGTHS = (3, 10, 30)
# by how much a number may be wrong before anyone would see it; an effect that stays weaker than wanted is left out
MOST = {"retune_gravity": 0.3, "length_scale": 0.1, "clock_rate": 0.02, "gravity_tilt": 0.15}

# effects that are the same to first order in their strength, and by which parameter the other one does it: where the
# best such value leaves less than TOLD sigma of all fitted samples together, no data of the experiment can tell
LOOK_ALIKES = {"actuator_lag": ("actuator_delay", "delay", ["actuator_delay", "clock_offset"])}
TOLD = 2.0

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


def as_recorded(command, length):
    """The command that the drive is given: straight lines between the samples that the recording has."""
    samples = [command(k / RATE) for k in range(int(length * RATE) + 2)]

    def lines(t):
        k = min(max(math.floor(t * RATE), 0), len(samples) - 2)
        return samples[k] + (samples[k + 1] - samples[k]) * min(max(t * RATE - k, 0.0), 1.0)

    return lines


class Experiment:
    """A model, its scene, its runs (start, length, command, role) and its channels."""

    def __init__(self, name, model, scene, runs, columns, channel, noise, target, body, phases, command_target=None):
        self.name, self.model, self.scene, self.columns = name, model, scene, columns
        self.runs = [(start, length, command and as_recorded(command, length), role) for start, length, command, role in runs]
        self.channel, self.noise, self.target, self.body, self.phases = channel, noise, target, body, phases
        self.command_target = command_target
        self.unchanged = None  # what change_of compares with, once it is known


def experiments():
    return {
        "pendulum": Experiment(
            "pendulum", models.Pendulum(), PENDULUM,
            [((1.0, 0.0), 2.5, None, "fit"), ((0.4, 0.0), 2.5, None, "fit"), ((-0.7, 2.0), 2.5, None, "fit"),
             ((1.4, -1.0), 2.5, None, "held_out")],
            ["q"], "{column: q, kind: position, joint: hinge, unit: rad, noise: 0.001}", 1e-3, "hinge", "cube", ["free"]),
        "flight": Experiment(
            "flight", models.Flight(), FLIGHT,
            [((0, 0, 1, 4, 0, 3), 0.8, None, "fit"), ((0, 0, 1, 0, 8, 2), 0.8, None, "fit"), ((0.2, 0, 2, -2, -1, 0), 0.8, None, "fit"),
             ((0, 0.2, 1, 6, -4, 4), 0.9, None, "held_out")],
            ["x", "y", "z"], "{columns: [x, y, z], kind: position, body: ball, unit: m, noise: 0.001}", 1e-3, "ball", "ball", ["free"]),
        "slide": Experiment(
            "slide", models.Slide(), SLIDE,
            [((0, 0, 1.0, 0), 0.7, None, "fit"), ((0, 0, 0, 1.6), 0.9, None, "fit"), ((0, 0, -0.5, -0.5), 0.6, None, "fit"),
             ((0, 0, 1.4, -1.2), 1.0, None, "held_out")],
            ["x", "y", "z"], "{columns: [x, y, z], kind: position, body: block, unit: m, noise: 0.0005}", 5e-4, "floor/block", "block", ["slide", "stick", "rest"]),
        "driven": Experiment(
            "driven", models.DrivenJoint(), DRIVEN,
            [((0, 0), 3.0, chirp(0.4, 0.3, 3.0, 3.0), "fit"), ((0, 0), 3.0, steps([0, 0.5, -0.3, 0.2], 0.75), "fit"),
             ((0, 0), 3.0, slow(0.6, 1.5), "fit"), ((0, 0), 3.0, steps([0, -0.6, 0.4, 0.0], 0.7, 0.2), "held_out")],
            ["q"], "{column: q, kind: position, joint: shoulder, unit: rad, noise: 0.001}", 1e-3, "shoulder", "arm", ["driven"],
            "joint/shoulder/position"),
    }


# experiment, effect's name, target (None: the experiment's), parameters at unit strength, what else says the same
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
MEASUREMENT = {"bias", "clock_rate", "length_scale"}
QUICK = {"pendulum_joint_viscous_friction_10x", "pendulum_joint_coulomb_friction_10x", "flight_quadratic_drag_30x", "slide_retune_friction",
         "driven_actuator_delay_10x", "driven_backlash_30x", "driven_retune_drive_stiffness", "pendulum_null_0", "flight_null_0", "pendulum_magnet"}


def sense(experiment, run, effects, times):
    """What a perfect sensor sees, measurement effects included [n_times, n_columns]."""
    start, _, command, _ = run
    rate = effects.get("clock_rate", {"rate": 0})["rate"]
    seen = experiment.model.see(start, times * (1 + rate), {k: v for k, v in effects.items() if k not in MEASUREMENT}, command)
    seen = seen * (1 + effects.get("length_scale", {"scale": 0})["scale"])
    return seen + effects.get("bias", {"x": 0})["x"]


def scaled(effects, by, nominal):
    """Strengths times `by`; numbers of the scene move by that much from what they are; gains from 1."""
    out = copy.deepcopy(effects)
    shapes = {"stribeck_velocity", "velocity", "length"}
    for name, parameters in out.items():
        largest = max(abs(value) for value in parameters.values())
        by = min(by, MOST.get(name, math.inf) / largest)
        for key in parameters:
            if key in shapes:
                continue
            base = nominal.get(name, 1.0 if name == "actuator_gain" else 0.0)
            parameters[key] = base + by * parameters[key]
    return out


def prepare_changes(experiment):
    """What change_of compares with: the fitted runs without any effect, and how they answer to their starts."""
    experiment.unchanged = []
    for run in (run for run in experiment.runs if run[3] == "fit"):
        times = np.arange(0, run[1], 0.05)
        before = sense(experiment, run, {}, times)
        answers = []
        for k in range(len(run[0])):
            start = list(run[0])
            start[k] += 1e-4
            answers.append(((sense(experiment, (start, *run[1:]), {}, times) - before) / 1e-4).ravel())
        experiment.unchanged.append((run, times, before, np.linalg.qr(np.array(answers).T)[0]))


def change_of(experiment, effects):
    """Root mean square of what the effects change over the fitted runs, in units of noise. What another start would
    change alike does not count, since no start is known better than the sensor tells."""
    if experiment.unchanged is None:
        prepare_changes(experiment)
    squares = []
    for run, times, before, of_start in experiment.unchanged:
        change = (sense(experiment, run, effects, times) - before).ravel()
        squares.append(((change - of_start @ (of_start.T @ change)) ** 2).mean())
    return np.sqrt(np.mean(squares)) / experiment.noise


def look_alikes(experiment, effects):
    """Names that explain these effects as well, as far as the noise of all samples of the fitted runs can tell."""
    names = []
    for name in effects.keys() & LOOK_ALIKES.keys():
        other, key, accepted = LOOK_ALIKES[name]
        value = max(abs(v) for v in effects[name].values())
        change, alike = [], []
        for run in (run for run in experiment.runs if run[3] == "fit"):
            times = np.arange(0, run[1], 1 / RATE)
            before = sense(experiment, run, {}, times)
            change.append((sense(experiment, run, effects, times) - before).ravel())
            alike.append((sense(experiment, run, {other: {key: value}}, times) - before).ravel())
        change, alike = np.concatenate(change), np.concatenate(alike)
        left = change - alike * (change @ alike) / (alike @ alike)
        if np.linalg.norm(left) / experiment.noise < TOLD:
            names += accepted
    return names


def at_strength(experiment, effects, nominal, wanted):
    """Effects scaled so that change_of is `wanted`, or as near to it as MOST allows, and what it is then."""
    by, step = 1.0, models.STEP
    models.STEP = 2e-3 if experiment.command_target is None else 1e-3  # only a strength is looked for
    for _ in range(12):
        found = change_of(experiment, scaled(effects, by, nominal))
        if abs(found / wanted - 1) < 0.02:
            break
        by *= np.clip(wanted / found, 0.2, 5.0)
    models.STEP = step
    return scaled(effects, by, nominal), found


def write_case(folder, experiment, effects, truth, rng):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.yaml").write_text(experiment.scene)
    lines = ["schema: 1", "scene: scene.yaml", "runs:"]
    for i, run in enumerate(experiment.runs):
        times = np.arange(0, run[1], 1 / RATE)
        true_times = np.maximum(times + rng.normal(0, JITTER, len(times)), 0)
        seen = sense(experiment, run, effects, np.maximum.accumulate(true_times))
        seen = seen + rng.normal(0, experiment.noise, seen.shape)
        header, rows = ["t"] + experiment.columns, []
        if experiment.command_target:
            header.append("command")
        for k, t in enumerate(times):
            lost = rng.random() < DROPOUTS and k > 10
            row = [f"{t:.4f}"] + ["" if lost else f"{value:.6g}" for value in seen[k]]
            if experiment.command_target:
                row.append(f"{run[2](t):.7g}")
            rows.append(",".join(row))
        (folder / f"run_{i}.csv").write_text(",".join(header) + "\n" + "\n".join(rows) + "\n")
        lines.append(f"  - {{file: run_{i}.csv, role: {run[3]}}}")
    if experiment.command_target:
        lines += ["inputs:", f"  - {{column: command, target: {experiment.command_target}, unit: rad}}"]
    lines += ["channels:", f"  - {experiment.channel}", "initial: first_sample"]
    (folder / "recording.yaml").write_text("\n".join(lines) + "\n")
    (folder / "truth.json").write_text(json.dumps({"schema": 1, **truth}, indent=1) + "\n")


def cases(all_experiments):
    """Name, experiment, effects with parameters, truth, one after the other."""
    for place, name, target, parameters, accept in SINGLES:
        experiment = all_experiments[place]
        for wanted in STRENGTHS:
            yield f"{place}_{name}_{wanted}x", experiment, {name: parameters}, {}, wanted, "single", {name: (target, accept)}
    for place, name, target, parameters, nominal, accept in RETUNES:
        for sign in (1, -1):
            moved = {key: sign * value for key, value in parameters.items()}
            suffix = "" if sign > 0 else "_less"
            yield f"{place}_{name}{suffix}", all_experiments[place], {name: moved}, {name: nominal}, 10, "retune", {name: (target, accept)}
    for place, name, parameters in OFF_LIBRARY:
        for wanted in (10, 30):
            yield f"{place}_{name}{'' if wanted == 10 else '_30x'}", all_experiments[place], {name: parameters}, {}, wanted, "off_library", {}
    alike = {(place, name): accept for place, name, _, _, accept in SINGLES}
    for place, parts in PAIRS:
        effects = {name: parameters for name, _, parameters in parts}
        label = "_and_".join(name for name, _, _ in parts)
        named = {name: (target, alike[place, name]) for name, target, _ in parts}
        yield f"{place}_{label}", all_experiments[place], effects, {}, 30, "two", named


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true", help="only the cases that the tests run")
    parser.add_argument("--nulls", type=int, default=38, help="cases without any effect, per experiment")
    parser.add_argument("--seed", type=int, default=7, help="of all noise")
    options = parser.parse_args()
    everything = experiments()
    for number, (name, experiment, effects, nominal, wanted, kind, named) in enumerate(cases(everything)):
        if options.quick and name not in QUICK:
            continue
        found, strength = at_strength(experiment, effects, nominal, wanted)
        if kind == "single" and strength < 0.8 * wanted:
            print(name, "is left out: at most", round(strength, 1), "times the noise", flush=True)
            continue
        truth = {"kind": kind, "strength": wanted if strength > 0.8 * wanted else round(strength, 1), "source": "independent", "body": experiment.body, "phases": experiment.phases}
        alike = look_alikes(experiment, found) if kind == "single" else []
        truth["effects"] = [{"name": effect, "target": target or experiment.target, "parameters": found[effect], "accept": accept + alike}
                            for effect, (target, accept) in named.items()]
        write_case(options.folder / name, experiment, found, truth, np.random.default_rng([options.seed, number]))
        print(name, flush=True)
    for e, (place, experiment) in enumerate(everything.items()):
        for i in range(options.nulls):
            name = f"{place}_null_{i}"
            if options.quick and name not in QUICK:
                continue
            truth = {"kind": "null", "strength": 0, "source": "independent", "effects": []}
            write_case(options.folder / name, experiment, {}, truth, np.random.default_rng([options.seed + 1, e, i]))


if __name__ == "__main__":
    main()
