#!/bin/sh
# Runs the table of hostile inputs (tests/hostile): wrong options, damaged files, names that leave the folder, outputs
# onto inputs. Each must end with its exit code and one clear sentence, and nothing may be lost.
# Arguments: as tests/hostile/run.py, such as --only render; PVG_PROGRAM names another program than that of build/.
set -eu
cd "$(dirname "$0")/.."
scripts/python_env.sh hostile h5py numpy
exec .venv-hostile/bin/python tests/hostile/run.py "${PVG_PROGRAM:-build/bin/phyvisgen}" "$@"
