#!/bin/sh
# Diagnoses the twelve hidden-effect cases of data/hidden, two at a time, and prints their table of scores; exit code 1 where
# one is not named as its truth says. Reports that are there are kept, so a stopped run goes on. All cases:
# scripts/hidden_suite/make_cases.py DIR, then `phyvisgen diagnose --suite DIR`.
#   scripts/test_hidden.sh [FOLDER OF THE REPORTS]
set -eu
cd "$(dirname "$0")/.."
reports="${1:-out/hidden}"
table=$(build/bin/phyvisgen diagnose --suite data/hidden -o "$reports" --jobs 2 --minutes 60)
echo "$table"
! echo "$table" | grep -q "not as the truth"
