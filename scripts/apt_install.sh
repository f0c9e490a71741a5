#!/bin/sh
# Installs those of the named Debian packages that are missing. Root, or a user with sudo.
#   apt_install.sh PACKAGE...
set -eu
missing=""
for package in "$@"; do
  dpkg -s "$package" 2>/dev/null | grep -q '^Status: install ok installed' || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=""
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || { echo "install: run as root, or install sudo; missing:$missing" >&2; exit 1; }
  as_root="sudo"
fi
echo "install: apt-get installs$missing"
$as_root apt-get update -qq
# no recommended packages: they would double the download
# shellcheck disable=SC2086
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
