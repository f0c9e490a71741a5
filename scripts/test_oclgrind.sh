#!/bin/sh
# Runs the kernel tests (core_tests) under Oclgrind, a simulator that finds memory errors and data races in kernels.
# Slow, so not part of scripts/test.sh. Arguments: a GoogleTest filter; default: everything.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh
if ! command -v oclgrind >/dev/null; then
  if [ "$(id -u)" = 0 ]; then as_root=""; else as_root="sudo"; fi
  echo "install: apt-get installs oclgrind"
  $as_root apt-get install -y -qq --no-install-recommends oclgrind >/dev/null
fi
scripts/build.sh -DPVG_TESTS=ON
log=build/oclgrind.log
rm -f "$log"
echo "test_oclgrind: core_tests, findings go to $log"
# unoptimised: Oclgrind does not know all instructions that the optimiser makes
PVG_OCLGRIND=1 oclgrind --data-races --build-options -cl-opt-disable --log "$log" \
  build/bin/core_tests --gtest_filter="${1:-*}" --gtest_brief=1
if [ -s "$log" ]; then
  head -40 "$log" >&2
  echo "test_oclgrind: $(wc -l <"$log") lines of findings" >&2
  exit 1
fi
echo "test_oclgrind: no findings"
