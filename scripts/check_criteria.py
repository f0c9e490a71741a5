#!/usr/bin/env python3
"""Holds two rules of the sources: constants that decide a diagnosis are in host/identify/criteria*.hpp alone, and files
that a comment of a kernel cites exist.

    scripts/check_criteria.py [FOLDER]      FOLDER: of the project; exit code 1 where a rule is broken
"""
import pathlib
import re
import sys

# what decides nothing: {file of host/identify: {name of a constant, or the number as it is written: what it is}}
ALLOWED = {
    "channels/accelerometer.cpp": {"PLACE": "layout of a trace"},
    "channels/angular_velocity.cpp": {"BIAS": "layout of a trace"},
    "channels/prediction.cpp": {"4": "steps of a cubic", "1e-6": "rounding of a time"},
    "candidates/law_dictionary.cpp": {"3": "components of a vector"},
    "data/jitter.cpp": {"N_OF_TURN": "components of a quaternion"},
    "data/scene_numbers.cpp": {"1e-9": "rounding of moments"},
    "data/noise.cpp": {"1e-9": "rounding of commands", "TYPICAL": "sigma of a normal distribution over the median of its size"},
    "data/warnings.cpp": {"TURN": "2 pi", "200": "hint", "0.5": "hint", "100": "hint", "57.3": "hint", "10": "hint",
                          "20": "hint", "0.25": "hint", "UNRELATED": "hint", "FEWEST": "hint"},
    "data/start_places.cpp": {"MOST_STEPS": "iterations of an equation that is solved", "DIFFERENCE": "finite difference",
                              "SMALL_STEP": "rounding"},
    "data/start_fit.cpp": {"3": "samples of a parabola", "PARABOLA": "numbers of a polynomial"},
    "fit/fit_trials.cpp": {"LEAST_DAMPING": "rounding of a matrix"},
    "fit/fit_cost.cpp": {"3": "samples of third differences"},
    "fit/held_out.cpp": {"-10.0": "lowest share that is shown"},
    "fit/held_out.hpp": {"CURVES_OF_FITTED_RUNS": "curves in a report"},
    "fit/limits.cpp": {"N_BETWEEN": "steps of a bisection"},
    "report/report.cpp": {"MOST_ALTERNATIVES": "names in a sentence", "LEAST_ON_EARTH": "gravity, for a remark"},
    "report/report_html.cpp": {"WIDTH": "layout", "4": "layout", "12": "layout"},
    "report/score.cpp": {"9.9": "rows of the suite's table"},
    "search/workflow.cpp": {"0.02": "progress", "60": "seconds of a minute"},
    "search/regress.cpp": {"LAW_COMPILATION": "time of a compilation", "SIMULATIONS_PER_LAW": "count of an algorithm"},
    "search/prove.cpp": {"UNMOVED": "rounding, shown as 0"},
    "search/next_experiment.cpp": {"N_COMPARED_AT_ONCE": "size of a batch", "BEYOND": "order of motions that tell the same names apart"},
    "search/motion_family.cpp": {"N_COMMANDS": "points of a table", "0.5": "form of steps", "-0.5": "form of steps"},
    "sensing/forked.cpp": {"LOOK_EVERY": "polling of signals"},
    "sensing/known_predictions.hpp": {"MOST_NUMBERS": "memory"},
    "sensing/rollout.cpp": {"MOST_WORLDS": "size of a batch", "MOST_NODES": "size of a batch"},
    "sensing/world.cpp": {"LARGE_WORLD": "size of a batch"},
    "search/round.cpp": {"SCREENED_AT_ONCE": "size of a batch"},
    "sensing/journal.cpp": {"MAGIC": "head of a file"},
    "sensing/sensor.cpp": {"4": "steps of a cubic", "0.5": "half a step", "-0.5": "half a step"},
    "sensing/video_sight.cpp": {"SEED": "random numbers", "MOST_KEPT": "memory"},
}
PLAIN = {"0", "1", "2", "0.0", "1.0", "2.0", "-1", "1e-300", "1e300"}  # arithmetic
NUMBER = r"-?\d+(?:\.\d*)?(?:e-?\d+)?"
CONSTANT = re.compile(r"^(?:\s*(?:inline )?(?:static )?constexpr|(?:static )?const) [\w:<> ,]*?\b(\w+)(?:\[\])? = \{?%s" % NUMBER)
LITERALS = [re.compile(pattern % {"n": NUMBER}) for pattern in (
    r"[^<>-][<>]=?\s(%(n)s)(?![\w>.])",  # compared with
    r"(?<![\w.])(%(n)s)\s[<>]=?\s",
    r"clamp\([^;]*?,\s*(%(n)s),",
    r"(?:for \([^:;]*:|=)\s*\{(%(n)s),",  # a list
)]
CITED = re.compile(r"\b((?:[a-z_]+/)+[a-z_0-9]+\.(?:cl|h|hpp|cpp|md|py))\b")


def code_of(line):
    """without comments, texts and counts of loops"""
    return re.sub(r"; \w+ < \d+;", ";;", re.sub(r'"(?:[^"\\]|\\.)*"', '""', line).partition("//")[0])


def constants(root):
    folder = root / "host/identify"
    for path in sorted(folder.rglob("*.?pp")):
        name = path.relative_to(folder).as_posix()
        if name.startswith("criteria"):
            continue
        allowed = ALLOWED.get(name, {})
        for number, line in enumerate(path.read_text().splitlines(), 1):
            code = code_of(line)
            constant = CONSTANT.match(code)
            found = {constant.group(1)} if constant else {n for pattern in LITERALS for n in pattern.findall(code)}
            for one in sorted(found - PLAIN - set(allowed)):
                yield f"host/identify/{name}:{number}: {one} is a constant outside of criteria.hpp"


def citations(root):
    bases = [root, root / "kernels", root / "host", root / "kernels/energies"]
    for path in sorted((root / "kernels").rglob("*")):
        if path.suffix not in (".cl", ".h"):
            continue
        for line in path.read_text().splitlines():
            comment = line.partition("//")[2]
            for cited in CITED.findall(comment):
                if not any((base / cited).exists() for base in [*bases, path.parent]):
                    yield f"{path.relative_to(root)} cites {cited}, which does not exist"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    findings = [*constants(root), *citations(root)]
    for finding in findings:
        print(finding, file=sys.stderr)
    if findings:
        sys.exit(1)
    print("criteria: every deciding constant is in the table; every cited file exists")


if __name__ == "__main__":
    main()
