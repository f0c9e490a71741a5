#!/bin/sh
# Builds everything into build/. Arguments go to cmake, such as -DPVG_TESTS=OFF. A new folder compiles sources in batches,
# which takes little more than half the time; for work on the sources: -DCMAKE_UNITY_BUILD=OFF.
set -eu
cd "$(dirname "$0")/.."
echo "build: configuring"
mkdir -p build
[ -f build/CMakeCache.txt ] || set -- -DCMAKE_UNITY_BUILD=ON "$@"
cmake -S . -B build -G Ninja "$@" >build/configure.log 2>&1 || { cat build/configure.log >&2; exit 1; }
echo "build: compiling with $(nproc) jobs"
cmake --build build -j "$(nproc)"
