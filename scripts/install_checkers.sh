#!/bin/sh
# Makes .venv-checkers: PyPI's checkers of LeRobot sets, for scripts/check_lerobot_checkers.sh. lerobot-lint imports lerobot
# itself, so it comes only where scripts/install_lerobot.sh has made .venv-train, whose packages it uses.
set -eu
cd "$(dirname "$0")/.."
scripts/python_env.sh checkers "lerobot-doctor==0.2.0" "robovet==0.2.2"
if [ -x .venv-train/bin/python ]; then
  export PYTHON="$PWD/.venv-train/bin/python"
  scripts/python_env.sh lint setuptools
  .venv-lint/bin/python - "$("$PYTHON" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')" <<'PYTHON'
import sys
import sysconfig
from pathlib import Path

Path(sysconfig.get_path("purelib"), "train.pth").write_text(sys.argv[1] + "\n")
PYTHON
  .venv-lint/bin/pip install --quiet --disable-pip-version-check "lerobot-lint==0.1.1"
else
  echo "install: without .venv-train (scripts/install_lerobot.sh, up to 5.6 GB) there is no lerobot-lint"
fi
