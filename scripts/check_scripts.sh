#!/bin/sh
# Reads every script without running it: Python by its parser, shell scripts by `bash -n`. Exit code 1 where one is wrong.
set -eu
cd "$(dirname "$0")/.."
git ls-files --cached --others --exclude-standard '*.py' | python3 -c '
import ast, os, sys
for path in sys.stdin.read().splitlines():
    if os.path.isfile(path):
        ast.parse(open(path, encoding="utf-8").read(), path)'
git ls-files --cached --others --exclude-standard '*.sh' '*.sbatch' | while read -r file; do
  [ ! -f "$file" ] || bash -n "$file"
done
