#!/bin/sh
# Diagnoses the ten hidden-effect cases of data/hidden and prints their table of scores; what is done is kept, so a
# stopped run goes on. Ten to fifteen minutes of computing on one core. Arguments: the folder for the reports, cases at
# once. All cases: scripts/hidden_suite/make_cases.py DIR, then `phyvisgen diagnose --suite DIR`.
set -eu
cd "$(dirname "$0")/.."
build/bin/phyvisgen diagnose --suite data/hidden -o "${1:-out/hidden}" --jobs "${2:-2}"
