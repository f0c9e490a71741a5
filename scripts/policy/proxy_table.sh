#!/bin/sh
# Does finding a missing effect make better policies? An arm with compliant drives pushes a beaker. "Reality" is the same
# task with effects that its model lacks (`hidden` below), softer fingers and half the time step. `diagnose` sees three
# recordings of reality with the noise of cheap encoders and amends the nominal task by what it names. ACT on states learns
# from demonstrations of the nominal task, of the nominal one with rigid fingers, of the amended one, and, as a bound of
# what a diagnosis may give, of the nominal one with the hidden effects themselves (`truth`). The expert of each feeds
# forward the friction of its own task (`feedforward: friction`), so one who knows more reaches farther. All are judged in
# reality on the same starts, which nothing before has seen, beside the expert of the nominal task (`expert`) and that of
# reality (`expert_knows`).
#   scripts/policy/proxy_table.sh FOLDER [SEED...]     SEED: of trainings, 1 without any
# FOLDER gets tasks, recordings, diagnosis, a folder per kind of demonstrations and proxy.csv. What is there already is
# kept: the same command goes on where it was stopped, one with more seeds adds their trainings. Variables:
#   MINUTES         bound of the diagnosis (30)
#   those of scripts/train_and_evaluate.sh, such as DEMONSTRATIONS, STEPS (1000) and EPISODES
set -eu
. "$(dirname "$0")/table_arguments.sh"
[ -z "${GRIPPER:-}${JUDGED:-}${OBSERVATION:-}" ] || refuse "GRIPPER, JUDGED and OBSERVATION are set by this script"
python="${TRAINING_PROGRAMS:-.venv-train/bin}/python"
program="${PHYVISGEN_PROGRAM:-build/bin/phyvisgen}"
[ -x "$python" ] || refuse "$python is not there; scripts/install_lerobot.sh makes it"
export STEPS="${STEPS:-1000}" LEARNING_RATE="${LEARNING_RATE:-3e-4}" DROPOUT="${DROPOUT:-0}" VAE="${VAE:-false}"

hidden='
  - {effect: joint_viscous_friction, target: fr3_joint2, damping: 50}   # [N m s/rad]
  - {effect: joint_coulomb_friction, target: fr3_joint4, effort: 8}      # [N m]'
noise=2e-3 # of an encoder, one standard deviation [rad; of the fingers' slides m]

sed -e "s#\.\./\.\./data#$root/data#; s#\.\./\.\./tests#$root/tests#" \
  -e 's#drive: {stiffness: 1e5 N m/rad, damping: 0}#drive: {stiffness: 400 N m/rad, damping: 40}\n  feedforward: friction#' \
  scripts/policy/push_beaker.yaml >"$folder/nominal.yaml"
# of second order, so that long steps are not taken for friction
echo "solver: {integrator: bdf2}" >>"$folder/nominal.yaml"
sed -e "s#\.\./\.\./\.\./data#$root/data#; s#mesh: finger.obj#mesh: $root/tests/pipeline/small_task/finger.obj#" \
  -e 's#youngs_modulus: 10 MPa#youngs_modulus: 5 MPa#' \
  tests/pipeline/small_task/gripper.yaml >"$folder/softer_gripper.yaml"
cp "$folder/nominal.yaml" "$folder/truth.yaml"
sed -e 's#^time_step: 20 ms#time_step: 10 ms#; s#^gripper: .*#gripper: softer_gripper.yaml#' "$folder/nominal.yaml" \
  >"$folder/reality_knows.yaml"
sed '/^  feedforward: friction$/d' "$folder/reality_knows.yaml" >"$folder/reality.yaml"
for task in truth reality reality_knows; do
  echo "effects:$hidden" >>"$folder/$task.yaml"
done

if [ ! -d "$folder/recordings" ]; then
  rm -rf "$folder/recordings.new"
  "$program" generate "$folder/reality.yaml" -n 3 --seed 1000 --no-render -o "$folder/recordings.new" >/dev/null ||
    [ $? = 1 ] # a push that failed is left out
  "$python" - "$noise" "$folder"/recordings.new/episode_*/states.h5 <<'PYTHON'
import sys

import h5py
import numpy as np

random = np.random.default_rng(1000)
for file in sys.argv[2:]:
    with h5py.File(file, "r+") as states:
        q = states["q"]
        q[...] = q[()] + random.normal(0, float(sys.argv[1]), q.shape)
PYTHON
  mv "$folder/recordings.new" "$folder/recordings"
fi
[ -e "$folder/diagnosis/report.json" ] ||
  "$program" diagnose "$folder/recordings" --task "$folder/nominal.yaml" --max-effects 2 \
    --minutes "${MINUTES:-30}" --jobs 1 -o "$folder/diagnosis"
verdict="$("$python" -c 'import json, sys; print(json.load(open(sys.argv[1]))["verdict"])' "$folder/diagnosis/report.json")"

judge() { # NAME TASK GRIPPER SEED...
  name="$1" task="$2" gripper="$3"
  shift 3
  JUDGED="$folder/reality.yaml" GRIPPER="$gripper" scripts/train_and_evaluate.sh "$task" "$folder/$name" "$@" >/dev/null
}
judge nominal "$folder/nominal.yaml" "" "$@"
judge rigid "$folder/nominal.yaml" rigid "$@"
judge truth "$folder/truth.yaml" "" "$@"
case "$verdict" in
  effect | retune) judge amended "$folder/diagnosis/scene_amended.yaml" "" "$@" ;;
  *) echo "proxy_table: the verdict is $verdict, so there is no amended task" ;;
esac
for expert in expert:reality expert_knows:reality_knows; do
  told="$folder/${expert%:*}_${EPISODES:-20}.json"
  if [ ! -e "$told" ]; then
    PVG_PYTHON="$python" "$program" evaluate policy "$folder/${expert#*:}.yaml" --policy expert --baseline none -n "${EPISODES:-20}" \
      --json >"$told.new"
    mv "$told.new" "$told"
  fi
done
"$python" - "$folder" "${EPISODES:-20}" "$verdict" <<'PYTHON' | tee "$folder/proxy.csv"
import csv
import json
import sys
from pathlib import Path

from phyvisgen.statistics import wilson

folder = Path(sys.argv[1])
rows = []
for name in ("expert", "expert_knows"):
    expert = json.loads((folder / f"{name}_{sys.argv[2]}.json").read_text())
    rows.append(("none", name, "", sum(one["success"] for one in expert["episodes_detail"]), expert["episodes"]))
amended = ["amended"] if sys.argv[3] in ("effect", "retune") else []
for name in ["nominal", "rigid", *amended, "truth"]:
    with open(folder / name / "result.csv") as file:
        for row in csv.DictReader(file):
            rows.append((name, row["policy"], row["training_seed"], int(row["successes"]), int(row["episodes"])))
print("demonstrations,policy,training_seed,successes,episodes,low,high")
for name, policy, seed, successes, episodes in rows:
    low, high = wilson(successes, episodes)
    print(f"{name},{policy},{seed},{successes},{episodes},{low:.3f},{high:.3f}")
PYTHON
