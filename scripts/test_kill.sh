#!/bin/bash
# Ends `phyvisgen generate` at random moments and completes the set: it must be the same bits as one that was never
# disturbed. Argument: how often it is killed with -9 (default 50); a fifth as often it is asked to stop by SIGTERM or
# SIGUSR1, which must take less than 10 s and end with code 75. As root also with a full disk, and by two "containers"
# of one host name, each process 1, that fill one folder.
set -euo pipefail
cd "$(dirname "$0")/.."
program=$PWD/build/bin/phyvisgen
task=$PWD/tests/pipeline/small_task/push_beaker.yaml
kills="${1:-50}"
episodes=4
folder=$(mktemp -d)
disk=""
cleanup() {
  [ -z "$disk" ] || umount "$disk" 2>/dev/null || true
  rm -rf "$folder"
}
trap cleanup EXIT
RANDOM=1 # the moments are the same each time, as far as the machine is

options="generate $task -n $episodes --seed 3 -o"
generate() { "$program" $options "$1" >>"$folder/log" 2>&1; }
same() { # $1: a set; complete, without leftovers, the same bits; times stand in the two JSON files alone
  diff -r --exclude=summary.json --exclude=set.json "$folder/undisturbed" "$1"
}
milliseconds() { date +%s%3N; }

start=$(milliseconds)
generate "$folder/undisturbed"
each=$((($(milliseconds) - start) / episodes))
echo "test_kill: an episode takes $each ms; $kills kills"

# $1: signal, $2: folder; after a random time within one and a half episodes. Sets code and took [ms].
disturb() {
  "$program" $options "$2" >>"$folder/log" 2>&1 &
  local process=$! delay=$((RANDOM * each * 3 / 2 / 32768))
  sleep "$((delay / 1000)).$(printf %03d $((delay % 1000)))"
  local asked=$(milliseconds)
  kill "-$1" "$process" 2>/dev/null || true
  code=0
  wait "$process" 2>/dev/null || code=$?
  took=$(($(milliseconds) - asked))
}
# where nothing is left to do, an episode is taken out
take_out() {
  [ "$(ls "$1" 2>/dev/null | grep -c '^episode_')" -lt $episodes ] || rm -r "$1/episode_00000$((RANDOM % episodes))"
}

hits=0
while [ $hits -lt "$kills" ]; do
  take_out "$folder/killed"
  disturb KILL "$folder/killed"
  [ $code != 137 ] || hits=$((hits + 1))
done
generate "$folder/killed"
same "$folder/killed"
echo "test_kill: killed $hits times, then completed: the same bits"

hits=0 longest=0
while [ $hits -lt $((kills / 5)) ]; do
  take_out "$folder/stopped"
  disturb $([ $((RANDOM % 2)) = 0 ] && echo TERM || echo USR1) "$folder/stopped"
  # before the program has looked at its options the signal has its usual effect
  case $code in 0 | 143 | 138) continue ;; 75) ;; *) echo "test_kill: a stop ended with code $code" >&2 && exit 1 ;; esac
  hits=$((hits + 1))
  [ $took -le $longest ] || longest=$took
  if [ $took -gt 10000 ] || ls -A "$folder/stopped" | grep -q partial; then
    echo "test_kill: a stop took $took ms or left something behind: $(ls -A "$folder/stopped")" >&2
    exit 1
  fi
done
[ $hits = 0 ] || { generate "$folder/stopped" && same "$folder/stopped"; }
echo "test_kill: stopped $hits times within $longest ms, then completed: the same bits"

if [ "$(id -u)" = 0 ]; then
  disk=$folder/disk
  mkdir "$disk"
  one=$(du -sk "$folder/undisturbed/episode_000000" | cut -f1)
  mount -t tmpfs -o size=$((one * 5 / 2))k none "$disk" # room for two and a half
  code=0
  generate "$disk/set" || code=$?
  done_before=$(ls "$disk/set" | grep -c '^episode_')
  if [ $code != 1 ] || [ "$done_before" != 2 ] || ls -A "$disk/set" | grep -q partial; then
    echo "test_kill: a full disk ended with code $code, leaving: $(ls -A "$disk/set")" >&2
    exit 1
  fi
  tail -1 "$folder/log"
  mount -o remount,size=$((one * 20))k "$disk"
  generate "$disk/set"
  same "$disk/set"
  echo "test_kill: the disk was full after $done_before episodes, then completed: the same bits"

  pids=()
  for i in 1 2; do
    unshare --pid --fork --mount-proc "$program" $options "$folder/containers" >>"$folder/log" 2>&1 &
    pids+=($!)
  done
  for pid in "${pids[@]}"; do
    code=0
    wait "$pid" || code=$?
    [ $code = 0 ] || { echo "test_kill: one of two containers ended with code $code" >&2; tail -3 "$folder/log" >&2; exit 1; }
  done
  same "$folder/containers"
  echo "test_kill: two containers, each process 1 of one host name, filled one folder: the same bits"
fi
