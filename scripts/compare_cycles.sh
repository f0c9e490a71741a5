#!/bin/sh
# Renders a scene with phyvisgen and with Blender's Cycles (Debian's `blender`) and compares the pictures.
#   scripts/compare_cycles.sh [SCENE.yaml [SAMPLES [DIR]]]
set -eu
cd "$(dirname "$0")/.."
scene="${1:-data/scenes/cornell_glass.yaml}"
samples="${2:-1024}"
dir="${3:-out/cycles}"
depth=32
command -v blender > /dev/null || { echo "compare_cycles.sh: install Debian's blender first"; exit 1; }
mkdir -p "$dir"
build/bin/phyvisgen render "$scene" --export "$dir/scene.glb" -o "$dir/ours.exr" --samples "$samples" --max-depth $depth --caustics
blender -b -P scripts/cycles_render.py -- "$dir/scene.glb" "$dir/ours.exr" "$dir" "$samples" $depth
