#!/bin/sh
# Packs an episode set in every format and reads the results with h5py, pyarrow, pandas and zarr (in .venv-check), compared
# with the states files. Argument: an episode set; without one a small set is made.
set -eu
case "${1:-}" in -*) sed -n '2,3s/^# //p' "$0"; [ "$1" = --help ] && exit 0; exit 2 ;; esac
cd "$(dirname "$0")/.."
scripts/install_pack.sh
scripts/python_env.sh check h5py pyarrow pandas "zarr<3"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
set="${1:-$folder/set}"
[ $# -gt 0 ] || build/bin/phyvisgen generate tests/pipeline/small_task/push_beaker.yaml -n 3 -o "$set"
for format in lerobot lerobot2 act robomimic zarr; do
  build/bin/phyvisgen pack "$set" --format $format -o "$folder/$format"
done
.venv-check/bin/python scripts/check_packed.py "$set" "$folder"
