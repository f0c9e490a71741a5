#!/usr/bin/python3
"""Prints the scores of diagnosed cases: shares with Wilson's 95 % intervals, seconds, and each case that is not as its truth.

    scripts/hidden_suite/table.py SUITE REPORTS [--minutes 5]

The truth of a case is SUITE/truth/CASE.json or SUITE/CASE/truth.json: kind, strength, effects with other names that say the
same (`accept`), and what may be named besides (`also`).
"""
import argparse
import json
import math
import pathlib
import statistics

SPARE = 10  # beyond --minutes, for the report [s]


def load(path):
    return json.loads(path.read_text()) if path.exists() else None


def cases_of(suite, reports):
    """Name, truth, report (None: there is none), wall and processor time [s] of each case."""
    truths = {p.stem: p for p in (suite / "truth").glob("*.json")} or {p.parent.name: p for p in suite.glob("*/truth.json")}
    for name, path in sorted(truths.items()):
        report = load(reports / name / "report.json")
        file = reports / name / "seconds.txt"  # as run_all.sh writes it: wall, user, system
        text = file.read_text().split() if file.exists() else []
        wall, *processor = map(float, text) if text else ((report or {}).get("seconds", math.nan),)
        yield name, load(path), report, wall, sum(processor) if processor else math.nan


OF_SENSORS = {"latency", "marker_offset", "bias"}  # the report calls their targets by channel, the truth by column


def says(effect, label):
    """Whether `name at target` of a report is this effect, or another name for it; those that are accepted may have a target."""
    name = label.split(" at ")[0]
    if name == effect["name"] and (name in OF_SENSORS or "target" not in effect or label == f"{name} at {effect['target']}"):
        return True
    return name in effect.get("accept", []) or label in effect.get("accept", [])


def named(report):
    return [f"{effect['name']} at {effect['target']}" for effect in report["effects"]]


def is_named_first(truth, report):
    names, wanted = named(report), truth["effects"] + truth.get("also", [])
    return bool(names) and any(says(e, names[0]) for e in truth["effects"]) and all(any(says(e, n) for e in wanted) for n in names)


def is_whole(truth, report):
    return is_named_first(truth, report) and all(any(says(e, n) for n in named(report)) for e in truth["effects"])


def is_in_set(truth, report):
    told = named(report) + [label for one in report["inseparable"] for label in one]
    return bool(named(report)) and all(any(says(e, n) for n in told) for e in truth["effects"])


def intervals(truth, report):
    """Whether each interval of two standard deviations holds the truth, of numbers that are named as in the truth."""
    for effect in truth["effects"] + truth.get("also", []):
        for found in report["effects"]:
            if found["name"] == effect["name"] and found["target"] == effect["target"]:
                for key, p in found["parameters"].items():
                    value = effect["parameters"].get(key, None if key.startswith("velocity") else 0.0)
                    if value is not None:
                        yield p["low"] <= value <= p["high"]


def share(flags):
    """k of n with Wilson's interval."""
    flags = list(flags)
    n, k, z = len(flags), sum(flags), 1.96
    if n == 0:
        return "no case"
    middle, half = (k / n + z * z / (2 * n)) / (1 + z * z / n), z / (1 + z * z / n) * math.sqrt(k / n * (1 - k / n) / n + z * z / (4 * n * n))
    return f"{k} of {n}, {100 * k / n:.0f} % [{100 * max(middle - half, 0):.0f}, {100 * min(middle + half, 1):.0f}]"


def rows(cases, minutes):
    done = [(truth, report) for _, truth, report, *_ in cases if report]
    pick = lambda test: [(truth, report) for truth, report in done if test(truth)]
    single = lambda low, high: pick(lambda t: t["kind"] == "single" and low <= t["strength"] < high)
    whole = [r["held_out"]["whole_runs"]["gap_closed"] for _, r in done if r["effects"] and "gap_closed" in r["held_out"].get("whole_runs", {})]
    yield "right name first, 10x and 30x", ">= 95 %", share(is_named_first(t, r) for t, r in single(9, 1e9))
    yield "right name first, 3x", ">= 80 %", share(is_named_first(t, r) for t, r in single(0, 9))
    yield "true name in the stated set, all singles", "", share(is_in_set(t, r) for t, r in single(0, 1e9))
    yield "nulls and controls named", "<= 2 %", share(bool(r["effects"]) for t, r in pick(lambda t: t["kind"] in ("null", "control")))
    yield "nulls that agree", "", share(r["verdict"] == "agrees" for t, r in pick(lambda t: t["kind"] == "null"))
    yield "`agrees` above twice the noise", "0", share(r["verdict"] == "agrees" for t, r in pick(lambda t: t["strength"] > 2))
    yield "unknown effects declined", ">= 90 %", share(not r["effects"] for t, r in pick(lambda t: t["kind"] in ("unknown", "off_library")))
    yield "unknown effects declined or told as explained in part", "", share(
        not r["effects"] or "partly" in r["sentence"] for t, r in pick(lambda t: t["kind"] in ("unknown", "off_library")))
    traps = pick(lambda t: t["kind"] == "retune")
    yield "traps named as effects", "<= 5 %", share(r["verdict"] == "effect" for _, r in traps)
    yield "traps: the right number", "", share(is_named_first(t, r) for t, r in traps)
    yield "two effects, both named", ">= 85 %", share(is_whole(t, r) for t, r in pick(lambda t: t["kind"] == "two"))
    yield "two effects, one of them named first", "", share(is_named_first(t, r) for t, r in pick(lambda t: t["kind"] == "two"))
    right = [(t, r) for t, r in done if t["effects"] and is_whole(t, r)]
    yield "intervals that hold the truth", ">= 90 %", share(flag for t, r in right for flag in intervals(t, r))
    yield "gap of whole held-out runs closed, median", ">= 95 %", f"{100 * statistics.median(whole):.1f} % ({len(whole)} cases)" if whole else "no case"
    yield f"report within {minutes:g} minutes and {SPARE} s", "always", share(report is not None and not wall > 60 * minutes + SPARE for *_, report, wall, _ in cases)
    for what, at in (("wall", 3), ("processor", 4)):
        seconds = [case[at] for case in cases if case[2]]
        if seconds:
            yield f"{what} seconds of a case, median, longest", "", f"{statistics.median(seconds):.0f}, {max(seconds):.0f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("suite", type=pathlib.Path)
    parser.add_argument("reports", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, default=5)
    options = parser.parse_args()
    cases = [case for case in cases_of(options.suite, options.reports) if case[2] or not math.isnan(case[3])]  # not those that run
    commit = options.reports / "commit"
    print(f"{len(cases)} cases, commit {commit.read_text().strip() if commit.exists() else 'not known'}\n")
    for what, must, found in rows(cases, options.minutes):
        print(f"{what:55} {must:14} {found}")
    print("\nnot as the truth")
    for name, truth, report, _, processor in cases:
        wanted = " + ".join(e["name"] for e in truth["effects"]) or {"null": "agrees"}.get(truth["kind"], "none")
        if not report:
            print(f"  {name}: no report")
        elif not (is_whole(truth, report) if truth["effects"] else report["verdict"] in ("agrees", "none") and (truth["kind"] != "null" or report["verdict"] == "agrees")):
            print(f"  {name}: {wanted} -> {' + '.join(named(report)) or report['verdict']} ({processor:.0f} s)")


if __name__ == "__main__":
    main()
