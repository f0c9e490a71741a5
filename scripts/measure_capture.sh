#!/bin/sh
# What a capture of a room costs and how far it is from the truth: of a synthetic room whose truth is known (30 frames
# with a Kinect's noise), and of FOLDER, of which every fifth frame is left out.
#   scripts/measure_capture.sh [FOLDER]
set -eu
cd "$(dirname "$0")/.."
build/bin/test_capture --gtest_also_run_disabled_tests --gtest_filter='Room.DISABLED_*'
[ $# -eq 0 ] || build/bin/phyvisgen capture room "$1" -o out/measured_room --hold-out 5
