#!/usr/bin/env python3
"""How much the verdicts of a suite depend on the constants of host/identify/criteria.hpp: each is varied up and down,
and the cases whose verdict or named effects turn are printed.

    scripts/perturb_criteria.py PROGRAM SUITE WORK [--by 0.2] [--only NAME ...] [--stages 6 7] [--simulate]

PROGRAM: build/bin/phyvisgen. SUITE: a folder of cases, such as data/hidden. WORK: a folder for reports and simulated
results; what is there already is used again. A varied diagnosis reads the results of the usual one. Where it needs
another simulation it counts as open, unless --simulate is given, which takes minutes for each case.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys


def diagnose(program, case, folder, *options):
    """the report, or None where it ended without one"""
    folder.mkdir(parents=True, exist_ok=True)
    done = subprocess.run([program, "diagnose", str(case), "-o", str(folder), "--keep-simulations", *options],
                          capture_output=True, text=True)
    if done.returncode == 0:
        return json.loads((folder / "report.json").read_text())
    if "--no-simulation" in options and "needs a simulation" in done.stderr:
        return None
    sys.exit(f"{case.name} {' '.join(options)}: {done.stderr.strip()}")


def outcome(report):
    """what a reader acts on: the verdict and what is named"""
    names = sorted(f"{effect['name']} at {effect['target']}" for effect in report["effects"])
    return report["verdict"] + (": " + " + ".join(names) if names else "")


def varied(criterion, factor):
    """the value, or None where a count does not change"""
    value = criterion["value"] * factor
    if not criterion["is_count"]:
        return value
    step = round(value)
    if step == criterion["value"]:
        step = criterion["value"] + (1 if factor > 1 else -1)  # the least change of a count
    return step if step >= 1 else None


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program")
    parser.add_argument("suite", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--by", type=float, default=0.2)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--stages", nargs="*", type=int, default=[])
    parser.add_argument("--simulate", action="store_true")
    a = parser.parse_args()
    table = json.loads(subprocess.run([a.program, "diagnose", "--list-criteria", "--json"], check=True,
                                      capture_output=True, text=True).stdout)["criteria"]
    table = [c for c in table if (not a.only or c["name"] in a.only) and (not a.stages or c["stage"] in a.stages)]
    cases = sorted(path.parent for path in a.suite.glob("*/recording.yaml"))
    usual = {}
    for case in cases:
        folder = a.work / "usual" / case.name
        kept = folder / "report.json"
        report = json.loads(kept.read_text()) if kept.exists() else diagnose(a.program, case, folder)
        usual[case.name] = outcome(report)
        print(f"{case.name}: {usual[case.name]}", file=sys.stderr, flush=True)
    print("| criterion | stage | value | varied to | same | open | turned |")
    print("|---|---|---|---|---|---|---|")
    for criterion in table:
        for factor in (1 - a.by, 1 + a.by):
            value = varied(criterion, factor)
            if value is None or value == criterion["value"]:
                continue
            same, open_cases, turned = 0, 0, []
            for case in cases:
                folder = a.work / "varied" / case.name
                shutil.rmtree(folder, ignore_errors=True)
                shutil.copytree(a.work / "usual" / case.name, folder)
                options = ["--set-criterion", f"{criterion['name']}={value!r}"]
                options += [] if a.simulate else ["--no-simulation"]
                report = diagnose(a.program, case, folder, *options)
                if report is None:
                    open_cases += 1
                elif outcome(report) == usual[case.name]:
                    same += 1
                else:
                    turned.append(f"{case.name}: {outcome(report)}")
            print(f"| {criterion['name']} | {criterion['stage']} | {criterion['value']:g} | {value:g} | {same} | "
                  f"{open_cases} | {'; '.join(turned)} |", flush=True)


if __name__ == "__main__":
    main()
