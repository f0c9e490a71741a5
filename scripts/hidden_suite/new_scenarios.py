#!/usr/bin/python3
"""Draws new scenarios and writes them as a user of `diagnose` would: a scene, tables of several rates, what is known of the
clocks, starts, masses and loads. What is wrong stays apart, in OUT/truth, for scripts/hidden_suite/table.py.

    scripts/hidden_suite/new_scenarios.py out/new --cases 30 --seed 1
    scripts/hidden_suite/run_all.sh out/new

Same seed, same files. The truth comes from scenario_models.py, which shares no line with the simulator. An effect is scaled
until what it changes, beyond what other starts would, is 3, 10 or 30 times the noise (root mean square), in the fitted runs or in
the held-out one, whichever is less.
"""
import needed_packages  # first: it says what is missing

import argparse
import copy
import json
import math
import pathlib

import numpy as np

from scenario_systems import SHAPES, SYSTEMS

DROPOUTS = 0.01  # share of samples that are missing
BEFORE = 0.1  # that a motion has gone on for when its recording begins [s]
START_CHANGE = 1e-4  # of a start by which its slopes are found [rad, m and per second]
MOST_MOVED = 100  # of a start in one step [m, m/s, rad, rad/s]: what is farther off is no start, and its motion overflows
TOLERANCE = 0.005  # of a weighed mass, relative
MOST = {"gravity_tilt": 0.15, "payload_mass": 1.0, "latency": 0.1, "actuator_delay": 0.1, "actuator_lag": 0.1, "marker_offset": 0.1, "backlash": 0.2}
SENSORS = {"latency", "marker_offset"}  # effects of the sensors
# kind, strength: one after the other, as often as they are here
PLAN = [("single", 10), ("single", 3), ("null", 0), ("unknown", 30), ("single", 30), ("retune", 10), ("two", 15), ("single", 3), ("single", 10), ("null", 0),
        ("unknown", 10), ("single", 30), ("retune", 30), ("far", 0), ("single", 3), ("two", 30), ("control", 0), ("null", 0), ("single", 10), ("single", 3)]


def states_of(scenario, run, numbers, effects, times):
    """At these times of a run's clock; what was released stood still before, other motions began BEFORE it."""
    numbers = numbers | run.numbers
    begin = 0.0 if run.is_released else BEFORE
    physical = {key: p for key, p in effects.items() if key[0] not in SENSORS}
    return scenario.model.solve(numbers, physical, run.start, np.maximum.accumulate(np.maximum(times + begin, 0)), run.command)


def seen_by(sensor, scenario, run, numbers, effects, times):
    """What the sensor shows at these times without noise [n, n_columns]; a declared latency included."""
    late = sensor.latency
    for (name, target), p in effects.items():
        if target == sensor.columns[0] and name == "latency":
            late += p["latency"]
    states = states_of(scenario, run, numbers, effects, times - late)
    seen = sensor.sees(states)
    for (name, target), p in effects.items():
        if target == sensor.columns[0] and name == "marker_offset":  # in the bar's frame, turned by q about y
            q = states[:, 0]
            seen = seen + np.column_stack([p["x"] * np.cos(q) + p["z"] * np.sin(q), -p["x"] * np.sin(q) + p["z"] * np.cos(q)])
    return seen


def in_noise(scenario, run, numbers, effects):
    """All sensors over one run, in units of their noise."""
    parts = []
    for sensor in scenario.sensors:
        times = np.arange(0, run.length, 2 / sensor.rate)
        parts.append((seen_by(sensor, scenario, run, numbers, effects, times) / sensor.noise).ravel())
    return np.concatenate(parts)


def from_start(run, start):
    moved = copy.copy(run)
    moved.start = tuple(start)
    return moved


def fit_start(scenario, run, told, wanted, start):
    """What the told scene leaves of `wanted` from the start that fits it best, by Gauss and Newton's steps from `start`."""
    simulated = lambda start: in_noise(scenario, from_start(run, start), told, {})
    at = simulated(start)
    for _ in range(8):
        slopes = np.column_stack([(simulated(start + START_CHANGE * unit) - at) / START_CHANGE for unit in np.eye(len(start))])
        step = np.linalg.lstsq(slopes, wanted - at, rcond=None)[0]
        before = np.linalg.norm(wanted - at)
        for share in (1, 0.3, 0.1, 0.03):
            if np.abs(share * step).max() > MOST_MOVED:
                continue
            tried = simulated(start + share * step)
            if np.linalg.norm(wanted - tried) < before:
                start, at = start + share * step, tried
                break
        if np.linalg.norm(wanted - at) > 0.99 * before:
            break
    return wanted - at


class Strength:
    """How far the scene as it is told stays from what nature would show without noise, once its starts are fitted [noise, rms]:
    over all fitted runs or over all held-out ones, whichever is less, since a name takes both to be found and proved."""

    def __init__(self, scenario, told):
        self.scenario, self.told = scenario, told

    def left(self, run, nature, effects):
        starts = [np.array(run.start, float)]
        if not run.is_released:  # or where the told scene would pass through nature's first state from, to first order
            at_first = states_of(self.scenario, run, nature, effects, np.zeros(1))[0, : len(run.start)]
            later = states_of(self.scenario, from_start(run, at_first), self.told, {}, np.zeros(1))[0, : len(run.start)]
            starts.append(2 * at_first - later)
        wanted = in_noise(self.scenario, run, nature, effects)
        return min((fit_start(self.scenario, run, self.told, wanted, start) for start in starts), key=np.linalg.norm)

    def of_role(self, role, nature, effects):
        left = np.concatenate([self.left(run, nature, effects) for run in self.scenario.runs if run.role == role])
        return math.sqrt(np.mean(left**2))

    def of(self, nature, effects):
        return min(self.of_role(role, nature, effects) for role in ("fit", "held_out"))


def scaled(parameters, by):
    return {key: value if key in SHAPES else value * by for key, value in parameters.items()}


def to_strength(change_at, wanted):
    """The factor at which change_at is `wanted`, or the nearest that is possible, and the change there."""
    by, low, high, best = 1.0, 0.0, math.inf, (math.inf, 1.0, 0.0)
    for _ in range(14):
        found = change_at(by)
        best = min(best, (abs(math.log(max(found, 1e-9) / wanted)), by, found))
        if abs(found / wanted - 1) < 0.03:
            break
        low, high = (max(low, by), high) if found < wanted else (low, min(high, by))
        by = by * float(np.clip(wanted / max(found, 1e-9), 0.2, 5))
        if not low < by < high:
            by = (low + high) / 2 if high < math.inf else 2 * low
    return best[1], best[2]


def strong_effect(strength, numbers, effect, wanted):
    name, target, parameters, accept = effect
    largest = max(abs(v) for key, v in parameters.items() if key not in SHAPES)
    most = MOST.get(name, math.inf) / largest
    by, found = to_strength(lambda by: strength.of(numbers, {(name, target): scaled(parameters, min(by, most))}), wanted)
    return scaled(parameters, min(by, most)), found


def truth_of(name, target, parameters, accept):
    return {"name": name, "target": target, "parameters": parameters, "accept": list(accept)}


def draw(rng, scenario, kind, strength):
    """Numbers of nature, effects there, truth; None: this system has none of this kind, or none so strong."""
    told, nature, effects, truth = scenario.numbers, dict(scenario.numbers), {}, {"kind": kind, "strength": strength, "effects": []}
    choose = lambda options: options[rng.integers(len(options))]
    measured = Strength(scenario, told)
    if kind in ("single", "unknown"):
        options = scenario.singles if kind == "single" else [(*u, []) for u in scenario.unknowns]
        effect = choose(options)
        parameters, found = strong_effect(measured, told, effect, strength)
        if abs(found / strength - 1) > 0.2:
            return None
        effects[effect[:2]] = parameters
        truth["hidden" if kind == "unknown" else "effects"] = [truth_of(effect[0], effect[1], parameters, effect[3])]
    elif kind == "two":
        if not scenario.pairs:
            return None
        for name in choose(scenario.pairs):
            effect = next(e for e in scenario.singles if e[0] == name)
            parameters, found = strong_effect(measured, told, effect, strength)
            if abs(found / strength - 1) > 0.2:
                return None
            effects[effect[:2]] = parameters
            truth["effects"].append(truth_of(name, effect[1], parameters, effect[3]))
        truth["strength"] = round(measured.of(told, effects), 1)
    elif kind in ("retune", "far"):
        options = [t for t in scenario.traps if kind == "retune" or t[0] == "retune_drive_stiffness" and scenario.command]
        if not options:
            return None
        name, number, target, share, accept = choose(options)
        if kind == "far":  # a maker's file: much too stiff; nature keeps the number
            told[number] = float(f"{told[number] * rng.uniform(20, 80):.3g}")
            truth["strength"] = round(Strength(scenario, told).of(nature, {}), 1)
        else:
            sign = rng.choice([-1, 1])
            value = lambda by: told[number] * math.exp(sign * min(by * share, 1.5))
            by, found = to_strength(lambda by: measured.of(told | {number: value(by)}, {}), strength)
            if abs(found / strength - 1) > 0.2:
                return None
            nature[number] = float(value(by))
        truth["effects"] = [truth_of(name, target, {"value": nature[number]}, accept)]
        truth["kind"] = "retune"
    return nature, effects, truth


def weigh(rng, scenario, nature, truth):
    """A mass that a scale told to half a per cent: nature's differs, the recording says how far it may. What a run states of
    its own, with a load, is exact. [numbers, priors]"""
    retuned = any(e["name"] in ("retune_mass", "payload_mass") for e in truth["effects"])
    if not scenario.masses or retuned or truth["kind"] == "null" or rng.random() < 0.5:
        return nature, []
    number, body = list(scenario.masses.items())[0]
    off = float(np.clip(rng.normal(0, TOLERANCE), -2 * TOLERANCE, 2 * TOLERANCE))
    truth["also"] = [{"name": "retune_mass", "target": body, "parameters": {"value": nature[number] * (1 + off)}, "accept": []}]
    said = scenario.numbers[number]
    return nature | {number: nature[number] * (1 + off)}, [f"body/{body}/mass: {{value: {said:g} kg, sigma: {said * TOLERANCE:.2g} kg}}"]


def table(sensors, scenario, run, numbers, effects, rng, command, order):
    """Text of one CSV file that holds these sensors, each at its own rate: where one has no sample its cell is empty."""
    stamps = sorted({round(k / sensor.rate, 5) for sensor in sensors for k in range(int(run.length * sensor.rate) + 1)})
    cells = {}
    for sensor in sensors:
        times = np.array([k / sensor.rate for k in range(int(run.length * sensor.rate) + 1)])
        seen = seen_by(sensor, scenario, run, numbers, effects, np.sort(times + rng.normal(0, 1, len(times)) * sensor.jitter))
        seen = seen[order(len(times))] + rng.normal(0, sensor.noise, seen.shape)
        for k, t in enumerate(times):
            if k > 10 and rng.random() < DROPOUTS:
                continue
            for column, value in zip(sensor.columns, seen[k]):
                cells[round(t, 5), column] = f"{value:.6g}"
    columns = [column for sensor in sensors for column in sensor.columns]
    lines = [",".join(["t", *columns, *(["command"] if command else [])])]
    for t in stamps:
        lines.append(",".join([f"{t:.5f}", *(cells.get((t, column), "") for column in columns), *([f"{command(t)[0]:.8g}"] if command else [])]))
    return "\n".join(lines) + "\n"


def channel_text(sensor):
    columns = f"column: {sensor.columns[0]}" if len(sensor.columns) == 1 else f"columns: [{', '.join(sensor.columns)}]"
    file = '"{run}_camera.csv"' if sensor.own_file else ""
    parts = [*([f"file: {file}"] if file else []), columns, sensor.yaml, f"unit: {sensor.unit}",
             f"noise: {sensor.noise:.4g}" if sensor.noise_is_told else "noise: unknown",
             *([f"latency: {sensor.latency * 1000:g} ms"] if sensor.latency else []),
             *([f"jitter: {sensor.jitter * 1000:.3g} ms"] if sensor.jitter and sensor.noise_is_told else [])]
    return "  - {" + ", ".join(parts) + "}"


def write_case(folder, scenario, nature, effects, priors, rng, noise, is_control):
    """rng: of what the user tells; noise: of what the sensors add."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.yaml").write_text(scenario.scene(scenario.numbers))
    lines = ["schema: 1", "scene: scene.yaml", "runs:"]
    # a control: what was measured has nothing to do with the time, or was measured beside the command of another run
    is_shuffled = is_control and rng.random() < 0.5
    order = (lambda n: noise.permutation(n)) if is_shuffled else (lambda n: np.arange(n))
    commands = [run.command for run in scenario.runs]
    if is_control and not is_shuffled:
        commands = commands[1:] + commands[:1]
    tells_start = rng.random() < 0.6
    for i, run in enumerate(scenario.runs):
        main = [sensor for sensor in scenario.sensors if not sensor.own_file]
        (folder / f"run_{i}.csv").write_text(table(main, scenario, run, nature, effects, noise, commands[i], order))
        for sensor in (sensor for sensor in scenario.sensors if sensor.own_file):
            (folder / f"run_{i}_camera.csv").write_text(table([sensor], scenario, run, nature, effects, noise, None, order))
        told = f", set: {{{', '.join(f'{key}: {value}' for key, value in run.told.items())}}}" if run.told else ""
        if run.is_released and tells_start:
            told += f", initial: {{{', '.join(f'{key}: 0' for key in scenario.rates)}}}"
        lines.append(f"  - {{file: run_{i}.csv, role: {run.role}{told}}}")
    if scenario.command:
        lines += ["inputs:", f"  - {{column: command, target: {scenario.command}, unit: {scenario.command_unit}}}"]
    lines += ["channels:", *(channel_text(sensor) for sensor in scenario.sensors)]
    lines += ["priors:", *(f"  {prior}" for prior in priors)] if priors else []
    (folder / "recording.yaml").write_text("\n".join(lines) + "\ninitial: first_sample\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--cases", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--noise", type=int, default=0, help="seed of the noise alone: other numbers, the same scenarios")
    options = parser.parse_args()
    (options.folder / "truth").mkdir(parents=True, exist_ok=True)
    for number in range(options.first, options.first + options.cases):
        kind, strength = PLAN[number % len(PLAN)]
        for attempt in range(30):
            rng = np.random.default_rng([options.seed, number, attempt])
            scenario = SYSTEMS[rng.integers(len(SYSTEMS))](rng)
            for sensor in scenario.sensors:
                sensor.noise_is_told = rng.random() < 0.75
            if kind == "control" and not scenario.command:
                continue
            drawn = draw(rng, scenario, kind, strength)
            if drawn:
                break
        nature, effects, truth = drawn
        nature, priors = weigh(rng, scenario, nature, truth)
        label = "_and_".join(e["name"] for e in truth["effects"]) or truth.get("hidden", [{"name": kind}])[0]["name"]
        name = f"{number:03d}_{scenario.name}_{label}" + (f"_{strength}x" if strength else "")
        write_case(options.folder / "cases" / name, scenario, nature, effects, priors, rng, np.random.default_rng([options.seed, number, 1000 + options.noise]),
                   kind == "control")
        (options.folder / "truth" / f"{name}.json").write_text(json.dumps({"schema": 1, **truth}, indent=1) + "\n")
        print(name, flush=True)


if __name__ == "__main__":
    main()
