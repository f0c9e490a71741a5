#!/usr/bin/python3
"""Does the motion that `diagnose --next` plans separate the names that the recordings leave confused? Each case is diagnosed,
the planned motion is done by the independent model with the noise that is declared, added as a run, and diagnosed again.

    scripts/hidden_suite/separate_names.py out/separate --program build/bin/phyvisgen
    scripts/hidden_suite/separate_names.py out/separate --only bounces_payload,ball_constant_force

Prints a row per case: what was named, what could not be told from it, the motion and the separation that it predicts, and the
same after it. Names of the same law, or of one that contains it, do not count as confused. A case with a row in OUT/rows is not
done again. Cases: confused_cases.py.
"""
import needed_packages  # first: it says what is missing

import argparse
import json
import math
import pathlib
import resource
import subprocess
import zlib

import numpy as np

from confused_cases import CASES
from new_scenarios import Strength, strong_effect, table, to_strength, truth_of, write_case
from scenario_systems import Run
from table import is_in_set, named, says


def wilson(k, n, z=1.96):
    middle, half = (k / n + z * z / (2 * n)), z * math.sqrt(k / n * (1 - k / n) / n + z * z / (4 * n * n))
    return (middle - half) / (1 + z * z / n), (middle + half) / (1 + z * z / n)


def write_first(folder, name, seed):
    """The case with the runs that leave names confused: its scenario, nature's numbers and effects, and the truth."""
    make, effect_name, target, strength, same = CASES[name]
    rng = np.random.default_rng([seed, zlib.crc32(name.encode())])
    scenario, effect = make(rng, effect_name, target, same)
    told, nature, effects = scenario.numbers, dict(scenario.numbers), {}
    measured = Strength(scenario, told)
    if effect_name.startswith("retune_"):
        ((number, share),) = effect[2].items()
        value = lambda by: told[number] * math.exp(by * share)
        by, found = to_strength(lambda by: measured.of(told | {number: value(by)}, {}), strength)
        nature[number] = float(value(by))
        parameters = {"value": nature[number]}
    else:
        parameters, found = strong_effect(measured, told, effect, strength)
        effects = {effect[:2]: parameters}
    truth = {"strength": round(found, 1), "effects": [truth_of(effect[0], effect[1], parameters, effect[3])]}
    write_case(folder, scenario, nature, effects, [], rng, np.random.default_rng([seed, 1]), False)
    return scenario, nature, effects, truth


def motion_of(scenario, planned):
    """The planned run as the independent model takes it: start, command, load."""
    start = np.zeros(len(scenario.runs[0].start))
    state = {key: k for k, key in enumerate(scenario_states(scenario))}
    for key, value in planned["initial"].items():
        if key in state:
            numbers = value[: 2 if scenario.name == "slide" else 3] if isinstance(value, list) else [value]
            start[state[key] : state[key] + len(numbers)] = numbers
    run = Run(tuple(start), planned["seconds"], role="fit", is_released=True)
    if scenario.command:
        (one,) = planned["commands"].values()
        times, values = np.array(one["time"]), np.array(one["value"])
        slope = np.diff(values) / np.diff(times)
        at = lambda t: min(max(int(np.searchsorted(times, t, side="right")) - 1, 0), len(slope) - 1)
        run.command = lambda t: (float(np.interp(t, times, values)), float(slope[at(t)]) if 0 < t < times[-1] else 0.0)
    return run


def scenario_states(scenario):
    """Keys of a start in the order of the model's states; a body's are three numbers each."""
    if scenario.name == "flight":
        return ["body/ball/position", "", "", "body/ball/velocity"]
    if scenario.name == "slide":
        return ["body/block/position", "", "body/block/velocity"]
    joints = [key.split("/")[1] for key in scenario.rates]
    return [f"joint/{j}/position" for j in joints] + [f"joint/{j}/velocity" for j in joints]


def add_run(folder, scenario, nature, effects, planned, number, rng):
    """Does the planned motion and adds it to the recording."""
    run = motion_of(scenario, planned)
    file = f"run_next_{number}.csv"
    nature = dict(nature)
    for key, value in planned.get("set", {}).items():
        kind, target, quantity = key.split("/")
        effects = loaded(scenario, nature, effects, target, value) if quantity == "load" else effects
    (folder / file).write_text(table(scenario.sensors, scenario, run, nature, effects, rng, run.command, lambda n: np.arange(n)))
    told = f", set: {{{', '.join(f'{k}: {v}' for k, v in planned['set'].items())}}}" if planned.get("set") else ""
    if not scenario.name in ("flight", "slide"):
        told += f", initial: {{{', '.join(f'{key}: 0' for key in scenario.rates)}}}"
    text = (folder / "recording.yaml").read_text()
    before, after = text.split("inputs:" if "inputs:" in text else "channels:", 1)
    (folder / "recording.yaml").write_text(f"{before}  - {{file: {file}, role: fit{told}}}\n{'inputs:' if 'inputs:' in text else 'channels:'}{after}")


def loaded(scenario, nature, effects, target, load):
    """Nature with a load in one run: numbers are changed in place, or a payload is there beside the effects."""
    if scenario.name in ("flight", "slide"):
        nature["mass"] += load
        return effects
    key = ("payload_mass", target)
    return effects | {key: {"mass": effects.get(key, {"mass": 0.0})["mass"] + load}}


def diagnose(program, folder, report, minutes):
    report.mkdir(parents=True, exist_ok=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run([program, "diagnose", folder, "-o", report, "--jobs", "1", "--minutes", str(minutes), "--next"], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    (report / "log.txt").write_text(done.stdout)
    if not (report / "report.json").exists():
        raise SystemExit(f"{folder}: no report; {done.stdout[-300:]}")
    return json.loads((report / "report.json").read_text()), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def summary(truth, report):
    names, (effect,) = named(report), truth["effects"]
    told = names + [label for one in report["inseparable"] for label in one if label not in names]
    return {"verdict": report["verdict"], "named": names, "is_right": bool(names) and all(says(effect, n) for n in names),
            "is_in_set": is_in_set(truth, report), "confused": [label for label in told if not says(effect, label)],
            "same": [label for label in told[len(names):] if says(effect, label)], "next": report["next_experiment"]}


def do_case(out, name, options):
    folder = out / "cases" / name
    scenario, nature, effects, truth = write_first(folder, name, options.seed)
    row = {"case": name, "truth": truth, "rounds": []}
    for number in range(options.motions + 1):
        report, seconds = diagnose(options.program, folder, out / "reports" / f"{name}_{number}", options.minutes)
        row["rounds"].append(summary(truth, report) | {"seconds": round(seconds, 1)})
        planned = report.get("next_run")
        if number == options.motions or not planned or not row["rounds"][-1]["confused"]:
            break
        row["rounds"][-1]["next_run"] = {key: planned[key] for key in ("initial", "set", "seconds")}
        add_run(folder, scenario, nature, effects, planned, number, np.random.default_rng([options.seed, 2 + number]))
    return row


def print_rows(rows):
    for row in rows:
        effect = row["truth"]["effects"][0]
        print(f"{row['case']}: truth {effect['name']} at {effect['target']}, {row['truth']['strength']}x")
        for r in row["rounds"]:
            print(f"   {'right' if r['is_right'] else 'in set' if r['is_in_set'] else 'wrong'}: {r['verdict']} {' + '.join(r['named'])}; confused with it: "
                  f"{', '.join(r['confused']) or '-'}; {r['seconds']} s; next: {r['next'] or '-'}")
    confused = [row for row in rows if row["rounds"][0]["confused"]]
    separated = [row for row in confused if len(row["rounds"]) > 1 and not row["rounds"][-1]["confused"] and row["rounds"][-1]["is_right"]]
    if confused:
        low, high = wilson(len(separated), len(confused))
        print(f"{len(confused)} of {len(rows)} cases with names confused; separated, and the true one named: {len(separated)} "
              f"(95 % interval of the rate {100 * low:.0f} to {100 * high:.0f} %)")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--program", default="build/bin/phyvisgen")
    parser.add_argument("--only", default=",".join(CASES), help="names of cases, with commas between")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=5, help="of each diagnosis, as of `diagnose`")
    parser.add_argument("--motions", type=int, default=1, help="planned motions that are done one after the other at most")
    options = parser.parse_args()
    (options.folder / "rows").mkdir(parents=True, exist_ok=True)
    for name in options.only.split(","):
        file = options.folder / "rows" / f"{name}.json"
        if not file.exists():
            file.write_text(json.dumps(do_case(options.folder, name, options), indent=1) + "\n")
        print_rows([json.loads(file.read_text())])
    print_rows([json.loads(p.read_text()) for p in sorted((options.folder / "rows").glob("*.json"))])


if __name__ == "__main__":
    main()
