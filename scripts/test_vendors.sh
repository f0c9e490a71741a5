#!/bin/sh
# Makes and links machine code of every kernel with every compiler that is here (clang for AMD and NVIDIA, Intel's ocloc,
# NVIDIA's ptxas) and compares what it takes with kernels/machine_code.csv. About three minutes of a processor.
#   test_vendors.sh                      ptxas, if it is not installed, comes from PyPI (47 MB) into build/vendors
#   test_vendors.sh --write              renews the table instead
#   test_vendors.sh --installed FOLDER   in that build folder, with the compilers that are installed: a test. It compiles
#                                        where kernels, flags or compilers are others than those that made the table
set -eu
cd "$(dirname "$0")/.."
build=build
if [ "${1:-}" = --installed ]; then
  build=$2
  if grep -q "^# inputs: $(scripts/machine_code.sh inputs)\$" kernels/machine_code.csv; then
    echo "test_vendors: kernels/machine_code.csv was made of these kernels by these compilers"
    exit 0
  fi
else
  scripts/install.sh
  [ -f build/CMakeCache.txt ] || cmake -S . -B build -G Ninja -DPVG_IO=OFF >build/configure.log 2>&1
fi
echo "test_vendors: compiling"
cmake --build "$build" -j "$(nproc)" --target machine_code >"$build/machine_code.log" || { tail -50 "$build/machine_code.log" >&2; exit 1; }
code=$build/machine_code

ptxas=$(command -v ptxas || find "$build/vendors" -path '*/bin/ptxas' 2>/dev/null | head -1)
if [ -z "$ptxas" ] && [ "${1:-}" != --installed ]; then
  mkdir -p build/vendors
  if python3 -m pip download -q --no-deps -d build/vendors nvidia-cuda-nvcc; then
    python3 -m zipfile -e build/vendors/nvidia_cuda_nvcc*.whl build/vendors
    ptxas=$(find build/vendors -path '*/bin/ptxas' | head -1)
    chmod +x "$ptxas"
  fi
fi
if [ -n "$ptxas" ]; then
  echo "test_vendors: ptxas"
  while read -r name; do
    to=$code/sm_90/$name
    mkdir -p "$(dirname "$to")"
    # a function that nobody made is an error here
    "$ptxas" -arch=sm_90 -v "$code/nvptx64/$name.ptx" -o "$to.cubin" >"$to.log" 2>&1 || { cat "$to.log" >&2; exit 1; }
  done <"$code/files"
else
  echo "test_vendors: without ptxas, nothing for sm_90"
fi

targets=$(ls "$code" | grep -vE '_O0$|^files$')
if [ "${1:-}" = --write ]; then
  table=kernels/machine_code.csv
  { grep '^#' "$table" 2>/dev/null | grep -v '^# inputs: ' || true
    echo "# inputs: $(scripts/machine_code.sh inputs)"
    echo "kernel,target,registers,private,spills"
    for target in $targets; do scripts/machine_code.sh list "$code" "$target"; done; } >"$table.new"
  mv "$table.new" "$table"
  echo "test_vendors: $table has $(grep -c , "$table") lines"
  exit 0
fi
failed=0
for target in $targets; do scripts/machine_code.sh check "$code" "$target" kernels/machine_code.csv || failed=1; done
exit $failed
