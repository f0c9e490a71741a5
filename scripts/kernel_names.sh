#!/bin/sh
# The names of the kernels in a file of OpenCL C, those that energies/assemble.cl makes from TERM included.
set -eu
sed -nE 's/^kernel .*void ([a-z_0-9A-Z]+)\(.*/\1/p' "$1"
if grep -q 'assemble\.cl"' "$1"; then
  sed -nE 's/^#define TERM ([a-z_0-9]+).*/\1_energy_all \1_gradient_all \1_hessian_all \1_product_all/p' "$1"
fi
