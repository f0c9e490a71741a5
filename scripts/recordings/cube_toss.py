#!/usr/bin/env python3
"""Tosses of an acrylic cube as a recording: position and orientation of the cube, every tenth toss.

    scripts/recordings/cube_toss.py tosses.csv OUT [EVERY]

tosses.csv: toss, frame, qw..qz (body to world), px..pz, and rates that are not used; 148 frames per second. Of the
chosen tosses two of three are fitted, the third is held out. The tracks were smoothed, so their own noise cannot be
told from them; 2 mm and 0.02 rad are assumed.
"""
import pathlib
import sys

from recording_files import read_rows, write_recording, write_run

RATE = 148.0  # frames per second

SCENE = """schema: 1
name: cube_toss
time_step: 1.689189189 ms
duration: 1 s
contact: {activation_distance: 0.5 mm, stiffness: 1 MPa, friction_velocity: 1e-3}
bodies:
  - {name: table, kind: half_space, normal: [0, 0, 1], point: [0, 0, -1.7 mm]}
  - {name: cube, kind: rigid, shape: {box: {size: [0.1048, 0.1048, 0.1048]}}, mass: 0.37,
     inertia: [8.1e-4, 8.1e-4, 8.1e-4], pose: {position: [0, 0, 1]}}
pair_friction:
  - {first: table, second: cube, coefficient: 0.18}
"""


def main():
    rows, out = read_rows(sys.argv[1]), pathlib.Path(sys.argv[2])
    every = int(sys.argv[3]) if len(sys.argv) > 3 else 10
    runs = []
    for count, toss in enumerate(sorted({int(row["toss"]) for row in rows})[::every]):
        samples = [[int(row["frame"]) / RATE] + [float(row[key]) for key in ("px", "py", "pz", "qx", "qy", "qz", "qw")]
                   for row in rows if int(row["toss"]) == toss]
        write_run(out, f"toss_{toss}.csv", ["t", "x", "y", "z", "qx", "qy", "qz", "qw"], samples)
        runs.append((f"toss_{toss}.csv", "held_out" if count % 3 == 2 else "fit"))
    write_recording(out, SCENE, runs,
                    ["{columns: [x, y, z], kind: position, body: cube, unit: m, noise: 0.002}",
                     "{columns: [qx, qy, qz, qw], kind: orientation, body: cube, noise: 0.02}"])


if __name__ == "__main__":
    main()
