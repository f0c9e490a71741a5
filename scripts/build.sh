#!/bin/sh
# Builds everything into build/. Arguments go to cmake, such as -DPVG_TESTS=OFF.
set -eu
cd "$(dirname "$0")/.."
echo "build: configuring"
mkdir -p build
cmake -S . -B build -G Ninja "$@" >build/configure.log 2>&1 || { cat build/configure.log >&2; exit 1; }
echo "build: compiling with $(nproc) jobs"
cmake --build build -j "$(nproc)"
