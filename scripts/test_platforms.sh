#!/bin/sh
# Runs the kernels on a second platform: Intel's OpenCL runtime for x86 CPUs, from PyPI. All kernel tests; a pendulum, a
# grasp and a picture, whose numbers are compared with PoCL's; and what a second start costs, with programs kept on disk.
#   test_platforms.sh [FOLDER]    where the runtime goes, 800 MB; build/platforms unless given
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh
tests="test_device test_physics_linear test_physics_energies test_physics_contact test_physics_step test_render"
mkdir -p build
[ -f build/build.ninja ] || cmake -S . -B build -G Ninja -DPVG_TESTS=ON >build/configure.log 2>&1
cmake --build build -j "$(nproc)" --target phyvisgen $tests
scripts/python_env.sh platforms h5py numpy pillow
mkdir -p "${1:-build/platforms}"
folder=$(cd "${1:-build/platforms}" && pwd)

if [ ! -e "$folder/installed" ]; then
  echo "test_platforms: downloading Intel's runtime (270 MB) into $folder"
  .venv-platforms/bin/pip download -q --disable-pip-version-check --no-deps -d "$folder" \
    intel-opencl-rt intel-cmplr-lib-rt 'tbb==2023.*'
  for wheel in "$folder"/*.whl; do python3 -m zipfile -e "$wheel" "$folder"; done
  rm "$folder"/*.whl
  mkdir -p "$folder/vendors"
  find "$folder" -name libintelocl.so >"$folder/vendors/intel.icd"
  touch "$folder/installed"
fi
on_intel() {
  LD_LIBRARY_PATH=$(find "$folder" -path '*.data/data/lib' | paste -sd :) OCL_ICD_VENDORS="$folder/vendors" \
    XDG_CACHE_HOME="$out/cache" "$@"
}

out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
program=build/bin/phyvisgen
on_intel $program devices

make_all() { # $1: folder; the rest: what runs the program
  to=$out/$1
  shift
  mkdir "$to"
  "$@" simulate data/validation/pendulum.yaml -o "$to/pendulum.h5"
  "$@" simulate data/validation/grasp.yaml -o "$to/grasp.h5" --duration 0.4
  "$@" render data/scenes/beaker_on_scale.yaml --width 160 --height 90 --samples 128 -o "$to/picture.png"
}
on_pocl() { "$@" --device "Portable Computing Language"; }
make_all pocl on_pocl $program
make_all intel on_intel $program
.venv-platforms/bin/python scripts/compare_platforms.py "$out/pocl" "$out/intel"

# processor time of a start; the cache is full by now
cpu_of() { # seconds that the command takes of a processor
  .venv-platforms/bin/python -c 'import os, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
print("%.2f" % sum(os.times()[2:4]))' "$@"
}
short="$program simulate data/validation/pendulum.yaml -o $out/short.h5 --duration 0.005"
second=$(on_intel cpu_of $short)
rm -rf "$out/cache"
first=$(on_intel cpu_of $short)
echo "test_platforms: one step of a pendulum takes $first s of a processor at the first start, $second s at the second"
awk "BEGIN { exit !($second <= 1.0) }"

for test in $tests; do
  echo "test_platforms: $test"
  on_intel build/bin/$test --gtest_brief=1
done
echo "test_platforms: all passed"
