#!/usr/bin/env python3
"""The torque-limited pendulum of DFKI's underactuated lab as a recording: torque in, angle and rate out.

    scripts/recordings/dfki_pendulum.py FOLDER_OF_CSV OUT

FOLDER_OF_CSV holds single_*.csv with time, position (0: hanging), velocity, torque. The scene is the published nominal
model, a point mass: inertia 0.0626 kg m^2 and first moment 0.102 kg m about the axis.
"""
import pathlib
import sys

from recording_files import read_rows, write_recording, write_run

INERTIA, MOMENT = 0.0626, 0.102  # [kg m^2], [kg m]
HELD_OUT = ("ddp", "energy_shaping")  # swing-ups by other controllers than the fitted motions

SCENE = f"""schema: 1
name: dfki_pendulum
time_step: 2 ms
duration: 5 s
bodies:
  - {{name: motor, kind: static, shape: {{box: {{size: [0.02, 0.02, 0.02]}}}}, collides: false}}
  - {{name: tip, kind: rigid, shape: {{box: {{size: [0.02, 0.02, 0.02]}}}}, mass: {MOMENT**2 / INERTIA:.6f}, pose: {{position: [0, 0, {-INERTIA / MOMENT:.6f}]}}, collides: false}}
joints:
  - {{name: shaft, type: revolute, parent: motor, child: tip, axis: [0, 1, 0], drive: {{mode: torque, target: 0}}}}
"""


def main():
    source, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    runs = []
    for file in sorted(source.glob("single_*.csv")):
        rows = [[float(row[key]) for key in ("time", "position", "velocity", "torque")] for row in read_rows(file)]
        name = file.stem.removeprefix("single_")
        kept = [rows[0]]
        for row in rows[1:]:
            if row[0] > kept[-1][0]:  # some clocks stand still for a sample
                kept.append(row)
        write_run(out, name + ".csv", ["t", "q", "rate", "torque"], kept)
        runs.append((name + ".csv", "held_out" if name in HELD_OUT else "fit"))
    write_recording(out, SCENE, runs,
                    ["{column: q, kind: position, joint: shaft, unit: rad, noise: unknown}",
                     "{column: rate, kind: rate, joint: shaft, unit: rad/s, noise: unknown}"],
                    ["{column: torque, target: joint/shaft/torque, unit: N m}"])


if __name__ == "__main__":
    main()
