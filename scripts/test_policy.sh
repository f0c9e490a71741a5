#!/bin/sh
# From install to closed loop: 50 pushes, ACT on states, 20 unseen starts by lerobot-eval, the blind mean motion beside
# it. Fails where a policy has fewer than 16 successes of 20 or the blind motion more than 4. Not part of test.sh: it
# downloads up to 5.6 GB the first time and trains for minutes. Arguments: seeds of trainings (1), FOLDER in the
# variable OUT (else a new one, gone at the end).
set -eu
cd "$(dirname "$0")/.."
scripts/install_pack.sh
scripts/install_lerobot.sh
if [ -n "${OUT:-}" ]; then
  folder="$OUT"
else
  folder="$(mktemp -d)"
  trap 'rm -rf "$folder"' EXIT
fi
scripts/train_and_evaluate.sh scripts/policy/push_beaker.yaml "$folder" "$@"
awk -F, '
  $1 == "blind" && $3 > 4 { print "test_policy: the blind motion succeeds " $3 " times: the starts are too narrow"; bad = 1 }
  $1 == "act" && $3 < 16 { print "test_policy: training " $2 " has " $3 " successes of " $4 ", not 16"; bad = 1 }
  END { exit bad }' "$folder/result.csv"
echo "test_policy: passed"
