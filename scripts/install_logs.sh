#!/bin/sh
# Makes .venv-logs: Python with what scripts/convert_log.py reads logs of ROS and of motion capture by.
set -eu
cd "$(dirname "$0")/.."
scripts/python_env.sh logs rosbags==0.11.9 ezc3d==1.7.2 h5py==3.16.0 pillow==13.0.0
