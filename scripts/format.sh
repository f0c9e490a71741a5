#!/bin/sh
# Formats every C++ and OpenCL file of ours with clang-format 14; --check only looks and fails where something would
# change. Kernels are left out for now: they are written in columns that clang-format would undo.
set -eu
cd "$(dirname "$0")/.."
mode="-i"
[ "${1:-}" = "--check" ] && mode="--dry-run --Werror"
program=clang-format-14
command -v $program >/dev/null || program=clang-format
git ls-files --cached --others --exclude-standard '*.cpp' '*.hpp' '*.h' '*.cl' |
  while read -r file; do [ -f "$file" ] && case $file in kernels/*) ;; *) echo "$file" ;; esac; done |
  xargs $program $mode
