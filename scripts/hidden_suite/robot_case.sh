#!/bin/sh
# A LeRobot set of an arm with friction in one joint that its task does not know: makes it, packs it and diagnoses it as
# it is. Takes some minutes; not part of test.sh. Arguments: a new folder; lerobot (3.0, default) or lerobot2 (2.1).
set -eu
cd "$(dirname "$0")/../.."
case "${1:--}:${2:-lerobot}" in
  -*) echo "robot_case: name a new folder and, where you like, lerobot2, such as out/robot_case" >&2; exit 2 ;;
  *:lerobot | *:lerobot2) ;;
  *) echo "robot_case: $2 is neither lerobot nor lerobot2" >&2; exit 2 ;;
esac
out="$1"
format="${2:-lerobot}"
scripts/install_pack.sh
mkdir -p "$out"
root=$(pwd)
# drives as soft as those of a compliant arm: with 1e5 N m/rad friction moves nothing
sed -e "s#\.\./\.\./\.\./data#$root/data#; s#^gripper: gripper.yaml#gripper: $root/tests/pipeline/small_task/gripper.yaml#" \
  -e "s#stiffness: 1e5 N m/rad, damping: 0}#stiffness: 400 N m/rad, damping: 40}#; s#frames_per_second: 10#frames_per_second: 50#" \
  tests/pipeline/small_task/push_beaker.yaml > "$out/task.yaml"
cp "$out/task.yaml" "$out/task_with_friction.yaml"
printf '\neffects:\n  - {effect: joint_coulomb_friction, target: fr3_joint4, effort: 4}\n' >> "$out/task_with_friction.yaml"
build/bin/phyvisgen generate "$out/task_with_friction.yaml" -n 4 --seed 1 -o "$out/set"
build/bin/phyvisgen pack "$out/set" --format "$format" -o "$out/$format"
time build/bin/phyvisgen diagnose "$out/$format" --task "$out/task.yaml" -o "$out/report_$format"
