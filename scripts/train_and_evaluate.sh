#!/bin/sh
# Trains ACT on states (joints and poses of objects) of demonstrations and judges it in the loop by lerobot's own
# `lerobot-eval`, beside the mean motion of all demonstrations, on starts that no training has seen.
#   scripts/train_and_evaluate.sh TASK FOLDER [SEED...]     TASK: a file; SEED: of trainings, 1 without any
# FOLDER gets set, data set, checkpoints and result.csv; what is there already is kept. Variables: DEMONSTRATIONS (50),
# EPISODES (20), STEPS (2000), CHUNK (10) actions of which EXECUTED (5) are done, LEARNING_RATE (1e-4), DROPOUT (0.1), VAE
# (true), GENERATE: more words for `generate`,
# LENGTH: periods of an episode (else a quarter more than the planned motion).
set -eu
cd "$(dirname "$0")/.."
task="$1" folder="$2"
shift 2
[ $# -gt 0 ] || set -- 1
demonstrations="${DEMONSTRATIONS:-50}" episodes="${EPISODES:-20}"
python=.venv-train/bin
program="${PHYVISGEN_PROGRAM:-build/bin/phyvisgen}"
export PHYVISGEN_PROGRAM="$(realpath "$program")" OMP_NUM_THREADS=1 HF_HUB_OFFLINE=1 HF_HOME="$folder/hf" WANDB_MODE=disabled
mkdir -p "$folder"
# a failed episode is no demonstration and no reason to stop
# shellcheck disable=SC2086
"$program" generate "$task" -n "$demonstrations" --no-render ${GENERATE:-} -o "$folder/set" >/dev/null || [ $? = 1 ]
[ -d "$folder/data" ] || "$program" pack "$folder/set" --no-pictures --environment-state -o "$folder/data"
length="${LENGTH:-$("$python/python" - "$task" <<'PYTHON'
import sys
import phyvisgen
from phyvisgen.evaluation import planned_length

with phyvisgen.Server(sys.argv[1], render=False) as server:
    print(planned_length(server, phyvisgen.EVALUATION_SEED))
PYTHON
)}"

# lerobot 0.4 finds packages of environments only where they are named
plugin=""
"$python/python" -c 'from lerobot.utils.import_utils import register_third_party_plugins' 2>/dev/null ||
  plugin="--env.discover_packages_path=lerobot_env_phyvisgen"

echo "policy,training_seed,successes,episodes" >"$folder/result.csv"
blind="$(PVG_PYTHON="$python/python" "$program" evaluate policy "$task" --policy blind --demonstrations "$folder/set" \
  -n "$episodes" --length "$length" --json | "$python/python" -c '
import json, sys
told = json.load(sys.stdin)
print(sum(episode["success"] for episode in told["episodes_detail"]))')"
echo "blind,,$blind,$episodes" | tee -a "$folder/result.csv"
for seed in "$@"; do
  out="$folder/act_$seed"
  # ACT's default leaves environment_state as it is: here it is normalised
  [ -d "$out/checkpoints/last" ] || "$python/lerobot-train" --dataset.repo_id=local/set --dataset.root="$folder/data" \
    --policy.type=act --policy.device=cpu --policy.push_to_hub=false --policy.dim_model=128 \
    --policy.dim_feedforward=512 --policy.n_heads=4 --policy.n_encoder_layers=2 --policy.n_vae_encoder_layers=2 \
    --policy.latent_dim=16 --policy.chunk_size="${CHUNK:-10}" --policy.n_action_steps="${EXECUTED:-5}" \
    --policy.optimizer_lr="${LEARNING_RATE:-1e-4}" --policy.dropout="${DROPOUT:-0.1}" --policy.use_vae="${VAE:-true}" \
    '--policy.normalization_mapping={"STATE":"MEAN_STD","ENV":"MEAN_STD","ACTION":"MEAN_STD","VISUAL":"MEAN_STD"}' \
    --batch_size=32 --steps="${STEPS:-2000}" --save_freq="${STEPS:-2000}" --log_freq=500 --num_workers=0 \
    --seed="$seed" --wandb.enable=false --output_dir="$out" >"$folder/train_$seed.log" 2>&1
  # shellcheck disable=SC2086
  "$python/lerobot-eval" --policy.path="$out/checkpoints/last/pretrained_model" --policy.device=cpu \
    --env.type=phyvisgen --env.task="$task" --env.episode_length="$length" --env.width=96 --env.height=72 \
    --env.samples=1 $plugin --eval.n_episodes="$episodes" --eval.batch_size=2 --seed=1000 \
    --output_dir="$folder/eval_$seed" >"$folder/eval_$seed.log" 2>&1
  "$python/python" - "$folder/eval_$seed/eval_info.json" "$seed" "$episodes" <<'PYTHON' | tee -a "$folder/result.csv"
import json
import sys

told = json.load(open(sys.argv[1]))["overall"]
print(f"act,{sys.argv[2]},{round(told['pc_success'] * int(sys.argv[3]) / 100)},{sys.argv[3]}")
PYTHON
done
