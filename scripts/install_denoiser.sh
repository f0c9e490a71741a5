#!/bin/sh
# Makes .venv-denoiser with Open Image Denoise, which `render: {denoise: true}` uses where it is there. PyPI's package
# pyoidn holds the library for Linux on x86_64; the program opens libOpenImageDenoise.so.2 in .venv-denoiser/library.
set -eu
cd "$(dirname "$0")/.."
scripts/python_env.sh denoiser pyoidn==2.5.1.0
library=$(find .venv-denoiser/lib -name libOpenImageDenoise.so.2 -exec dirname {} \; | head -n 1)
[ -n "$library" ] || { echo "install: pyoidn brought no libOpenImageDenoise.so.2" >&2; exit 1; }
ln -sfn "${library#.venv-denoiser/}" .venv-denoiser/library
