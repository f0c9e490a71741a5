#!/bin/sh
# Makes the virtual environment .venv-NAME with the given packages of PyPI; nothing happens where it has them already.
# Arguments: NAME PACKAGE... The variable PYTHON names another interpreter than Debian's.
set -eu
cd "$(dirname "$0")/.."
name="$1"
shift
wanted="$*"
if [ -e ".venv-$name/packages" ] && [ "$(cat ".venv-$name/packages")" = "$wanted" ]; then exit 0; fi
# Debian's own Python, whose version is known
python="${PYTHON:-/usr/bin/python3}"
if [ "$python" = /usr/bin/python3 ] && ! "$python" -c 'import ensurepip' 2>/dev/null; then
  scripts/apt_install.sh python3-venv
fi
echo "install: .venv-$name gets $wanted"
"$python" -m venv ".venv-$name"
".venv-$name/bin/pip" install --quiet --disable-pip-version-check "$@"
echo "$wanted" >".venv-$name/packages"
