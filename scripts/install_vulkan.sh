#!/bin/sh
# Unpacks Mesa's Vulkan driver for processors from Debian's backports into build/mesa, without installing it: SAPIEN asks for
# VK_KHR_external_semaphore_fd, which Debian 12's own Mesa (22.3) lacks. Programs find it by the two variables that
# fidelity_tables.sh sets.
set -eu
cd "$(dirname "$0")/.."
mesa="$PWD/build/mesa"
[ -e "$mesa/lvp.json" ] && exit 0
scripts/apt_install.sh curl ca-certificates xz-utils libvulkan1 libegl1 libgl1-mesa-dri libllvm15 libwayland-client0 libx11-xcb1 \
  libxcb-dri3-0 libxcb-present0 libxcb-randr0 libxcb-shm0 libxcb-sync1 libxcb-xfixes0 libxshmfence1
debian=http://deb.debian.org/debian
mkdir -p "$mesa"
curl -fsS "$debian/dists/bookworm-backports/main/binary-amd64/Packages.xz" | xz -d >"$mesa/packages"
for package in mesa-vulkan-drivers libdrm2 libdrm-amdgpu1; do
  file=$(awk -v p="$package" '$0 == "Package: " p {found = 1} found && /^Filename:/ {print $2; exit}' "$mesa/packages")
  sum=$(awk -v p="$package" '$0 == "Package: " p {found = 1} found && /^SHA256:/ {print $2; exit}' "$mesa/packages")
  curl -fsS -o "$mesa/$package.deb" "$debian/$file"
  echo "$sum  $mesa/$package.deb" | sha256sum --check --quiet
  dpkg-deb -x "$mesa/$package.deb" "$mesa"
done
libraries="$mesa/usr/lib/x86_64-linux-gnu"
echo "{\"file_format_version\": \"1.0.0\", \"ICD\": {\"library_path\": \"$libraries/libvulkan_lvp.so\", \"api_version\": \"1.3.0\"}}" \
  >"$mesa/lvp.json"
