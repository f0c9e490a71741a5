#!/bin/sh
# Makes .venv-policy: the Python package phyvisgen of pipeline/python with what it needs, for `phyvisgen evaluate policy`
# and for the tests of the package.
set -eu
cd "$(dirname "$0")/.."
scripts/python_env.sh policy numpy gymnasium h5py "websockets>=13" msgpack setuptools wheel
# the sources themselves: what is changed there is what runs
.venv-policy/bin/python -c 'import phyvisgen' 2>/dev/null ||
  .venv-policy/bin/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e pipeline/python
