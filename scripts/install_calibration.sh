#!/bin/sh
# Installs what `phyvisgen calibrate camera` and `calibrate pose` take beside scripts/install.sh: OpenCV's calib3d and the
# AprilTag library (60 packages, 30 MB to download, 125 MB on the disk). Build again afterwards.
set -eu
"$(dirname "$0")/apt_install.sh" libopencv-calib3d-dev libapriltag-dev
