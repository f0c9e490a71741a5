#!/bin/sh
# Installs the Debian 12 packages that building, testing and running phyvisgen takes. Nothing happens where they are all
# there already. Root, or a user with sudo.
set -eu

# compiler and build
PACKAGES="g++ cmake ninja-build"
# OpenCL: the loader and PoCL, which runs kernels on the CPU
PACKAGES="$PACKAGES ocl-icd-opencl-dev opencl-clhpp-headers pocl-opencl-icd"
# libraries
PACKAGES="$PACKAGES libeigen3-dev libyaml-cpp-dev nlohmann-json3-dev liburdfdom-dev libassimp-dev libtbb-dev
  libcli11-dev libfmt-dev libhdf5-dev libarchive-dev libopenimageio-dev libtinygltf-dev libompl-dev libfcl-dev
  libmeshoptimizer-dev"
# compilers of other vendors' GPUs: the build makes and links machine code of every kernel (kernels/CMakeLists.txt)
PACKAGES="$PACKAGES clang-19 lld-19 libclc-19 intel-opencl-icd"
# programs that are called: tetrahedra, videos
PACKAGES="$PACKAGES tetgen ffmpeg"
# three.js, which goes into the pages of `phyvisgen view`
PACKAGES="$PACKAGES libjs-three"
# tests; OpenSubdiv is the oracle of our own subdivision
PACKAGES="$PACKAGES libgtest-dev libosd-dev"

missing=""
for package in $PACKAGES; do
  dpkg -s "$package" 2>/dev/null | grep -q '^Status: install ok installed' || missing="$missing $package"
done
if [ -z "$missing" ]; then
  echo "install: all packages are there"
  exit 0
fi

as_root=""
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || { echo "install: run as root, or install sudo; missing:$missing" >&2; exit 1; }
  as_root="sudo"
fi
echo "install: apt-get installs$missing"
export DEBIAN_FRONTEND=noninteractive
$as_root apt-get update -qq
# no recommended packages: they would double the download
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
echo "install: done"
