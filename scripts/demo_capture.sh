#!/bin/sh
# From depth pictures to a rendered task: captures a room, puts Weigh Beaker onto its table and shows the start.
#   scripts/demo_capture.sh [FOLDER]       without FOLDER: a synthetic room with a Kinect's noise
# With --episode as a second word one episode is generated as well (minutes).
set -eu
cd "$(dirname "$0")/.."
program=build/bin/phyvisgen
[ -x "$program" ] || { echo "demo_capture: there is no $program; scripts/build.sh makes it" >&2; exit 2; }
frames=${1:-}
case $frames in
  -*) echo "demo_capture: the first word is a folder of frames, synthetic, or nothing" >&2; exit 2 ;;
esac
if [ -z "$frames" ] || [ "$frames" = synthetic ]; then
  frames=out/synthetic_frames
  scripts/python_env.sh capture numpy h5py
  .venv-capture/bin/python scripts/synthetic_room.py "$program" "$frames"
fi
"$program" capture room "$frames" -o out/room --hold-out 6 --align-colors no
# the task without its own table and background; the middle of the captured table lies before the robot
mkdir -p out/captured_task
/usr/bin/python3 - <<'PYTHON'
import pathlib, re
text = pathlib.Path("data/tasks/weigh_beaker.yaml").read_text()
text = re.sub(r"  - name: table.*?(?=  - name: scale)", "", text, flags=re.S)
text = re.sub(r"background: .*\n", "background: {capture: ../room, position: [0.45, 0, 0]}\n", text)
# seen from the side of the photos: what no photo shows is guessed or black
text = text.replace("position: [1.20, -0.42, 0.50]\n    look_at: [0.40, 0.03, 0.19]", "position: [-0.50, 1.05, 0.85]\n    look_at: [0.42, 0.00, 0.17]")
text = text.replace("../robots", "../../data/robots").replace("../grippers", "../../data/grippers")
text = text.replace("../objects", "../../data/objects")
pathlib.Path("out/captured_task/weigh_beaker.yaml").write_text(text)
PYTHON
"$program" render out/captured_task/weigh_beaker.yaml --camera front --width 640 --height 360 --samples 32 -o out/captured_task/start.png
[ "${2:-}" != --episode ] || "$program" generate out/captured_task/weigh_beaker.yaml -n 1 -o out/captured_episode
echo "demo: look at out/captured_task/start.png; docs/guide/capture.md says how to go on"
