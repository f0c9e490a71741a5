#!/bin/sh
# Makes the pages of a set, of one of its episodes and, where there is the Python of scripts/install_policy.sh, of an evaluation, and
# opens them in headless Chromium: no message of an error, the page complete, something on the 3D view. Arguments: an episode set (else a small one is made), a folder for the screenshots.
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
pages="set episode"
if [ -x .venv-policy/bin/python ]; then
  pages="$pages evaluation"
  # eight periods are too few to succeed, so that there is something to film
  build/bin/phyvisgen evaluate policy tests/pipeline/small_task/push_beaker.yaml --policy blind --baseline expert \
    --demonstrations "$set" -n 2 --length 8 --perturb latency=0:0.1 --points 2 --videos "$folder/videos" --json >"$folder/evaluation.json"
  build/bin/phyvisgen view "$folder/evaluation.json" -o "$folder/evaluation.html"
fi
for page in $pages; do
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
  parts='data-state="complete" <video <polyline <canvas'
  [ $page != evaluation ] || parts='data-state="complete" <video <polyline <circle sign'
  for part in $parts; do
    grep -q "$part" "$folder/$page.dom" || { echo "test_view: $page: the page lacks $part" >&2; exit 1; }
  done
  test -s "$pictures/$page.png"
done
echo "test_view: the pages of $pages are complete and without complaint"
