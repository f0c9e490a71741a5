#!/bin/sh
# Installs what `phyvisgen calibrate camera` and `calibrate pose` take beside scripts/install.sh: OpenCV's calib3d and the
# AprilTag library (60 packages, 30 MB to download, 125 MB on the disk). Build again afterwards.
set -eu

PACKAGES="libopencv-calib3d-dev libapriltag-dev"
# shellcheck disable=SC2086
dpkg -s $PACKAGES >/dev/null 2>&1 && { echo "install_calibration: all packages are there"; exit 0; }
as_root=""
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || { echo "install_calibration: run as root, or install sudo" >&2; exit 1; }
  as_root="sudo"
fi
$as_root apt-get update -qq
# shellcheck disable=SC2086
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $PACKAGES >/dev/null
echo "install_calibration: done"
