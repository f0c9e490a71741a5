#!/bin/sh
# The tables of fidelity.
#   scripts/fidelity_tables.sh physics [SEED [ARGUMENTS...]]   masks of a gripper; arguments: of fidelity/physics_table.py
#   scripts/fidelity_tables.sh pictures FOLDER [ARGUMENTS...]  left-out photographs; arguments: of `capture room`
#   scripts/fidelity_tables.sh composed FOLDER [ARGUMENTS...]  glass and steel in left-out photographs, after `pictures`;
#                                                            arguments: of fidelity/composed_table.py
#   scripts/fidelity_tables.sh synthetic [ARGUMENTS...]        the same in a synthetic room, whose picture may be shown;
#                                                            arguments: of fidelity/synthetic_composed.py
#   scripts/fidelity_tables.sh renderers [ARGUMENTS...]        the same by SAPIEN and MuJoCo, after `synthetic`;
#                                                            arguments: of fidelity/other_renderers.py
# Reality of physics and composed is drawn by Cycles (PyPI's bpy 4.2, 520 MB, needs Python 3.11). Results: out/fidelity.
set -eu
cd "$(dirname "$0")/.."
what="${1:-}"
[ $# -eq 0 ] || shift
case "$what" in
  physics)
    seed="${1:-1}"
    [ $# -eq 0 ] || shift
    scripts/python_env.sh fidelity_tables numpy h5py pyyaml pillow opencv-python-headless bpy==4.2.0
    .venv-fidelity_tables/bin/python scripts/fidelity/physics_table.py out/fidelity/physics --seed "$seed" "$@"
    ;;
  pictures)
    [ $# -gt 0 ] || { echo "fidelity_tables.sh pictures: name the folder of the photographs"; exit 2; }
    mkdir -p out/fidelity
    build/bin/phyvisgen capture room "$@" -o out/fidelity/room --hold-out 5 --json >out/fidelity/pictures.json
    python3 scripts/fidelity/pictures_table.py out/fidelity/pictures.json
    ;;
  composed)
    [ $# -gt 0 ] || { echo "fidelity_tables.sh composed: name the folder of the photographs"; exit 2; }
    [ -e out/fidelity/room/report.json ] || { echo "fidelity_tables.sh composed: run fidelity_tables.sh pictures $1 first"; exit 2; }
    photos="$1"
    shift
    scripts/python_env.sh fidelity_tables numpy h5py pyyaml pillow opencv-python-headless bpy==4.2.0
    .venv-fidelity_tables/bin/python scripts/fidelity/composed_table.py out/fidelity/room "$photos" out/fidelity/composed "$@"
    ;;
  synthetic)
    scripts/python_env.sh fidelity_synthetic numpy h5py pillow
    mkdir -p out/fidelity
    .venv-fidelity_synthetic/bin/python scripts/fidelity/synthetic_composed.py build/bin/phyvisgen out/fidelity/synthetic \
      out/fidelity/synthetic.png "$@"
    ;;
  renderers)
    [ -e out/fidelity/synthetic/scene/reality.png ] || { echo "fidelity_tables.sh renderers: run fidelity_tables.sh synthetic first"; exit 2; }
    scripts/python_env.sh fidelity_renderers sapien==3.0.3 mujoco==4.0.0 numpy h5py pillow
    scripts/install_vulkan.sh
    export VK_ICD_FILENAMES="$PWD/build/mesa/lvp.json" LD_LIBRARY_PATH="$PWD/build/mesa/usr/lib/x86_64-linux-gnu"
    .venv-fidelity_renderers/bin/python scripts/fidelity/other_renderers.py build/bin/phyvisgen out/fidelity/synthetic \
      out/fidelity/renderers.png "$@"
    ;;
  *)
    echo "fidelity_tables.sh: say physics, pictures FOLDER, composed FOLDER, synthetic or renderers"
    exit 2
    ;;
esac
