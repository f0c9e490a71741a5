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
  libcli11-dev libfmt-dev libhdf5-dev libdeflate-dev libarchive-dev libopenimageio-dev libtinygltf-dev libompl-dev libfcl-dev
  libmeshoptimizer-dev"
# compilers of other vendors' GPUs: the build makes and links machine code of every kernel (kernels/CMakeLists.txt)
PACKAGES="$PACKAGES clang-19 lld-19 libclc-19 intel-opencl-icd"
# programs that are called: tetrahedra, videos
PACKAGES="$PACKAGES tetgen ffmpeg"
# three.js, which goes into the pages of `phyvisgen view`
PACKAGES="$PACKAGES libjs-three"
# tests; OpenSubdiv is the oracle of our own subdivision
PACKAGES="$PACKAGES libgtest-dev libosd-dev"

# shellcheck disable=SC2086
"$(dirname "$0")/apt_install.sh" $PACKAGES
echo "install: all packages are there"
