#!/usr/bin/env python3
"""The torque-limited pendulum of DFKI's underactuated lab as a recording: torque in, angle and rate out.

    scripts/recordings/dfki_pendulum.py FOLDER_OF_CSV OUT [--held-out ddp,energy_shaping]

FOLDER_OF_CSV holds single_*.csv with time, position (0: hanging), velocity, torque. The scene is the published nominal
model, a point mass: inertia 0.0626 kg m^2 and first moment 0.102 kg m about the axis.
"""
import argparse
import pathlib

from recording_files import read_rows, write_recording, write_run

INERTIA, MOMENT = 0.0626, 0.102  # [kg m^2], [kg m]

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
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=pathlib.Path, help="folder of single_*.csv")
    parser.add_argument("out", type=pathlib.Path, help="folder of the recording")
    parser.add_argument("--held-out", default="ddp,energy_shaping", help="runs by other controllers than the fitted ones, with commas between")
    options = parser.parse_args()
    held_out, out = options.held_out.split(","), options.out
    files = sorted(options.source.glob("single_*.csv"))
    names = [file.stem.removeprefix("single_") for file in files]
    if not set(held_out) & set(names):
        parser.error(f"none of {options.held_out} is there to be held out; {options.source} has {', '.join(names) or 'no single_*.csv'}")
    runs = []
    for file, name in zip(files, names):
        rows = [[float(row[key]) for key in ("time", "position", "velocity", "torque")] for row in read_rows(file)]
        kept = [rows[0]]
        for row in rows[1:]:
            if row[0] > kept[-1][0]:  # some clocks stand still for a sample
                kept.append(row)
        write_run(out, name + ".csv", ["t", "q", "rate", "torque"], kept)
        runs.append((name + ".csv", "held_out" if name in held_out else "fit"))
    write_recording(out, SCENE, runs,
                    ["{column: q, kind: position, joint: shaft, unit: rad, noise: unknown}",
                     "{column: rate, kind: rate, joint: shaft, unit: rad/s, noise: unknown}"],
                    ["{column: torque, target: joint/shaft/torque, unit: N m}"])


if __name__ == "__main__":
    main()
