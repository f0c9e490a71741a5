#!/bin/sh
# A policy behind openpi-client's own messages (its packing of arrays, its action chunks) is evaluated in the loop: what
# our client sends, their code reads, and the other way round. openpi-client wants numpy below 2: .venv-openpi.
set -eu
cd "$(dirname "$0")/.."
scripts/python_env.sh openpi "openpi-client==0.1.2" gymnasium h5py "websockets>=13" msgpack
PHYVISGEN_PROGRAM="$(realpath "${1:-build/bin/phyvisgen}")" PYTHONPATH=pipeline/python \
  .venv-openpi/bin/python scripts/check_openpi.py
