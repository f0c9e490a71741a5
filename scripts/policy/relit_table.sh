#!/bin/sh
# What does a background that is lit twice cost a policy? An arm pushes a beaker in a captured room. ACT learns from joints
# and the pictures of one camera, once with the room as it was captured (`captured`) and once with the room as a diffuse
# surface below the scene's lights (`relit`, as renderers without shadow receivers show it). Both are judged in the room
# as captured, on the same starts, beside the mean of all demonstrated motions and the nearest demonstration. The motions
# of the demonstrations are the same: light moves nothing.
#   scripts/policy/relit_table.sh FOLDER [SEED...]     SEED: of trainings, 1 without any
# FOLDER gets both tasks, a folder per kind of demonstrations and relit.csv. What is there already is kept: the same
# command goes on where it was stopped. Variables: those of scripts/train_and_evaluate.sh, such as EPISODES, DEMONSTRATIONS
# (100), STEPS (5000) and TRAINING (--look 500 --shift 1).
set -eu
. "$(dirname "$0")/table_arguments.sh"
[ -z "${JUDGED:-}${OBSERVATION:-}${CAMERA:-}" ] || refuse "JUDGED, OBSERVATION and CAMERA are set by this script"
export OBSERVATION=pictures CAMERA=front DEMONSTRATIONS="${DEMONSTRATIONS:-100}" JUDGED="$folder/captured.yaml"
export STEPS="${STEPS:-5000}" TRAINING="${TRAINING:---look 500 --shift 1}"

# the push, with the room and the lamps of weigh_beaker in place of a visible table, a lamp and an even sky
looks="$(sed -n '/^background: /,/^materials:/p' data/tasks/weigh_beaker.yaml | sed '$d' | sed "s#\.\./backgrounds#$root/data/backgrounds#g")"
{
  sed -e "s#\.\./\.\./data#$root/data#; s#\.\./\.\./tests#$root/tests#" \
    -e '/^  - name: table/a\    visible: false' -e '/^lights:/,/^materials:/{/^materials:/!d}' scripts/policy/push_beaker.yaml
  echo
  echo "$looks"
} >"$folder/captured.yaml"
sed '/^background: /s/}$/, relit: true}/' "$folder/captured.yaml" >"$folder/relit.yaml"
grep -q 'relit: true' "$folder/relit.yaml" || refuse "the background of data/tasks/weigh_beaker.yaml is not on one line"

echo "room,policy,training_seed,successes,episodes,executed" >"$folder/relit.csv"
for room in captured relit; do
  scripts/train_and_evaluate.sh "$folder/$room.yaml" "$folder/$room" "$@"
  sed "1d; s/^/$room,/" "$folder/$room/result.csv" >>"$folder/relit.csv"
done
cat "$folder/relit.csv"
