#!/bin/sh
# Do disturbances in demonstrations teach a policy to come back to its way? ACT on states learns a push from
# demonstrations without and with disturbances (`vary: disturbance`). Both are judged without any on the same starts, with
# the predicted actions executed as told: the oftener a policy is asked anew, the more it meets what it has done itself.
#   scripts/policy/recovery_table.sh FOLDER [SEED...]     SEED: of trainings, 1 without any
# FOLDER gets a folder per kind of demonstrations and recovery.csv; the same command goes on where it was stopped. Variables:
#   BY, TIMES, DURATION   of the disturbances (20 mm to each side of each axis, 3, 0.4 s)
#   those of scripts/train_and_evaluate.sh, such as DEMONSTRATIONS, STEPS (1000), EXECUTED ("5 1") and EPISODES
set -eu
. "$(dirname "$0")/table_arguments.sh"
[ -z "${JUDGED:-}${OBSERVATION:-}" ] || refuse "JUDGED and OBSERVATION are set by this script"
python="${TRAINING_PROGRAMS:-.venv-train/bin}/python"
[ -x "$python" ] || refuse "$python is not there; scripts/install_lerobot.sh makes it"
export STEPS="${STEPS:-1000}" LEARNING_RATE="${LEARNING_RATE:-3e-4}" DROPOUT="${DROPOUT:-0}" VAE="${VAE:-false}"
export EXECUTED="${EXECUTED:-5 1}" JUDGED="$folder/plain.yaml"

sed "s#\.\./\.\./data#$root/data#; s#\.\./\.\./tests#$root/tests#" scripts/policy/push_beaker.yaml >"$folder/plain.yaml"
by="${BY:-20 mm}"
{
  cat "$folder/plain.yaml"
  echo "vary:"
  echo "  - {quantity: disturbance, of: gripper_base, by: [-$by, $by], times: ${TIMES:-3}, duration: ${DURATION:-0.4}}"
} >"$folder/disturbed.yaml"
for name in plain disturbed; do
  scripts/train_and_evaluate.sh "$folder/$name.yaml" "$folder/$name" "$@" >/dev/null
done
"$python" - "$folder" <<'PYTHON' | tee "$folder/recovery.csv"
import csv
import sys
from pathlib import Path

from phyvisgen.statistics import wilson

print("demonstrations,policy,training_seed,executed,successes,episodes,low,high")
for name in ("plain", "disturbed"):
    with open(Path(sys.argv[1]) / name / "result.csv") as file:
        for row in csv.DictReader(file):
            low, high = wilson(int(row["successes"]), int(row["episodes"]))
            words = (row["policy"], row["training_seed"], row["executed"], row["successes"], row["episodes"])
            print(name, *words, f"{low:.3f},{high:.3f}", sep=",")
PYTHON
