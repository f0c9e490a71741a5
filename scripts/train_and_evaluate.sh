#!/bin/sh
# Trains ACT on demonstrations and judges it in the loop by lerobot's own `lerobot-eval`, beside the mean motion of all
# demonstrations and the replay of the nearest one, all on the same starts, which no training has seen.
#   scripts/train_and_evaluate.sh TASK FOLDER [SEED...]     TASK: a file; SEED: of trainings, 1 without any
# FOLDER gets set, data set, checkpoints and result.csv; what is there already is kept, so that the same command goes on
# where it was stopped, but for a training, which begins again. Variables:
#   OBSERVATION     states (joints and poses of objects, the default) or pictures (joints and pictures)
#   CAMERA, SIZE    pictures: names of cameras with blanks between (else all), WIDTHxHEIGHT in pixels (96x96)
#   SAMPLES         paths per pixel (4)
#   GRIPPER         soft or rigid, in demonstrations and evaluation (else what the task says)
#   JUDGED          another task file, in which policies and baselines are judged, with the fingers that it says (TASK)
#   DEMONSTRATIONS, EPISODES (50, 20), LENGTH: periods of an episode (else a quarter more than the planned motion)
#   NETWORK         pictures: keypoints (the default, minutes on two cores) or resnet18, see scripts/policy/train_pictures.py
#   WEIGHTS         resnet18: at the start, such as ResNet18_Weights.IMAGENET1K_V1, which is downloaded (else random)
#   DEVICE          of training, cpu or cuda (cpu)
#   STEPS, BATCH    of training (2000 of 32; pictures: 5000 of 32)
#   CHUNK, EXECUTED actions that are predicted, and done before the policy is asked again (10, 5; pictures: 20, 10);
#                   EXECUTED="5 1" judges each policy twice
#   LEARNING_RATE, DROPOUT (1e-4, 0.1; pictures: 5e-4, 0)
#   TRAINING        pictures: more words for scripts/policy/train_pictures.py, such as "--look 500 --shift 1"
#   VAE, SAVE       states: true or false (true), steps from one checkpoint to the next (STEPS)
#   TRAINING_PROGRAMS folder of python, lerobot-train and lerobot-eval (.venv-train/bin)
#   GENERATE        more words for `generate` that change no episode, such as "--worlds 4"
set -eu
cd "$(dirname "$0")/.."
refuse() {
  echo "train_and_evaluate: $1" >&2
  exit 2
}
[ $# -ge 2 ] || refuse "name a task file and a folder, such as data/tasks/weigh_beaker.yaml out/beaker_policy"
task="$1" folder="$2"
shift 2
[ $# -gt 0 ] || set -- 1
demonstrations="${DEMONSTRATIONS:-50}" episodes="${EPISODES:-20}"
observation="${OBSERVATION:-states}" cameras="${CAMERA:-}" size="${SIZE:-96x96}" samples="${SAMPLES:-4}"
gripper="${GRIPPER:-}" judged="${JUDGED:-$task}" judged_gripper="${GRIPPER:-}"
[ -z "${JUDGED:-}" ] || judged_gripper=""
network="${NETWORK:-keypoints}" steps="${STEPS:-2000}" batch="${BATCH:-32}" rate="${LEARNING_RATE:-1e-4}" dropout="${DROPOUT:-0.1}"
chunk="${CHUNK:-10}" all_executed="${EXECUTED:-5}"
width="${size%x*}" height="${size#*x}"
expr "$size" : '[1-9][0-9]*x[1-9][0-9]*$' >/dev/null || refuse "SIZE=$size is not WIDTHxHEIGHT in pixels, such as 96x96"
case "$gripper" in "" | soft | rigid) ;; *) refuse "GRIPPER=$gripper is neither soft nor rigid" ;; esac
for word in ${GENERATE:-}; do
  case "${word%%=*}" in
    --gripper) refuse "GENERATE has --gripper, which evaluation would not get; set GRIPPER=rigid or GRIPPER=soft" ;;
    --camera) refuse "GENERATE has --camera, which evaluation would not get; set CAMERA" ;;
    --width | --height | --samples | --fps)
      refuse "GENERATE has ${word%%=*}, which evaluation would not get; set SIZE or SAMPLES, or write it into the task"
      ;;
  esac
done
# words for `generate`, `pack`, `evaluate policy`, `lerobot-train` and `lerobot-eval`
case "$observation" in
  states)
    [ -z "$cameras" ] || refuse "CAMERA=$cameras needs OBSERVATION=pictures; on states a policy sees none"
    [ -z "${NETWORK:-}${WEIGHTS:-}${TRAINING:-}" ] || refuse "NETWORK, WEIGHTS and TRAINING need OBSERVATION=pictures"
    generate="--no-render" pack="--no-pictures --environment-state"
    show="--env.obs_type=state --env.width=96 --env.height=72 --env.samples=1"
    ;;
  pictures)
    # poses teach where to look (--look); the policy does not get them
    generate="--width $width --height $height --samples $samples" pack="--environment-state"
    chunk="${CHUNK:-20}" all_executed="${EXECUTED:-10}"
    case "$network" in keypoints | resnet18) ;; *) refuse "NETWORK=$network is neither keypoints nor resnet18" ;; esac
    [ "$network" = resnet18 ] || [ -z "${WEIGHTS:-}" ] || refuse "WEIGHTS=$WEIGHTS needs NETWORK=resnet18"
    [ -z "${VAE:-}${SAVE:-}" ] || refuse "VAE and SAVE need OBSERVATION=states"
    show="--env.obs_type=pixels_agent_pos --env.width=$width --env.height=$height --env.samples=$samples"
    list=""
    for camera in $cameras; do
      generate="$generate --camera $camera" list="$list${list:+,}$camera"
    done
    [ -z "$list" ] || show="$show --env.cameras=[$list]"
    ;;
  *) refuse "OBSERVATION=$observation is neither states nor pictures" ;;
esac
executed="${all_executed%% *}" # of the checkpoint
for number in $all_executed; do
  expr "$number" : '[1-9][0-9]*$' >/dev/null && [ "$number" -le "$chunk" ] ||
    refuse "EXECUTED=$all_executed holds $number, which is no number from 1 to the $chunk actions of a chunk"
done
[ -z "$gripper" ] || generate="$generate --gripper $gripper"
[ -z "$judged_gripper" ] || show="$show --env.gripper=$judged_gripper"

python="${TRAINING_PROGRAMS:-.venv-train/bin}"
program="${PHYVISGEN_PROGRAM:-build/bin/phyvisgen}"
export PHYVISGEN_PROGRAM="$(realpath "$program")" OMP_NUM_THREADS=1 HF_HUB_OFFLINE=1 HF_HOME="$folder/hf" WANDB_MODE=disabled
mkdir -p "$folder"
made="OBSERVATION=$observation CAMERA=$cameras SIZE=$size SAMPLES=$samples GRIPPER=$gripper"
[ ! -e "$folder/made_with" ] || [ "$(cat "$folder/made_with")" = "$made" ] ||
  refuse "$folder was made with $(cat "$folder/made_with"), not $made; name another folder"
echo "$made" >"$folder/made_with"
# a failed episode is no demonstration and no reason to stop
# shellcheck disable=SC2086
"$program" generate "$task" -n "$demonstrations" $generate ${GENERATE:-} -o "$folder/set" >/dev/null || [ $? = 1 ]
# shellcheck disable=SC2086
[ -d "$folder/data" ] || "$program" pack "$folder/set" $pack -o "$folder/data"
length="${LENGTH:-$("$python/python" - "$judged" "$judged_gripper" <<'PYTHON'
import sys
import phyvisgen
from phyvisgen.evaluation import planned_length

with phyvisgen.Server(sys.argv[1], render=False, gripper=sys.argv[2] or None) as server:
    print(planned_length(server, phyvisgen.EVALUATION_SEED))
PYTHON
)}"

# lerobot 0.4 finds packages of environments only where they are named
plugin=""
"$python/python" -c 'from lerobot.utils.import_utils import register_third_party_plugins' 2>/dev/null ||
  plugin="--env.discover_packages_path=lerobot_env_phyvisgen"

echo "policy,training_seed,successes,episodes,executed" >"$folder/result.csv"
how="$judged $judged_gripper $episodes $length" # a judgement that was made so is kept
if [ "$(cat "$folder/baselines.how" 2>/dev/null)" != "$how" ]; then
  PVG_PYTHON="$python/python" "$program" evaluate policy "$judged" --policy blind --baseline nearest \
    --demonstrations "$folder/set" -n "$episodes" --length "$length" ${judged_gripper:+--gripper "$judged_gripper"} --json \
    >"$folder/baselines.json"
  echo "$how" >"$folder/baselines.how"
fi
"$python/python" - "$folder/baselines.json" <<'PYTHON' | tee -a "$folder/result.csv"
import json
import sys

told = json.load(open(sys.argv[1]))
for name, result in {told["policy"]: told, **told["baselines"]}.items():
    successes = sum(episode["success"] for episode in result["episodes_detail"])
    print(f"{name},,{successes},{result['episodes']},")
PYTHON
train() {
  if [ "$observation" = pictures ]; then
    # shellcheck disable=SC2086
    "$python/python" scripts/policy/train_pictures.py --data "$folder/data" --output "$out/checkpoints/last" \
      --network "$network" --device "${DEVICE:-cpu}" ${WEIGHTS:+--weights "$WEIGHTS"} \
      --steps "${STEPS:-5000}" --batch "$batch" --chunk "$chunk" --executed "$executed" \
      --learning-rate "${LEARNING_RATE:-5e-4}" --dropout "${DROPOUT:-0}" --seed "$seed" ${TRAINING:-}
  else
    # ACT's default leaves environment_state as it is: here it is normalised
    "$python/python" scripts/policy/train_states.py --dataset.repo_id=local/set --dataset.root="$folder/data" --policy.type=act \
      --policy.device="${DEVICE:-cpu}" --policy.push_to_hub=false --policy.dim_model=128 --policy.dim_feedforward=512 \
      --policy.n_heads=4 --policy.n_encoder_layers=2 --policy.n_vae_encoder_layers=2 --policy.latent_dim=16 \
      --policy.chunk_size="$chunk" --policy.n_action_steps="$executed" --policy.optimizer_lr="$rate" \
      --policy.dropout="$dropout" --policy.use_vae="${VAE:-true}" \
      '--policy.normalization_mapping={"STATE":"MEAN_STD","ENV":"MEAN_STD","ACTION":"MEAN_STD","VISUAL":"MEAN_STD"}' \
      --batch_size="$batch" --steps="$steps" --save_freq="${SAVE:-$steps}" --log_freq=100 --num_workers=0 \
      --seed="$seed" --wandb.enable=false --output_dir="$out"
  fi
}
failed() {
  echo "train_and_evaluate: $1 of seed $seed failed; $2 says why" >&2
  exit 1
}
judge() { # NUMBER of actions that are done before the policy is asked again
  told="$folder/eval_$seed"
  [ "$1" = "$executed" ] || told="${told}_executed_$1"
  if [ "$(cat "$told.how" 2>/dev/null)" != "$how" ]; then
    # shellcheck disable=SC2086
    "$python/lerobot-eval" --policy.path="$out/checkpoints/last/pretrained_model" --policy.device=cpu \
      --policy.n_action_steps="$1" --env.type=phyvisgen --env.task="$judged" --env.episode_length="$length" $show $plugin \
      --eval.n_episodes="$episodes" --eval.batch_size=2 --seed=0 \
      --output_dir="$told" >"$told.log" 2>&1 || failed evaluation "$told.log"
    echo "$how" >"$told.how"
  fi
  "$python/python" - "$told/eval_info.json" "$seed" "$episodes" "$1" <<'PYTHON' | tee -a "$folder/result.csv"
import json
import sys

told = json.load(open(sys.argv[1]))["overall"]
print(f"act,{sys.argv[2]},{round(told['pc_success'] * int(sys.argv[3]) / 100)},{sys.argv[3]},{sys.argv[4]}")
PYTHON
}
for seed in "$@"; do
  out="$folder/act_$seed"
  if [ ! -d "$out/checkpoints/last" ]; then
    rm -rf "$out" "$folder/eval_$seed".how "$folder/eval_${seed}_executed_"*.how # a training goes on from no half of it
    train >"$folder/train_$seed.log" 2>&1 || failed training "$folder/train_$seed.log"
  fi
  for number in $all_executed; do
    judge "$number"
  done
done
