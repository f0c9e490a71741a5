#!/usr/bin/env python3
"""Balls dropped from a bridge, one recording for each ball: the first drop is fitted, the second held out.

    scripts/recordings/falling_balls.py drops.csv OUT [--fit 2]

drops.csv: ball, drop, t_s, height_m, velocity_m_s, mass_kg, diameter_m. Balls whose mass or diameter was not recorded
get 50 g and 70 mm: a free fall without drag does not depend on them, drag is then that of such a ball.
"""
import argparse
import math
import pathlib

from recording_files import read_rows, write_recording, write_run

SCENE = """schema: 1
name: falling_ball
time_step: 10 ms
duration: 3 s
bodies:
  - {{name: ball, kind: rigid, shape: {{sphere: {{radius: {radius:.5f}, subdivisions: 2}}}}, mass: {mass:.6f}, pose: {{position: [0, 0, 47]}}, collides: false}}
"""


def number(text, otherwise):
    value = float(text) if text else math.nan
    return value if math.isfinite(value) else otherwise


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("drops", type=pathlib.Path, help="drops.csv")
    parser.add_argument("out", type=pathlib.Path, help="a folder for the recordings")
    parser.add_argument("--fit", default="1", help="the drop that is fitted; all others are held out")
    options = parser.parse_args()
    rows, out = read_rows(options.drops), options.out
    for ball in sorted({row["ball"] for row in rows}):
        runs = []
        mine = [row for row in rows if row["ball"] == ball]
        for drop in sorted({row["drop"] for row in mine}):
            samples = [[float(row["t_s"]), float(row["height_m"])] for row in mine if row["drop"] == drop]
            write_run(out / ball, f"drop_{drop}.csv", ["t", "height"], samples)
            runs.append((f"drop_{drop}.csv", "fit" if drop == options.fit else "held_out"))
        scene = SCENE.format(radius=number(mine[0]["diameter_m"], 0.07) / 2, mass=number(mine[0]["mass_kg"], 0.05))
        write_recording(out / ball, scene, runs, ["{column: height, kind: position, body: ball, axis: [0, 0, 1], unit: m, noise: unknown}"])


if __name__ == "__main__":
    main()
