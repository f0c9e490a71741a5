#!/usr/bin/env python3
"""Holds two rules of the sources: constants that decide a diagnosis are in host/identify/criteria.hpp alone, and files
that a comment of a kernel cites exist.

    scripts/check_criteria.py [FOLDER]      FOLDER: of the project; exit code 1 where a rule is broken
"""
import pathlib
import re
import sys

# constants of host/identify that decide nothing: {file: {name: what it is}}
ALLOWED = {
    "data/noise.cpp": {"TYPICAL": "sigma of a normal distribution over the median of its size"},
    "data/warnings.cpp": {"TURN": "2 pi"},
    "fit/held_out.hpp": {"CURVES_OF_FITTED_RUNS": "curves in a report"},
    "fit/limits.cpp": {"N_BETWEEN": "steps of a bisection"},
    "report/report.cpp": {"MOST_ALTERNATIVES": "names in a sentence"},
    "report/report_html.cpp": {"WIDTH": "layout"},
    "search/diagnosis.cpp": {"UNMOVED": "rounding, shown as 0"},
    "sensing/forked.cpp": {"LOOK_EVERY": "polling of signals"},
    "sensing/rollout.cpp": {"MOST_WORLDS": "size of a batch", "MOST_NODES": "size of a batch"},
    "sensing/video_sight.cpp": {"N_PATHS": "samples of a picture", "MOST_SAMPLES": "samples of a picture",
                                "MOST_KEPT": "memory"},
}
# files whose constants are not in the table yet
NOT_YET = ("candidates/", "sensing/sensor.cpp")
CONSTANT = re.compile(r"^\s*(?:inline )?constexpr (?:double|float|int|std::size_t) (\w+)", re.M)
CITED = re.compile(r"\b((?:[a-z_]+/)+[a-z_0-9]+\.(?:cl|h|hpp|cpp|md|py))\b")


def constants(root):
    folder = root / "host/identify"
    for path in sorted(folder.rglob("*.?pp")):
        name = path.relative_to(folder).as_posix()
        if name.startswith("criteria.") or name.startswith(NOT_YET):
            continue
        for constant in CONSTANT.findall(path.read_text()):
            if constant not in ALLOWED.get(name, {}):
                yield f"host/identify/{name}: {constant} is a constant outside of criteria.hpp"


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
