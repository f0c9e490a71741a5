#!/usr/bin/python3
"""Makes the hidden-effect suite: recordings whose truth is known, for `phyvisgen diagnose --suite DIR`.

    scripts/hidden_suite/make_cases.py out/hidden            # all cases
    scripts/hidden_suite/make_cases.py data/hidden --quick   # the subset that the tests run

The truth comes from the models beside this script (no line shared with the simulator). An effect's strength is
set so that what it changes over the fitted runs, beyond what other starts would, is 3, 10 or 30 times the sensor's
noise (root mean square). The sensor adds white noise, jitter of the clock and dropouts. Same seed, same files.
"""
import needed_packages  # first: it says what is missing

import argparse
import copy
import itertools
import json
import math
import pathlib

import h5py
import numpy as np

import models
import soft_models
from beam_experiments import BENT, beam_experiments
from camera_experiments import CAMERA, camera_experiments
from contact_experiments import CONTACT, contact_experiments
from controls import CONTROLS
from experiments import RIGID, experiments
from rubber_experiments import RUBBER, rubber_experiments
from sensor_experiments import SENSOR, sensor_experiments
from soft_experiments import SOFT, soft_experiments
from touch_experiments import TOUCH, touch_experiments

JITTER, DROPOUTS = 3e-5, 0.01  # of the samples' times [s], share of samples that are missing
STRENGTHS = (3, 10, 30)
# by how much a number may be wrong before anyone would see it; an effect that stays weaker than wanted is left out
MOST = {"retune_gravity": 0.3, "length_scale": 0.1, "clock_rate": 0.02, "gravity_tilt": 0.15, "lens_distortion": 0.25,
        "clock_offset": 0.05, "retune_friction": 0.25, "latency": 0.1, "frame_misalignment": 0.3, "marker_offset": 0.1}

# effects that are the same to first order in their strength, and by which parameter the other one does it: where the
# best such value leaves less than TOLD sigma of all fitted samples together, no data of the experiment can tell
LOOK_ALIKES = {"actuator_lag": ("actuator_delay", "delay", ["actuator_delay", "clock_offset"])}
TOLD = 2.0
LIMITS = {"yield_strain"}  # parameters that do more where they are smaller
GAINS = {"actuator_gain", "exposure"}  # 1 without effect

MEASUREMENT = {"bias", "clock_rate", "length_scale"}
QUICK = {"pendulum_joint_coulomb_friction_10x", "pendulum_magnet", "flight_quadratic_drag_30x", "flight_linear_drag_and_gravity_tilt", "flight_null_0",
         "slide_retune_friction", "driven_backlash_30x", "hanging_strain_stiffening_10x", "swing_null_0", "masks_null_0", "video_vignetting_10x",
         "tracked_latency_10x"}


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
    shapes = {"stribeck_velocity", "velocity", "length", "exponent"}
    for name, parameters in out.items():
        largest = max(abs(value) for value in parameters.values())
        by = min(by, MOST.get(name, math.inf) / largest)
        for key in parameters:
            if key in shapes:
                continue
            base = nominal.get(name, 1.0 if name in GAINS else 0.0)
            parameters[key] = parameters[key] / by if key in LIMITS else base + by * parameters[key]
    return out


def weights(experiment):
    """Of the columns, by their noise; the noisiest has 1."""
    return experiment.noise / np.max(experiment.noise)


def prepare_changes(experiment):
    """What change_of compares with: the fitted runs without any effect, and how they answer to their starts."""
    experiment.unchanged = []
    weight = weights(experiment)
    for run in (run for run in experiment.runs if run[3] == "fit"):
        times = np.arange(0, run[1], 0.05)
        before = sense(experiment, run, {}, times) / weight
        answers = []
        for k in range(len(run[0])):
            start = list(run[0])
            start[k] += 1e-4
            answers.append(((sense(experiment, (start, *run[1:]), {}, times) / weight - before) / 1e-4).ravel())
        of_start = np.array(answers).reshape(len(answers), before.size).T
        experiment.unchanged.append((run, times, before, np.linalg.qr(of_start)[0]))


def change_of(experiment, effects):
    """Root mean square of what the effects change over the fitted runs, in units of noise. What another start would
    change alike does not count, since no start is known better than the sensor tells."""
    if experiment.unchanged is None:
        prepare_changes(experiment)
    squares = []
    for run, times, before, of_start in experiment.unchanged:
        change = (sense(experiment, run, effects, times) / weights(experiment) - before).ravel()
        squares.append(((change - of_start @ (of_start.T @ change)) ** 2).mean())
    return np.sqrt(np.mean(squares)) / np.max(experiment.noise)


def look_alikes(experiment, effects):
    """Names that explain these effects as well, as far as the noise of all samples of the fitted runs can tell."""
    names = []
    for name in effects.keys() & LOOK_ALIKES.keys():
        other, key, accepted = LOOK_ALIKES[name]
        value = max(abs(v) for v in effects[name].values())
        change, alike = [], []
        for run in (run for run in experiment.runs if run[3] == "fit"):
            times = np.arange(0, run[1], 1 / experiment.rate)
            before = sense(experiment, run, {}, times)
            change.append((sense(experiment, run, effects, times) - before).ravel())
            alike.append((sense(experiment, run, {other: {key: value}}, times) - before).ravel())
        change, alike = np.concatenate(change), np.concatenate(alike)
        left = change - alike * (change @ alike) / (alike @ alike)
        if np.linalg.norm(left) / experiment.noise < TOLD:
            names += accepted
    return names


def at_strength(experiment, effects, nominal, wanted):
    """Effects scaled so that change_of is `wanted`, or as near to it as MOST and the model allow, and what it is then."""
    fine = models.STEP
    # only a strength is looked for
    models.STEP, soft_models.resolution = 2e-3 if experiment.command is None else 1e-3, soft_models.COARSE
    experiment.unchanged = None
    by, best, too_weak, too_strong = 1.0, (0.0, 0.0), 0.0, math.inf
    for _ in range(16):
        try:
            found = change_of(experiment, scaled(effects, by, nominal))
        except soft_models.TooStrong:
            found = math.inf
        saturated = 0 < found < 1.1 * best[0] and by > 1.5 * best[1] > 0
        if found < math.inf:
            best = (found, by)
        if abs(found / wanted - 1) < 0.02 or saturated:
            break
        too_weak, too_strong = (max(too_weak, by), too_strong) if found < wanted else (too_weak, min(too_strong, by))
        by *= np.clip(wanted / max(found, 1e-9), 0.2, 5.0)
        if not too_weak < by < too_strong:
            by = (too_weak + too_strong) / 2
    models.STEP, soft_models.resolution = fine, soft_models.FINE
    return scaled(effects, best[1], nominal), best[0]


def write_pictures(file, experiment, run, effects, times, rng):
    """What a camera recorded; a few pictures are missing."""
    is_there = (rng.random(len(times)) >= DROPOUTS) | (np.arange(len(times)) <= 10)
    true_times = np.maximum(times + rng.normal(0, JITTER, len(times)), 0)
    with h5py.File(file, "w") as out:
        arrays, attributes = experiment.model.record(run[0], true_times[is_there], effects, run[2], rng)
        for name, values in arrays.items():
            array = out.create_dataset(name, data=values, compression="gzip")
            for key, value in attributes.items():
                array.attrs[key] = value
        out.create_dataset("time", data=times[is_there])


def samples_of(experiment, run, effects, times, rng):
    """What a table holds of its sensors [n_times, n_columns]."""
    true_times = np.maximum(times + rng.normal(0, JITTER, len(times)), 0)
    seen = sense(experiment, run, effects, np.maximum.accumulate(true_times))
    noise = rng.normal(0, experiment.noise, seen.shape)
    return experiment.model.table(seen, noise) if hasattr(experiment.model, "table") else seen + noise


def unit_of(target):
    of, name, quantity = target.split("/")
    if name == "guide":  # a joint that slides
        return "N" if quantity == "torque" else "m"
    return "m" if of == "body" else "N m" if quantity == "torque" else "rad"


def write_case(folder, experiment, effects, truth, rng, control=None):
    """control: what is measured instead, as controls.py has it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.yaml").write_text(experiment.scene)
    for name, text in experiment.files.items():
        (folder / name).write_text(text)
    lines = ["schema: 1", "scene: scene.yaml", "runs:"]
    for number, run in enumerate(experiment.runs):
        times = np.arange(0, run[1], 1 / experiment.rate)
        if control:
            seen = control(experiment, number, times, rng, samples_of)
        else:
            seen = samples_of(experiment, run, effects, times, rng) if experiment.columns else np.empty((len(times), 0))
        header, rows = ["t"] + experiment.columns, []
        if experiment.command:
            target, commanded, which = experiment.command
            header += commanded
        for k, t in enumerate(times):
            lost = rng.random() < DROPOUTS and k > 10
            row = [f"{t:.4f}"] + ["" if lost else f"{value:.6g}" for value in seen[k]]
            if experiment.command:
                row += [f"{run[2](t):.7g}" if i == which else "0" for i in range(len(commanded))]
            rows.append(",".join(row))
        (folder / f"run_{number}.csv").write_text(",".join(header) + "\n" + "\n".join(rows) + "\n")
        if hasattr(experiment.model, "record"):
            write_pictures(folder / f"run_{number}.h5", experiment, run, effects, times, rng)
        lines.append(f"  - {{file: run_{number}.csv, role: {run[3]}}}")
    if experiment.command:
        key = f"column: {commanded[0]}" if len(commanded) == 1 else f"columns: [{', '.join(commanded)}]"
        lines += ["inputs:", f"  - {{{key}, target: {target}, unit: {unit_of(target)}}}"]
    lines += ["channels:", *(f"  - {channel}" for channel in experiment.channels), f"initial: {experiment.initial}"]
    (folder / "recording.yaml").write_text("\n".join(lines) + "\n")
    (folder / "truth.json").write_text(json.dumps({"schema": 1, **truth}, indent=1) + "\n")


def cases(all_experiments, lists):
    """Name, experiment, effects with parameters, truth, one after the other."""
    for place, name, target, parameters, accept in lists.singles:
        experiment = all_experiments[place]
        for wanted in STRENGTHS:
            yield f"{place}_{name}_{wanted}x", experiment, {name: parameters}, {}, wanted, "single", {name: (target, accept)}
    for place, name, target, parameters, nominal, accept in lists.retunes:
        for sign in (1, -1):
            moved = {key: sign * value for key, value in parameters.items()}
            suffix = "" if sign > 0 else "_less"
            yield f"{place}_{name}{suffix}", all_experiments[place], {name: moved}, {name: nominal}, 10, "retune", {name: (target, accept)}
    for place, name, parameters in lists.off_library:
        for wanted in (10, 30):
            yield f"{place}_{name}{'' if wanted == 10 else '_30x'}", all_experiments[place], {name: parameters}, {}, wanted, "off_library", {}
    alike = {(place, name): accept for place, name, _, _, accept in lists.singles}
    for place, parts in lists.pairs:
        effects = {name: parameters for name, _, parameters in parts}
        label = "_and_".join(name for name, _, _ in parts)
        named = {name: (target, alike[place, name]) for name, target, _ in parts}
        yield f"{place}_{label}", all_experiments[place], effects, {}, 30, "two", named


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true", help="only the cases that the tests run")
    parser.add_argument("--only", default="", help="only cases whose names begin so")
    parser.add_argument("--nulls", type=int, default=38, help="cases without any effect, per experiment")
    parser.add_argument("--controls", type=int, default=8, help="cases of each control (controls.py)")
    parser.add_argument("--seed", type=int, default=7, help="of all noise")
    options = parser.parse_args()
    everything = {}
    for some in (experiments, soft_experiments, camera_experiments, sensor_experiments, contact_experiments, touch_experiments, beam_experiments,
                 rubber_experiments):
        everything |= some()
    # in this order: a case's place in it is its seed
    listed = itertools.chain.from_iterable(cases(everything, lists) for lists in (RIGID, SOFT, CAMERA, SENSOR, CONTACT, TOUCH, BENT, RUBBER))
    for number, (name, experiment, effects, nominal, wanted, kind, named) in enumerate(listed):
        if not name.startswith(options.only) or (options.quick and name not in QUICK):
            continue
        found, strength = at_strength(experiment, effects, nominal, wanted)
        if kind == "single" and strength < 0.8 * wanted or kind == "retune" and strength < STRENGTHS[0]:
            print(name, "is left out: at most", round(strength, 1), "times the noise", flush=True)
            continue
        truth = {"kind": kind, "strength": wanted if strength > 0.8 * wanted else round(strength, 1), "source": "independent"}
        if experiment.body:
            truth |= {"body": experiment.body, "phases": experiment.phases}
        alike = look_alikes(experiment, found) if kind == "single" else []
        truth["effects"] = [{"name": effect, "target": target or experiment.target, "parameters": found[effect], "accept": accept + alike}
                            for effect, (target, accept) in named.items()]
        write_case(options.folder / name, experiment, found, truth, np.random.default_rng([options.seed, number]))
        print(name, flush=True)
    for e, (place, experiment) in enumerate(everything.items()):
        for i in range(options.nulls):
            name = f"{place}_null_{i}"
            if not name.startswith(options.only) or (options.quick and name not in QUICK):
                continue
            truth = {"kind": "null", "strength": 0, "source": "independent", "effects": []}
            write_case(options.folder / name, experiment, {}, truth, np.random.default_rng([options.seed + 1, e, i]))
    for c, (place, control) in enumerate(CONTROLS):
        for i in range(options.controls):
            name = f"{place}_control_{control.__name__}_{i}"
            if not name.startswith(options.only) or options.quick:
                continue
            truth = {"kind": "control", "strength": 0, "source": "independent", "effects": []}
            write_case(options.folder / name, everything[place], {}, truth, np.random.default_rng([options.seed + 2, c, i]), control)
            print(name, flush=True)


if __name__ == "__main__":
    main()
