#!/bin/sh
# Formats every C++ file of ours with clang-format; --check only looks and fails where something would change.
set -eu
cd "$(dirname "$0")/.."
mode="-i"
[ "${1:-}" = "--check" ] && mode="--dry-run --Werror"
git ls-files '*.cpp' '*.hpp' | xargs clang-format $mode
