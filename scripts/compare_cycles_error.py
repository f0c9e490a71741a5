#!/usr/bin/env python3
"""Errors of phyvisgen and of Blender's Cycles at equal processor seconds, with light that glass throws (--caustics).

  compare_cycles_error.py PHYVISGEN [SCENE.yaml] [--samples 64] [--reference 512] [--depth 32] [--adaptive]

Same scene (exported, materials rebuilt: scripts/cycles_render.py), camera, size and bounces. Relative squared error: the mean
of (x - r)^2 / (r^2 + 0.01) over pixels and channels. Each program's reference r has --reference samples of another seed; its own
noise, 1 / N of the error of one sample, is taken away. A sample's time is the difference of a quarter of the samples and all of
them, user and system time of the process. --adaptive: ours once more with adaptive samples.

Needs bpy (scripts/python_env.sh fidelity_tables ..., as scripts/fidelity_tables.sh makes it).
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

import bpy
import numpy as np

HERE = pathlib.Path(__file__).parent


def processor_seconds(command):
    """User and system time of a process, whose output is shown where it fails."""
    before = os.times()
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"compare_cycles_error.py: {command[0]} failed:\n{done.stdout}")
    after = os.times()
    return after.children_user - before.children_user + after.children_system - before.children_system


def picture(path):
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    values = np.empty(image.size[0] * image.size[1] * image.channels, dtype=np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(image.size[1], image.size[0], image.channels)[:, :, :3].astype(float)
    bpy.data.images.remove(image)
    return values


class Ours:
    def __init__(self, program, scene, depth, folder, more=()):
        self.name = " ".join(("phyvisgen", *more))
        self.command = [program, "render", scene, "--caustics", "--max-depth", depth, *more]
        self.output = folder / "ours.exr"

    def render(self, samples, seed):
        return processor_seconds([*self.command, "--samples", samples, "--seed", seed, "-o", self.output])


class Cycles:
    name = "Cycles"

    def __init__(self, scene, ours, depth, folder):
        self.before = [sys.executable, HERE / "cycles_render.py", "--", scene, ours, folder]
        self.depth, self.output = depth, folder / "cycles.exr"

    def render(self, samples, seed):
        return processor_seconds([*self.before, samples, self.depth, seed])


def measure(program, samples, reference, n_reference):
    few = program.render(samples // 4, 3)
    per_sample = (program.render(samples, 3) - few) / (samples - samples // 4)
    here = picture(program.output)
    error = float(np.mean((here - reference) ** 2 / (reference ** 2 + 0.01))) * n_reference / (n_reference + samples)
    shift = 100 * (here.mean(axis=(0, 1)) / reference.mean(axis=(0, 1)) - 1)
    print(f"{program.name}: error of {samples} samples, less the reference's noise, {error:.5f}; {per_sample:.4f} processor seconds a "
          f"sample; mean over the reference's - 1: {shift.round(2)} %", flush=True)
    return error * per_sample


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("scene", type=pathlib.Path, nargs="?", default=HERE.parent / "data/scenes/cornell_glass.yaml")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--reference", type=int, default=512, metavar="N")
    parser.add_argument("--depth", type=int, default=32, help="bounces")
    parser.add_argument("--adaptive", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        exported = folder / "scene.glb"
        ours = Ours(arguments.program, arguments.scene, arguments.depth, folder)
        processor_seconds([*ours.command, "--samples", 1, "-o", ours.output, "--export", exported])
        theirs = Cycles(exported, ours.output, arguments.depth, folder)
        references = []
        for program in (ours, theirs):
            program.render(arguments.reference, 2)
            references.append(picture(program.output))
        ratio = 100 * (references[0].mean(axis=(0, 1)) / references[1].mean(axis=(0, 1)) - 1)
        print(f"means of the references, ours over theirs - 1: {ratio.round(2)} %", flush=True)
        costs = [measure(p, arguments.samples, r, arguments.reference) for p, r in zip((ours, theirs), references)]
        print(f"error at equal processor seconds, ours over theirs: {costs[0] / costs[1]:.3f}", flush=True)
        if arguments.adaptive:
            cost = measure(Ours(arguments.program, arguments.scene, arguments.depth, folder, ("--adaptive",)),
                           arguments.samples, references[0], arguments.reference)
            print(f"the same with --adaptive: {cost / costs[1]:.3f}")


if __name__ == "__main__":
    main()
