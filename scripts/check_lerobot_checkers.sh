#!/bin/sh
# Runs PyPI's checkers of LeRobot sets over packed sets, those that scripts/install_checkers.sh installed: lerobot-doctor,
# robovet and lerobot-lint. Fails where one of them finds a failure; warnings are shown. Exit code 77 with the reason where
# none is installed. Arguments: the program (build/bin/phyvisgen) and an episode set; without one a small set of pushes is
# made, with pictures. lerobot-lint looks at a set that is named alone: it calls joints that a push does not move dead.
set -eu
root="$(cd "$(dirname "$0")/.." && pwd)"
cd "$root"
checkers=".venv-checkers/bin" lint=".venv-lint/bin/lelint"
if [ ! -x "$checkers/robovet" ] || [ ! -x "$checkers/lerobot-doctor" ]; then
  echo "skipped: lerobot-doctor and robovet are not installed; run scripts/install_checkers.sh"
  exit 77
fi
program="${1:-build/bin/phyvisgen}"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
set="${2:-$folder/set}"
[ $# -gt 1 ] || "$program" generate tests/pipeline/small_task/push_beaker.yaml -n 3 -o "$set"
# the interpreter writes Parquet files, too
export HF_HUB_OFFLINE=1 HF_HOME="$folder/hf" PVG_PYTHON="$root/$checkers/python"
code=0
failed() {
  echo "check_lerobot_checkers: $1 finds failures in the set packed as $2" >&2
  code=1
}
for format in lerobot lerobot2; do
  "$program" pack "$set" --format $format --environment-state -o "$folder/$format"
  "$checkers/lerobot-doctor" check "$folder/$format" || failed lerobot-doctor $format
done
# the older layout, whose readers make the statistics of the set of those of its episodes, holds least deviations on purpose,
# which robovet takes for an error; and lerobot 0.6, with lerobot-lint, reads the newer one alone
"$checkers/robovet" doctor "$folder/lerobot" || failed robovet lerobot
if [ $# -gt 1 ] && [ -x "$lint" ]; then
  "$lint" check "$folder/lerobot" || failed lerobot-lint lerobot
elif [ $# -gt 1 ]; then
  echo "check_lerobot_checkers: lerobot-lint is left out; scripts/install_checkers.sh installs it beside lerobot"
fi
[ $code = 0 ] && echo "check_lerobot_checkers: passed"
exit $code
