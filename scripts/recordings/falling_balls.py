#!/usr/bin/env python3
"""Balls dropped from a bridge, one recording for each ball: the first drop is fitted, the second held out.

    scripts/recordings/falling_balls.py drops.csv OUT

drops.csv: ball, drop, t_s, height_m, velocity_m_s, mass_kg, diameter_m. Balls whose mass or diameter was not recorded
get 50 g and 70 mm: a free fall without drag does not depend on them, drag is then that of such a ball.
"""
import math
import pathlib
import sys

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
    rows, out = read_rows(sys.argv[1]), pathlib.Path(sys.argv[2])
    for ball in sorted({row["ball"] for row in rows}):
        runs = []
        mine = [row for row in rows if row["ball"] == ball]
        for drop in sorted({row["drop"] for row in mine}):
            samples = [[float(row["t_s"]), float(row["height_m"])] for row in mine if row["drop"] == drop]
            write_run(out / ball, f"drop_{drop}.csv", ["t", "height"], samples)
            runs.append((f"drop_{drop}.csv", "fit" if drop == "1" else "held_out"))
        scene = SCENE.format(radius=number(mine[0]["diameter_m"], 0.07) / 2, mass=number(mine[0]["mass_kg"], 0.05))
        write_recording(out / ball, scene, runs, ["{column: height, kind: position, body: ball, axis: [0, 0, 1], unit: m, noise: unknown}"])


if __name__ == "__main__":
    main()
