#!/bin/sh
# How often each task succeeds with its default sampling, without pictures: 20 seeds each, the rate with its 95 % interval
# by Wilson, the reasons of failures, and the number of recorded steps in which surfaces intersect.
#   scripts/task_success.sh [-n EPISODES] [-s SEED] [-o FOLDER] [-b PROGRAM] [TASK ...]
# Finished episodes in FOLDER stay: the same command continues. Exit code 1: a task below 90 %, or an intersection.
set -u
cd "$(dirname "$0")/.."
episodes=20 seed=0 folder=out/task_success program=build/bin/phyvisgen
while getopts n:s:o:b: option; do
  case $option in
    n) episodes=$OPTARG ;;
    s) seed=$OPTARG ;;
    o) folder=$OPTARG ;;
    b) program=$OPTARG ;;
    *) echo "usage: task_success.sh [-n EPISODES] [-s SEED] [-o FOLDER] [-b PROGRAM] [TASK ...]" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ -x "$program" ] || { echo "task_success: there is no $program; build it with scripts/build.sh" >&2; exit 2; }
[ $# -gt 0 ] || set -- weigh_beaker place_flask place_dish open_cabinet fold_towel dual_fold_towel

mkdir -p "$(dirname "$folder")" || exit 2

result=0
for task in "$@"; do
  nice -n 19 "$program" generate "data/tasks/$task.yaml" -n "$episodes" --seed "$seed" --no-render --keep-failed \
    -o "$folder/$task" >"$folder.$task.log" 2>&1
  code=$?
  # 1: some episodes failed, which is what is measured
  [ $code -le 1 ] || { echo "$task: generate ended with $code:" >&2; tail -n 1 "$folder.$task.log" >&2; exit $code; }
  nice -n 19 "$program" evaluate "$folder/$task" 2>/dev/null || result=1
  nice -n 19 "$program" evaluate "$folder/$task" --every 1000000 --json 2>/dev/null |
    grep -q '"rate": \(0\.9\|1\.0\)' || result=1
done
exit $result
