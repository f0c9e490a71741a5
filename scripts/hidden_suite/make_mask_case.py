#!/usr/bin/env python3
"""Writes recordings whose only measurement is pictures: a soft finger hangs from a hand that jerks sideways, a camera
sees it, and the masks of the finger are all that is known. The truth is simulated by phyvisgen itself on a finer mesh
with a tenth of the step, with one thing changed that the scene of the recording does not know.

    make_mask_case.py OUT [--program build/bin/phyvisgen]

OUT/finger_modulus: the finger is softer than the scene says. OUT/finger_damping: its material damps. OUT/finger_null:
nothing. Each has recording.yaml, scene.yaml, a folder per run and truth.json, which the scorer alone reads.
"""
import argparse
import json
import math
import pathlib
import subprocess

FPS = 50
DURATION = 0.6  # [s]
TRUE_STEP = 0.001  # [s]; the first picture is of the first step's end. Second order: implicit Euler would damp the truth
RUNS = [  # amplitude [m] and rise time [s] of the hand's shift, role
    (0.040, 0.10, "fit"),
    (-0.030, 0.06, "fit"),
    (0.035, 0.16, "held_out"),
]
# Swings of a finger that nothing touches tell modulus over density alone.
CASES = {
    "finger_modulus": ("youngs_modulus: 0.30 MPa", "",
                       [{"name": "retune_youngs_modulus", "value": 0.30e6, "accept": ["retune_density"]}]),
    "finger_damping": ("youngs_modulus: 0.36 MPa", "effects:\n  - {effect: kelvin_voigt_damping, target: finger, viscosity: 600}\n",
                       [{"name": "kelvin_voigt_damping", "value": 600}]),
    "finger_null": ("youngs_modulus: 0.36 MPa", "", []),
}

SCENE = """schema: 1
name: finger
time_step: {step} ms
duration: {duration} s
solver: {{integrator: {integrator}}}
gravity: [0, 0, -9.81]
contact: {{activation_distance: 0.5 mm}}
bodies:
  - {{name: hand, kind: moving, shape: {{box: {{size: [0.03, 0.03, 0.01]}}}}, collides: false, path: [{path}]}}
  - name: finger
    kind: soft
    shape: {{bar: {{size: [0.08, 0.012, 0.012], divisions: {divisions}, nodes_per_element: 10}}}}
    pose: {{rotation: [0, 1.5707963267948966, 0]}}
    material: {{density: 1100, {modulus}, poisson_ratio: 0.35}}
stitches:
  - {{soft: finger, rigid: hand, low: [-0.0401, -1, -1], high: [-0.0399, 1, 1], stiffness: 1e6}}
cameras:
  - {{name: wrist, width: 96, height: 72, vertical_field_of_view: 40 deg, position: [0.02, -0.17, 0], look_at: [0.02, 0, 0], up: [0, 0, 1]}}
{effects}"""


def shift_at(amplitude, rise, t):
    """Place of the hand: a smooth step that begins at 0.1 s."""
    s = min(max((t - 0.1) / rise, 0.0), 1.0)
    return amplitude * s * s * s * (10 - 15 * s + 6 * s * s)


def path_of(amplitude, rise):
    n = round(DURATION * 200)
    return [(i / 200, shift_at(amplitude, rise, i / 200)) for i in range(n + 1)]


def scene_text(path, **values):
    points = ", ".join(f"{{time: {t}, position: [{x:.7f}, 0, 0.045]}}" for t, x in path)
    return SCENE.format(path=points, duration=DURATION, **values)


def write_case(out, name, program):
    modulus, effects, truth = CASES[name]
    case = out / name
    case.mkdir(parents=True, exist_ok=True)
    nominal = dict(step=10, integrator="implicit_euler", divisions="[6, 1, 1]", modulus="youngs_modulus: 0.36 MPa", effects="")
    (case / "scene.yaml").write_text(scene_text([(0, 0.0)], **nominal))
    recording = "schema: 1\nscene: scene.yaml\nruns:\n"
    for k, (amplitude, rise, role) in enumerate(RUNS):
        run = case / f"run_{k}"
        run.mkdir(exist_ok=True)
        path = path_of(amplitude, rise)
        true_scene = run / "true_scene.yaml"
        true_scene.write_text(scene_text(path, step=1000 * TRUE_STEP, integrator="bdf2", divisions="[12, 2, 2]", modulus=modulus, effects=effects))
        states = run / "true.h5"
        subprocess.run([program, "simulate", true_scene, "-o", states], check=True)
        subprocess.run([program, "render", true_scene, "--states", states, "--fps", str(FPS), "--samples", "1",
                        "--ground-truth", "-o", run / "seen"], check=True)
        (run / "seen" / "wrist_truth.h5").rename(run / "masks.h5")
        for file in [true_scene, states, *(run / "seen").iterdir()]:
            file.unlink()
        (run / "seen").rmdir()
        times = sorted({round(t, 6) for t, _ in path} | {round(TRUE_STEP + i / FPS, 6) for i in range(round(DURATION * FPS))})
        rows = [f"{t:.6f},{shift_at(amplitude, rise, t):.7f},0,0.045" for t in times]
        (run / "hand.csv").write_text("t,hx,hy,hz\n" + "\n".join(rows) + "\n")
        recording += f"  - {{file: run_{k}/hand.csv, role: {role}}}\n"
    recording += "inputs:\n  - {columns: [hx, hy, hz], target: body/hand/position, unit: m}\n"
    recording += "channels:\n  - {file: masks.h5, kind: mask, camera: wrist, part: finger}\n"
    (case / "recording.yaml").write_text(recording)
    (case / "truth.json").write_text(json.dumps({"effects": truth}, indent=2) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--program", default="build/bin/phyvisgen")
    parser.add_argument("--only", choices=CASES)
    options = parser.parse_args()
    for name in [options.only] if options.only else CASES:
        write_case(options.out, name, options.program)


if __name__ == "__main__":
    main()
