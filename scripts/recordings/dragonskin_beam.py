#!/usr/bin/env python3
"""A clamped silicone beam, held and let go, one recording for each load: under its own weight, or with grams at its tip.

    scripts/recordings/dragonskin_beam.py FOLDER_OF_CSV OUT

FOLDER_OF_CSV holds beam_LOAD_VERSION_REPEAT.csv, LOAD being `gravity`, or `load` and grams, such as load52. The files'
beam lies along z and falls along -x; here it lies along x and falls along -z. Each run begins where the tip begins to
fall; where a marker sits then is taken as its place on the straight beam. The last repeat is held out, the others are
fitted.
"""
import argparse
import pathlib

from recording_files import read_rows, write_recording, write_run

STARTS_TO_FALL = 3e-4  # of a tip marker, from where it was held [m]
SAMPLES = 120  # at 100 Hz: four swings with the weight, in which all that is damped is seen
LENGTH, BASE = 0.1, -0.0215  # of the beam, and where the base's markers lie along it in the files [m]

SCENE = """schema: 1
name: silicone_beam
time_step: 10 ms
duration: 1.2 s
solver: {{velocity_tolerance: 1e-5}}
bodies:
  - {{name: wall, kind: static, shape: {{box: {{size: [0.01, 0.01, 0.01]}}}}, collides: false}}
{weight}  - name: beam
    kind: soft
    shape: {{bar: {{size: [0.1, 0.03, 0.03], divisions: [6, 1, 1], nodes_per_element: 10}}}}
    material: {{density: 1070, youngs_modulus: 263824, poisson_ratio: 0.49}}
stitches:
  - {{soft: beam, rigid: wall, low: [-0.0501, -1, -1], high: [-0.0499, 1, 1], stiffness: 1e6}}
{hung}"""
WEIGHT = "  - {{name: weight, kind: rigid, shape: {{box: {{size: [0.01, 0.01, 0.01]}}}}, mass: {mass}, pose: {{position: [0.05, 0, 0]}}, collides: false}}\n"
HUNG = "  - {soft: beam, rigid: weight, low: [0.0499, -1, -1], high: [0.0501, 1, 1], stiffness: 1e5}\n"


def turned(row, marker, centre):
    """A marker's place in the beam's frame: its middle is the origin, x along it, z up."""
    x, y, z = (float(row[f"{marker}_{axis}"]) for axis in "xyz")
    return [z - centre[2], -(y - centre[1]), x - centre[0]]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=pathlib.Path, help="folder of beam_*.csv")
    parser.add_argument("out", type=pathlib.Path, help="a folder for the recordings")
    options = parser.parse_args()
    out = options.out
    loads = sorted({file.stem.split("_")[1] for file in options.source.glob("beam_*_*.csv")})
    if not loads:
        parser.error(f"{options.source} has no beam_LOAD_VERSION_REPEAT.csv")
    for load in loads:
        runs, points = [], None
        files = sorted(options.source.glob(f"beam_{load}_*.csv"))
        for file in files:
            rows = read_rows(file)
            # the files' zero lies at the beam's clamp, in the corner of its section
            centre = [sum(float(rows[0][f"Base-{i}_{axis}"]) for i in (1, 2, 3)) / 3 for axis in "xyz"]
            centre[2] = LENGTH / 2 + centre[2] - BASE - 0.0215
            held = [turned(rows[0], f"Tip-{i}", centre) for i in (1, 2, 3)]
            first = next(k for k, row in enumerate(rows)
                         if any(abs(turned(row, f"Tip-{i + 1}", centre)[2] - held[i][2]) > STARTS_TO_FALL for i in range(3)))
            start = max(first - 1, 0)
            points = points or held
            samples = []
            for row in rows[start:start + SAMPLES]:
                sample = [float(row["t"]) - float(rows[start]["t"])]
                for i in range(3):
                    now = turned(row, f"Tip-{i + 1}", centre)
                    sample += [points[i][k] + now[k] - held[i][k] for k in range(3)]
                samples.append(sample)
            header = ["t"] + [f"tip{i}_{axis}" for i in (1, 2, 3) for axis in "xyz"]
            write_run(out / load, file.stem + ".csv", header, samples)
            runs.append((file.stem + ".csv", "held_out" if len(files) > 1 and file == files[-1] else "fit"))
        channels = [f"{{columns: [tip{i}_x, tip{i}_y, tip{i}_z], kind: marker, body: beam, "
                    f"point: [{', '.join(f'{value:.5f}' for value in points[i - 1])}], unit: m, noise: 0.0001}}" for i in (1, 2, 3)]
        grams = float(load.removeprefix("load")) if load != "gravity" else 0
        scene = SCENE.format(weight=WEIGHT.format(mass=f"{grams / 1000:g}") if grams else "", hung=HUNG if grams else "")
        write_recording(out / load, scene, runs, channels)


if __name__ == "__main__":
    main()
