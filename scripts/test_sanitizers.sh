#!/bin/sh
# Builds everything with the address and undefined-behaviour sanitizers, in build-sanitize, and runs the tests. The first
# finding ends a test. Arguments: a GoogleTest filter; default: everything.
# PoCL alone: Intel's OpenCL library for GPUs, which scripts/install.sh brings for its compiler, opens libraries in a way
# (RTLD_DEEPBIND) for which the address sanitizer ends a program.
# No search for leaks: PoCL, LLVM and the OpenCL loader keep what they have allocated until the process ends.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh
scripts/apt_install.sh clang-14 libclang-rt-14-dev
CC=clang-14 CXX=clang++-14 cmake -S . -B build-sanitize -G Ninja -DPVG_SANITIZE=ON -DPVG_TESTS=ON >/dev/null
ninja -C build-sanitize
export ASAN_OPTIONS="detect_leaks=0:strict_string_checks=1" UBSAN_OPTIONS="print_stacktrace=1"
export OCL_ICD_VENDORS="${OCL_ICD_VENDORS:-/etc/OpenCL/vendors/pocl.icd}"
for program in build-sanitize/bin/test_*; do
  echo "test_sanitizers: ${program##*/}"
  "$program" --gtest_filter="${1:-*}" --gtest_brief=1
done
