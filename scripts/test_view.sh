#!/bin/sh
# Makes the page of a set and of one of its episodes and opens them in headless Chromium: no message of an error, the page
# complete, something on the 3D view. Arguments: an episode set (else a small one is made), a folder for the screenshots.
set -eu
cd "$(dirname "$0")/.."
command -v chromium >/dev/null || scripts/apt_install.sh chromium
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
set="${1:-$folder/set}"
pictures="${2:-$folder}"
mkdir -p "$pictures"
[ $# -gt 0 ] || build/bin/phyvisgen generate tests/pipeline/small_task/push_beaker.yaml -n 2 -o "$set"
build/bin/phyvisgen view "$set" -o "$folder/set.html"
build/bin/phyvisgen view "$set/episode_000000" -o "$folder/episode.html"
for page in set episode; do
  for what in "--screenshot=$pictures/$page.png" --dump-dom; do
    # WebGL by software; every message of the page goes to the log
    timeout 120 chromium --headless --no-sandbox --disable-dev-shm-usage --use-gl=angle --use-angle=swiftshader \
      --enable-unsafe-swiftshader --user-data-dir="$folder/profile" --enable-logging=stderr --window-size=1240,1500 \
      --virtual-time-budget=8000 "$what" "file://$folder/$page.html" >"$folder/$page.dom" 2>"$folder/$page.log"
  done
  grep 'CONSOLE' "$folder/$page.log" | grep -v 'GPU stall due to ReadPixels' >"$folder/$page.messages" || true
  if grep -iE 'error|exception|fail' "$folder/$page.messages"; then
    echo "test_view: $page: the page complains" >&2
    exit 1
  fi
  for part in 'data-state="complete"' '<video' '<polyline' '<canvas'; do
    grep -q "$part" "$folder/$page.dom" || { echo "test_view: $page: the page lacks $part" >&2; exit 1; }
  done
  test -s "$pictures/$page.png"
done
echo "test_view: both pages are complete and without complaint"
