#!/bin/sh
# README and guide as a newcomer meets them: a clone of the last commit, where nothing is built, runs scripts/demo.sh and
# then every command of the pages as it stands, those too that need a network. Some 40 minutes on two cores.
set -eu
cd "$(dirname "$0")/.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
git clone --quiet . "$folder/phyvisgen"
cd "$folder/phyvisgen"
scripts/demo.sh
scripts/apt_install.sh python3-h5py # what the README's lines of Python need
tests/documentation/run_commands.py --all . build/bin/phyvisgen
echo "test_documentation: every command of README and guide runs as it stands"
