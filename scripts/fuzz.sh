#!/bin/sh
# Fuzzes the readers of records, sets, recordings, scenes, tasks, robots, meshes, splats and captured rooms with
# libFuzzer and the sanitizers, one after the other.
# Arguments: seconds per loader (default 60), then loaders (default all), such as scene_file or mesh_obj. What is found lies
# in build-fuzz/found; the inputs that led somewhere new stay in build-fuzz/corpus, so a later run goes on from there.
set -eu
cd "$(dirname "$0")/.."
seconds="${1:-60}"
[ $# -gt 0 ] && shift
loaders="${*:-states set_json recording scene_file task_file urdf mjcf splats colmap mesh_obj mesh_ply mesh_stl mesh_dae mesh_gltf mesh_glb}"
scripts/install.sh
scripts/apt_install.sh clang-14 libclang-rt-14-dev
mkdir -p build-fuzz/found
echo "fuzz: building, log in build-fuzz/build.log"
targets=""
for loader in $loaders; do targets="$targets fuzz_$loader"; done
{ CC=clang-14 CXX=clang++-14 cmake -S . -B build-fuzz -G Ninja -DPVG_FUZZ=ON -DPVG_TESTS=OFF &&
  ninja -C build-fuzz $targets; } >build-fuzz/build.log 2>&1 || { tail -40 build-fuzz/build.log >&2; exit 1; }
for loader in $loaders; do
  mkdir -p "build-fuzz/corpus/$loader"
  echo "fuzz: $loader for $seconds s"
  # 30 s: what assimp would read without end its process ends after 5 s of computing
  # no search for leaks: what assimp forgets in a refused file is gone with the process
  ASAN_OPTIONS=detect_leaks=0 "build-fuzz/bin/fuzz_$loader" -max_total_time="$seconds" -timeout=30 -rss_limit_mb=2048 -max_len=8192 -detect_leaks=0 \
    -print_final_stats=1 -artifact_prefix="build-fuzz/found/$loader-" "build-fuzz/corpus/$loader" \
    $(ls -d "tests/fuzz/seeds/$loader" 2>/dev/null) >"build-fuzz/$loader.log" 2>&1 || {
    grep -aE 'ERROR|SUMMARY|terminate|what\(\)|Test unit' "build-fuzz/$loader.log" >&2
    echo "fuzz: $loader: found something, see build-fuzz/$loader.log" >&2
    exit 1
  }
  grep -aE 'number_of_executed_units|peak_rss_mb' "build-fuzz/$loader.log"
done
echo "fuzz: nothing found"
