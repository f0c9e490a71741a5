#!/bin/sh
# Runs the tests of physics and rendering under Oclgrind, a simulator that finds memory errors and data races in kernels.
# Slow, so not part of scripts/test.sh. Arguments: a GoogleTest filter; default: everything.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh
command -v oclgrind >/dev/null || scripts/apt_install.sh oclgrind
scripts/build.sh -DPVG_TESTS=ON
# programs kept from another run may be optimised
export XDG_CACHE_HOME="$PWD/build/oclgrind_cache"
rm -rf "$XDG_CACHE_HOME"
failed=0
for program in build/bin/test_device build/bin/test_physics_* build/bin/test_render; do
  log=build/oclgrind_${program##*/}.log
  rm -f "$log"
  echo "test_oclgrind: ${program##*/}, findings go to $log"
  # unoptimised: Oclgrind does not know all instructions that the optimiser makes
  PVG_OCLGRIND=1 oclgrind --data-races --build-options "-cl-opt-disable -DPVG_SIMULATED" --log "$log" \
    "$program" --gtest_filter="${1:-*}" --gtest_brief=1 || failed=1
  if [ -s "$log" ]; then
    head -40 "$log" >&2
    echo "test_oclgrind: $(wc -l <"$log") lines of findings" >&2
    failed=1
  fi
done
[ "$failed" = 0 ] || exit 1
echo "test_oclgrind: no findings"
