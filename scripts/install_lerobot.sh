#!/bin/sh
# Makes .venv-train: lerobot with PyTorch, and the packages of pipeline/python, for training and `lerobot-eval`.
# lerobot 0.6.1 needs Python 3.12 or newer (found on the PATH, by pyenv or uv, or named by PYTHON); Debian 12 has 3.11,
# which gets lerobot 0.4.4. Downloads up to 5.6 GB from PyPI the first time.
set -eu
cd "$(dirname "$0")/.."
newest() {
  for python in "${PYTHON:-}" python3.13 python3.12 "$HOME"/.pyenv/versions/3.12*/bin/python3 \
    "$(uv python find 3.12 2>/dev/null || true)"; do
    [ -n "$python" ] || continue
    if "$python" -c 'import sys; sys.exit(sys.version_info < (3, 12))' 2>/dev/null; then
      command -v "$python"
      return
    fi
  done
}
python="$(newest)"
if [ -n "$python" ]; then
  export PYTHON="$python"
  scripts/python_env.sh train "lerobot[training]==0.6.1" h5py setuptools wheel
else
  echo "install: no Python 3.12 was found, so lerobot is 0.4.4"
  scripts/python_env.sh train "lerobot==0.4.4" h5py setuptools wheel
fi
.venv-train/bin/python -c 'import lerobot_env_phyvisgen, lerobot_policy_phyvisgen' 2>/dev/null ||
  .venv-train/bin/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation \
    -e pipeline/python -e pipeline/python/lerobot_env_phyvisgen -e pipeline/python/lerobot_policy_phyvisgen
