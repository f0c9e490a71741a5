#!/usr/bin/env python3
"""Renders a scene with phyvisgen and with Mitsuba 3, in turns, and prints paths per processor second of both, the means of
both pictures, and their errors at equal processor seconds.

  compare_mitsuba.py PHYVISGEN [SCENE.yaml] [--without ball] [--straight-shadows] [--turns 5] [--error 4096] [--adaptive]

A program's time is user and system time of its process; that of its start, of compiling and of writing is taken away as the
difference of two numbers of samples. Mitsuba's scene is made from the same file: same meshes, camera, light, number of bounces,
and Russian roulette from the same bounce. Two things differ: Mitsuba lets at least 5 % of the paths end by roulette and weighs
their throughput by the index of refraction; phyvisgen's samples are stratified, Mitsuba's independent.
Refracted light of lamps is traced by both, unless --straight-shadows.

--error N: relative squared error, the mean of (x - r)^2 / (r^2 + 0.01) over pixels and channels. Each program's reference r has
N samples of another seed; its own noise, 1 / N of the error of one sample, is taken away. --adaptive: ours once more with
adaptive samples, against the same reference.

Needs mitsuba 3.9.1 and PyYAML (scripts/python_env.sh mitsuba mitsuba==3.9.1 pyyaml). The variant llvm_ad_rgb needs the library
of LLVM that DRJIT_LIBLLVM_PATH names.
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy as np
import yaml

SIZE = ("--width", "640", "--height", "360")
PIXELS = 640 * 360
SAMPLES = (16, 80)  # of the two runs of a turn
FIELD_OF_VIEW = 22.53  # vertical, 39 degrees across: the box fills the picture, as in `bench render`


def mitsuba_scene(mi, path, depth):
    """The scene of a file with diffuse and clear glass things, rectangle lights and one camera."""
    described = yaml.safe_load(path.read_text())
    scene = {"type": "scene", "integrator": {"type": "path", "max_depth": depth + 1, "rr_depth": 3}}
    materials = {}
    for m in described["materials"]:
        if m["kind"] == "diffuse":
            materials[m["name"]] = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": m["color"]}}}
        elif m["kind"] == "dielectric":
            materials[m["name"]] = {"type": "dielectric", "int_ior": m["index_of_refraction"], "ext_ior": 1.0}
        else:
            sys.exit(f"compare_mitsuba.py: material {m['name']} is {m['kind']}; diffuse and dielectric can be compared")
    for thing in described["objects"]:
        for i, visual in enumerate(thing["visuals"]):
            mesh = path.parent / visual["mesh"]
            has_normals = any(line.startswith("vn ") for line in mesh.read_text().splitlines())
            scene[f"{thing['name']}_{i}"] = {"type": "obj", "filename": str(mesh), "face_normals": not has_normals,
                                             "bsdf": materials[visual["material"]]}
    for light in described["lights"]:
        corner, u, v = (np.array(light[key], float) for key in ("corner", "edge_u", "edge_v"))
        turn = np.eye(4)  # Mitsuba's rectangle is [-1, 1]^2 and shines along u x v, as ours
        turn[:3, 0], turn[:3, 1] = u / 2, v / 2
        turn[:3, 2] = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
        turn[:3, 3] = corner + u / 2 + v / 2
        scene[light["name"]] = {"type": "rectangle", "to_world": mi.ScalarTransform4f(turn),
                                "emitter": {"type": "area", "radiance": {"type": "rgb", "value": light["radiance"]}}}
    camera = described["cameras"][0]
    scene["camera"] = {
        "type": "perspective", "fov_axis": "y", "fov": float(str(camera["vertical_field_of_view"]).removesuffix("deg")),
        "to_world": mi.ScalarTransform4f().look_at(origin=camera["position"], target=camera["look_at"], up=camera["up"]),
        "sampler": {"type": "independent"},
        "film": {"type": "hdrfilm", "width": 640, "height": 360, "rfilter": {"type": "box"}, "pixel_format": "rgb",
                 "component_format": "float32"}}
    return scene


def mitsuba_main(variant, path, depth, samples, seed, output):
    """The child process: one picture by Mitsuba."""
    import mitsuba as mi
    mi.set_variant(variant)
    scene = mi.load_dict(mitsuba_scene(mi, pathlib.Path(path), int(depth)))
    part = 128  # samples at once: what fits the memory
    total, samples = 0, int(samples)
    for first in range(0, samples, part):
        n = min(part, samples - first)
        total = total + n * np.array(mi.render(scene, spp=n, seed=int(seed) * 1000 + first // part))
    np.save(output, (total / samples).astype(np.float32))


def processor_seconds(command):
    """User and system time of a process, whose output is shown where it fails."""
    before = os.times()
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"compare_mitsuba.py: {command[0]} failed:\n{done.stdout}")
    after = os.times()
    return after.children_user - before.children_user + after.children_system - before.children_system


class Ours:
    name = "phyvisgen"

    def __init__(self, program, scene, depth, is_straight, folder):
        self.command = [program, "render", scene, *SIZE, "--max-depth", depth] + ([] if is_straight else ["--caustics"])
        self.output = folder / "ours.exr"

    def render(self, samples, seed=1):
        return processor_seconds([*self.command, "--samples", samples, "--seed", seed, "-o", self.output])

    def picture(self):
        import mitsuba as mi
        mi.set_variant("scalar_rgb")
        return np.array(mi.Bitmap(str(self.output)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False))


class Mitsuba:
    def __init__(self, variant, scene, depth, folder):
        self.name = f"Mitsuba {variant}"
        self.command = [sys.executable, __file__, "--child", variant, scene, depth]
        self.output = folder / "theirs.npy"

    def render(self, samples, seed=1):
        return processor_seconds([*self.command, samples, seed, self.output])

    def picture(self):
        return np.load(self.output)


def rate(program):
    """Million paths per processor second."""
    few, many = (program.render(n) for n in SAMPLES)
    return 1e-6 * PIXELS * (SAMPLES[1] - SAMPLES[0]) / (many - few)


def error(picture, reference):
    return float(np.mean((picture - reference) ** 2 / (reference ** 2 + 0.01)))


def error_and_cost(program, reference):
    """Error of the larger number of samples, reference's noise included; processor seconds a sample."""
    few = program.render(SAMPLES[0], seed=3)
    seconds = program.render(SAMPLES[1], seed=3) - few
    return error(program.picture(), reference), seconds / (SAMPLES[1] - SAMPLES[0])


def report_cost(name, less_noise, per_sample):
    print(f"{name}: error of {SAMPLES[1]} samples, less the reference's noise, {less_noise:.4f}; "
          f"{per_sample:.4f} processor seconds a sample", flush=True)
    return less_noise * per_sample


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("scene", type=pathlib.Path, nargs="?",
                        default=pathlib.Path(__file__).parent.parent / "data/scenes/cornell_glass.yaml")
    parser.add_argument("--without", action="append", default=[], help="leave this object out")
    parser.add_argument("--straight-shadows", action="store_true", help="ours without --caustics")
    parser.add_argument("--depth", type=int, default=8, help="bounces")
    parser.add_argument("--variant", default="llvm_ad_rgb", help="of Mitsuba")
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--error", type=int, default=0, metavar="N", help="samples of the references")
    parser.add_argument("--adaptive", action="store_true", help="with --error: ours with adaptive samples, too")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        described = yaml.safe_load(arguments.scene.read_text())
        described["cameras"][0]["vertical_field_of_view"] = f"{FIELD_OF_VIEW} deg"
        described["objects"] = [o for o in described["objects"] if o["name"] not in arguments.without]
        for thing in described["objects"]:
            for visual in thing["visuals"]:
                visual["mesh"] = str((arguments.scene.parent / visual["mesh"]).resolve())
        scene = folder / "scene.yaml"
        scene.write_text(yaml.safe_dump(described))
        ours = Ours(arguments.program, scene, arguments.depth, arguments.straight_shadows, folder)
        theirs = Mitsuba(arguments.variant, scene, arguments.depth, folder)
        for program in (ours, theirs):
            program.render(SAMPLES[0])  # compiles all kernels
        print(f"million paths per processor second, {SAMPLES[1] - SAMPLES[0]} samples", flush=True)
        ratios = []
        for turn in range(arguments.turns):
            here, there = rate(ours), rate(theirs)
            ratios.append(here / there)
            print(f"turn {turn + 1}: {ours.name} {here:.3f}, {theirs.name} {there:.3f}, ratio {ratios[-1]:.2f}", flush=True)
        if ratios:
            print(f"median ratio {statistics.median(ratios):.2f}")
        means = [program.picture().mean(axis=(0, 1)) for program in (ours, theirs)]
        print("means of red, green, blue: " + "; ".join(" ".join(f"{c:.4f}" for c in mean) for mean in means) +
              f"; ours over theirs - 1: {' '.join(f'{100 * c:+.2f} %' for c in means[0] / means[1] - 1)}", flush=True)
        if arguments.error:
            costs = []
            for program in (ours, theirs):
                program.render(arguments.error, seed=2)
                reference = program.picture()
                measured, per_sample = error_and_cost(program, reference)
                of_reference = measured * SAMPLES[1] / (arguments.error + SAMPLES[1])
                costs.append(report_cost(program.name, measured - of_reference, per_sample))
                if program is ours and arguments.adaptive:
                    ours.command.append("--adaptive")
                    measured, per_sample = error_and_cost(ours, reference)
                    adaptive = report_cost(f"{ours.name} --adaptive", measured - of_reference, per_sample)
                    shift = 100 * (ours.picture().mean() / reference.mean() - 1)
                    print(f"its mean over that of the reference - 1: {shift:+.2f} %", flush=True)
            print(f"error at equal processor seconds, ours over theirs: {costs[0] / costs[1]:.2f}")
            if arguments.adaptive:
                print(f"the same with --adaptive: {adaptive / costs[1]:.2f}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        mitsuba_main(*sys.argv[2:])
    else:
        main()
