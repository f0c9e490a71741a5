#!/bin/sh
# Spoils a kernel by a private array of 8 KB, and sees that the comparison with the table finds it.
#   test_machine_code.sh CLANG LIBCLC, in a build folder in which gfx90a_O3 is compiled
set -eu
scripts=$(cd "$(dirname "$0")" && pwd)
kernels=$scripts/../kernels
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r machine_code/files machine_code/gfx90a_O3 "$folder/"
awk '{ print } /^  const uint c = get_global_id\(0\);/ && !done { done = 1
       print "  volatile uint spoilt[2048];\n  for (uint k = 0; k < 2048; ++k) spoilt[k] = k * c;\n  sums[c] = spoilt[c % 2048];" }' \
  "$kernels/shared/scan.cl" >"$folder/scan.cl"
"$1" -target amdgcn-amd-amdhsa -mcpu=gfx90a -x cl -cl-std=CL1.2 -Xclang -finclude-default-header -I"$kernels" -O3 \
  -nogpulib -Wno-linker-warnings -Xclang -mlink-builtin-bitcode -Xclang "$2" -S -o "$folder/gfx90a_O3/shared/scan.cl.s" \
  "$folder/scan.cl"
if said=$("$scripts/machine_code.sh" check "$folder" gfx90a_O3 "$kernels/machine_code.csv"); then
  echo "an array of 8 KB was not found" >&2
  exit 1
fi
echo "$said"
echo "$said" | grep -qE 'scan_sums on gfx90a_O3: (8[0-9]{3}) private bytes'
