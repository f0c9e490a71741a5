#!/bin/sh
# Runs PyPI's checkers of LeRobot sets over a packed set: lerobot-doctor, lerobot-lint and robovet. Fails where one of
# them finds a failure; warnings are shown. Downloads several GB from PyPI the first time (lerobot-lint needs lerobot); not
# part of test.sh. Argument: an episode set; without one a small set is made.
set -eu
cd "$(dirname "$0")/.."
scripts/install_pack.sh
scripts/python_env.sh checkers "lerobot-doctor==0.2.0" "lerobot-lint==0.1.1" "robovet==0.2.2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
set="${1:-$folder/set}"
[ $# -gt 0 ] || build/bin/phyvisgen generate tests/pipeline/small_task/push_beaker.yaml -n 3 --no-render -o "$set"
export HF_HUB_OFFLINE=1 HF_HOME="$folder/hf"
build/bin/phyvisgen pack "$set" --no-pictures --environment-state -o "$folder/data"
code=0
.venv-checkers/bin/lerobot-doctor check "$folder/data" || code=1
.venv-checkers/bin/lelint check "$folder/data" || code=1
.venv-checkers/bin/robovet doctor "$folder/data" || code=1
[ $code = 0 ] && echo "check_lerobot_checkers: passed"
exit $code
