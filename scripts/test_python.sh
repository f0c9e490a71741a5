#!/bin/sh
# Tests of the Python package, with the interpreter PVG_PYTHON or that of scripts/install_policy.sh. Exit code 77 with
# the reason where there is none. Argument: the program.
set -eu
root="$(cd "$(dirname "$0")/.." && pwd)"
python="${PVG_PYTHON:-$root/.venv-policy/bin/python}"
if ! "$python" -c 'import numpy, gymnasium, h5py' 2>/dev/null; then
  echo "skipped: $python does not exist or lacks numpy, gymnasium or h5py; run scripts/install_policy.sh"
  exit 77
fi
PHYVISGEN_PROGRAM="$(realpath "${1:-$root/build/bin/phyvisgen}")" PYTHONPATH="$root/pipeline/python" \
  exec "$python" -m unittest discover -s "$root/tests/pipeline/python" -t "$root/tests/pipeline/python"
