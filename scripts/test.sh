#!/bin/sh
# Installs, builds and runs all tests. Arguments go to ctest, such as -R Graph.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh
scripts/install_calibration.sh || echo "test: without OpenCV's calib3d, the calibration of cameras is not tested"
scripts/build.sh -DPVG_TESTS=ON
scripts/install_policy.sh || echo "test: without what PyPI has, the tests of the Python package are skipped"
scripts/install_checkers.sh || echo "test: without what PyPI has, packed sets are not tested by the checkers of others"
scripts/install_logs.sh || echo "test: without what PyPI has, logs of ROS and of motion capture are not tested"
echo "test: ctest"
cd build
# two at a time: PoCL spreads each kernel over the cores anyway
ctest --output-on-failure -j 2 "$@"
