#!/usr/bin/env python3
"""How much the verdicts of a suite depend on the constants of host/identify/criteria.hpp: each is varied up and down,
and the cases whose verdict or named effects turn are printed.

    scripts/perturb_criteria.py PROGRAM SUITE WORK [--by 0.2] [--only NAME ...] [--stages 6 7] [--simulate]

PROGRAM: build/bin/phyvisgen. SUITE: a folder of cases, such as data/hidden. WORK: a folder for reports and simulated
results; what is there already is used again. A varied diagnosis reads the results of the usual one. Where it needs
another simulation it counts as open, unless --simulate is given, which takes minutes for each case: so does a case that
turns to `none`, which asks for a law. An interrupted run has printed the rows that were finished; --skip-to NAME
continues.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import shutil
import subprocess
import sys

JOURNAL = "simulated.bin"


def diagnose(program, case, folder, *options):
    """the report; None where a simulation is missing; the message where the diagnosis fails"""
    folder.mkdir(parents=True, exist_ok=True)
    done = subprocess.run([program, "diagnose", str(case), "-o", str(folder), "--keep-simulations", "--jobs", "1",
                           *options], capture_output=True, text=True)
    if done.returncode == 0:
        return json.loads((folder / "report.json").read_text())
    if "--no-simulation" in options and "needs a simulation" in done.stderr:
        return None
    return done.stderr.strip().splitlines()[-1]


def outcome(report):
    """what a reader acts on: the verdict and what is named; None: open"""
    if report is None or isinstance(report, str):
        return report and f"fails ({report})"
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


def vary(program, case, work, criterion, value, simulate):
    """the outcome of a case with another value of a criterion; the usual journal is linked, or copied to be extended"""
    folder = work / "varied" / case.name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    usual = work / "usual" / case.name / JOURNAL
    (shutil.copyfile if simulate else os.link)(usual, folder / JOURNAL)
    options = ["--set-criterion", f"{criterion}={value!r}"] + ([] if simulate else ["--no-simulation"])
    return outcome(diagnose(program, case, folder, *options))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program")
    parser.add_argument("suite", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--by", type=float, default=0.2)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--stages", nargs="*", type=int, default=[])
    parser.add_argument("--simulate", action="store_true")
    parser.add_argument("--skip-to", default="")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="cases at once")
    a = parser.parse_args()
    table = json.loads(subprocess.run([a.program, "diagnose", "--list-criteria", "--json"], check=True,
                                      capture_output=True, text=True).stdout)["criteria"]
    table = [c for c in table if (not a.only or c["name"] in a.only) and (not a.stages or c["stage"] in a.stages)]
    names = [c["name"] for c in table]
    table = table[names.index(a.skip_to) if a.skip_to else 0:]
    cases = sorted(path.parent for path in a.suite.glob("*/recording.yaml"))
    pool = concurrent.futures.ThreadPoolExecutor(a.jobs)

    def usual_of(case):
        folder = a.work / "usual" / case.name
        kept = folder / "report.json"
        found = outcome(json.loads(kept.read_text()) if kept.exists() else diagnose(a.program, case, folder))
        print(f"{case.name}: {found}", file=sys.stderr, flush=True)
        return found

    usual = list(pool.map(usual_of, cases))
    print("| criterion | stage | value | varied to | same | open | turned |")
    print("|---|---|---|---|---|---|---|")
    for criterion in table:
        for factor in (1 - a.by, 1 + a.by):
            value = varied(criterion, factor)
            if value is None or value == criterion["value"]:
                continue
            found = list(pool.map(
                lambda case: vary(a.program, case, a.work, criterion["name"], value, a.simulate), cases))
            turned = [f"{case.name}: {new}" for case, old, new in zip(cases, usual, found) if new not in (None, old)]
            n_open = found.count(None)
            print(f"| {criterion['name']} | {criterion['stage']} | {criterion['value']:g} | {value:g} | "
                  f"{len(cases) - n_open - len(turned)} | {n_open} | {'; '.join(turned)} |", flush=True)


if __name__ == "__main__":
    main()
