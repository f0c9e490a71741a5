#!/bin/sh
# Loads a packed set with lerobot 0.4.4 (3.0) and trains ACT for three steps on one batch; the layout 2.1 is loaded with
# lerobot 0.3.3. Downloads several GB from PyPI into .venv-lerobot and .venv-lerobot2 the first time; not part of test.sh.
# Argument: an episode set; without one a small set is made.
set -eu
cd "$(dirname "$0")/.."
scripts/install_pack.sh
scripts/python_env.sh lerobot "lerobot==0.4.4"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
set="${1:-$folder/set}"
[ $# -gt 0 ] || build/bin/phyvisgen generate tests/pipeline/small_task/push_beaker.yaml -n 3 -o "$set"
# everything is there: a look at the hub would only hide what is missing
export HF_HUB_OFFLINE=1 HF_HOME="$folder/hf"
build/bin/phyvisgen pack "$set" --format lerobot -o "$folder/lerobot"
.venv-lerobot/bin/python scripts/check_lerobot.py "$folder/lerobot"
scripts/python_env.sh lerobot2 "lerobot==0.3.3" "datasets<=3.6.0"
build/bin/phyvisgen pack "$set" --format lerobot2 -o "$folder/lerobot2"
.venv-lerobot2/bin/python scripts/check_lerobot2.py "$folder/lerobot2"
