#!/bin/sh
# From depth pictures of a thing on a table to an episode in which the robot weighs it.
#   scripts/demo_capture_object.sh [FOLDER]     without FOLDER: 24 synthetic frames of a can with a Kinect's noise
# FOLDER: frames as of `phyvisgen capture object`; the thing must be upright, 60 to 76 mm wide and about 100 mm high.
set -eu
cd "$(dirname "$0")/.."
program=build/bin/phyvisgen
[ -x "$program" ] || { echo "demo_capture_object: there is no $program; scripts/build.sh makes it" >&2; exit 2; }
frames=${1:-}
case $frames in
  -*) echo "demo_capture_object: the first word is a folder of frames, or nothing" >&2; exit 2 ;;
esac
mkdir -p out
if [ -z "$frames" ]; then
  frames=out/can_frames
  scripts/python_env.sh capture numpy h5py
  .venv-capture/bin/python - out/can.obj <<'PYTHON'
import math, sys
N, RADIUS, HEIGHT = 64, 0.033, 0.1  # [1, m, m]
ring = [(RADIUS * math.cos(2 * math.pi * i / N), RADIUS * math.sin(2 * math.pi * i / N)) for i in range(N)]
points = [(x, y, z) for z in (0, HEIGHT) for x, y in ring] + [(0, 0, 0), (0, 0, HEIGHT)]
faces = [f for i in range(N) for j in [(i + 1) % N]
         for f in ((i, j, N + j), (i, N + j, N + i), (2 * N, j, i), (2 * N + 1, N + i, N + j))]
with open(sys.argv[1], "w") as file:
    file.writelines("v %.9g %.9g %.9g\n" % p for p in points)
    file.writelines("f %d %d %d\n" % tuple(k + 1 for k in f) for f in faces)
PYTHON
  .venv-capture/bin/python scripts/synthetic_room.py "$program" "$frames" --thing out/can.obj
fi
"$program" capture object "$frames" --mass 0.2 -o out/captured_can
# Weigh Beaker with the captured thing in the beaker's place
/usr/bin/python3 - <<'PYTHON'
import pathlib
import re
text = pathlib.Path("data/tasks/weigh_beaker.yaml").read_text()
text = text.replace("name: weigh_beaker", "name: weigh_captured").replace("../", "../../data/")
text = re.sub(r"    mesh: \S*beaker\.obj\n    visuals:\n.*?    density: [^\n]*\n",
              "    mesh: ../captured_can/simulation.obj\n    visuals: [{mesh: ../captured_can/visual.glb}]\n    mass: 0.2 kg\n",
              text, flags=re.S)
pathlib.Path("out/captured_task").mkdir(parents=True, exist_ok=True)
pathlib.Path("out/captured_task/weigh_captured.yaml").write_text(text)
PYTHON
"$program" generate out/captured_task/weigh_captured.yaml -n 1 -o out/captured_weighing
"$program" evaluate out/captured_weighing
echo "demo: look at out/captured_weighing/episode_000000/contact_sheet.png"
