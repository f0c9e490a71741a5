#!/bin/bash
# Diagnoses a folder of cases, two at a time, and prints the table of scores. Stop it with Ctrl-C; called again it goes on
# with the cases that have no report yet. Arguments: the folder (that of new_scenarios.py, or one of cases with truth.json),
# then options of `diagnose`. PROGRAM: another phyvisgen; REPORTS: where the reports go; CASES_AT_ONCE: 2.
set -eu
here="$(cd "$(dirname "$0")/../.." && pwd)"
refuse() {
  echo "run_all: $1" >&2
  exit 2
}
[ $# -ge 1 ] || refuse "name a folder of cases, such as out/cases, which make_cases.py or new_scenarios.py made"
suite="$1"
shift
program="${PROGRAM:-$here/build/bin/phyvisgen}"
reports="${REPORTS:-$suite/reports}"
cases="$suite"
[ -d "$suite/cases" ] && cases="$suite/cases"
[ -n "$(find "$cases" -mindepth 2 -maxdepth 2 -name recording.yaml -print -quit 2>/dev/null)" ] ||
  refuse "$suite holds no CASE/recording.yaml; make_cases.py and new_scenarios.py write some"
mkdir -p "$reports"
[ -e "$reports/commit" ] || git -C "$here" describe --always --dirty > "$reports/commit"
export program reports
one='
case="$1"
shift
report="$reports/$(basename "$case")"
[ -e "$report/report.json" ] && exit 0
mkdir -p "$report"
TIMEFORMAT="%R %U %S"
{ time "$program" diagnose "$case" -o "$report" --jobs 1 "$@" > "$report/sentence.txt" 2> "$report/log.txt"; } 2> "$report/seconds.txt" || exit 0
echo "$(basename "$case"): $(cut -c 1-160 "$report/sentence.txt")"'
find "$cases" -mindepth 2 -maxdepth 2 -name recording.yaml -printf '%h\n' | sort |
  xargs -P "${CASES_AT_ONCE:-2}" -I CASE bash -c "$one" one CASE "$@"
/usr/bin/python3 "$here/scripts/hidden_suite/table.py" "$suite" "$reports"
