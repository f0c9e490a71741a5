#!/bin/sh
# Makes .venv-pack: Python with pyarrow, which `phyvisgen pack --format lerobot` writes Parquet with.
set -eu
cd "$(dirname "$0")/.."
scripts/python_env.sh pack pyarrow
