#!/bin/sh
# What `phyvisgen --version` says of a program that was built in a git checkout, and outside of one. Argument: cmake.
set -eu
cmake=$1
script=$(cd "$(dirname "$0")/../.." && pwd)/pipeline/command_line/version.cmake
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export GIT_CEILING_DIRECTORIES="${folder%/*}"  # whatever is around the folder is no checkout of it
version() {
  "$cmake" -DSOURCE="$folder" -DVERSION=1.2.3 -DOUTPUT="$folder/version.cpp" -P "$script"
  sed -n 's/.*return "\(.*\)".*/\1/p' "$folder/version.cpp"
}
said=$(version)
[ "$said" = "1.2.3 (built outside of a git checkout)" ] || { echo "outside of a checkout it says: $said"; exit 1; }
git -C "$folder" init -q
git -C "$folder" -c user.name=nobody -c user.email=nobody@localhost commit -q --allow-empty -m empty
said=$(version)
[ "$said" = "1.2.3 (commit $(git -C "$folder" rev-parse --short HEAD))" ] || { echo "in a checkout it says: $said"; exit 1; }
