#!/bin/sh
# From a fresh Debian 12 machine to the first episode: installs, builds, runs the main job.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh
# the tests take as long to compile as the program; scripts/test.sh builds them
scripts/build.sh -DPVG_TESTS=OFF
scripts/install_denoiser.sh || echo "demo: Open Image Denoise could not be fetched; the built-in filter stands in"
echo "demo: phyvisgen generate data/tasks/weigh_beaker.yaml --episodes 1 -o out/demo"
build/bin/phyvisgen generate data/tasks/weigh_beaker.yaml --episodes 1 -o out/demo -v
echo "demo: look at out/demo/episode_000000/contact_sheet.png first; videos, states.h5 and summary.json lie beside it"
