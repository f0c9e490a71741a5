#!/usr/bin/env python3
"""Tosses of an acrylic cube as a recording: position and orientation of the cube, every tenth toss.

    scripts/recordings/cube_toss.py tosses.csv OUT --every 50

tosses.csv: toss, frame, qw..qz (body to world), px..pz, and rates that are not used; 148 frames per second. Of the
chosen tosses two of three are fitted, the third is held out. The tracks were smoothed, so their own noise cannot be
told from them; 2 mm and 0.02 rad are assumed.
"""
import argparse
import pathlib

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
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tosses", type=pathlib.Path, help="tosses.csv")
    parser.add_argument("out", type=pathlib.Path, help="folder of the recording")
    parser.add_argument("--every", type=int, default=10, help="of the tosses, which are many")
    parser.add_argument("--first", type=int, default=0, help="the first one that is taken")
    options = parser.parse_args()
    rows, out = read_rows(options.tosses), options.out
    runs = []
    for count, toss in enumerate(sorted({int(row["toss"]) for row in rows})[options.first::options.every]):
        samples = [[int(row["frame"]) / RATE] + [float(row[key]) for key in ("px", "py", "pz", "qx", "qy", "qz", "qw")]
                   for row in rows if int(row["toss"]) == toss]
        write_run(out, f"toss_{toss}.csv", ["t", "x", "y", "z", "qx", "qy", "qz", "qw"], samples)
        runs.append((f"toss_{toss}.csv", "held_out" if count % 3 == 2 else "fit"))
    write_recording(out, SCENE, runs,
                    ["{columns: [x, y, z], kind: position, body: cube, unit: m, noise: 0.002}",
                     "{columns: [qx, qy, qz, qw], kind: orientation, body: cube, noise: 0.02}"])


if __name__ == "__main__":
    main()
