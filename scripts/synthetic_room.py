#!/usr/bin/env python3
"""Frames of a synthetic room as a first Kinect would record them, in the layout of 7-Scenes.

  synthetic_room.py PHYVISGEN FOLDER [--frames 24] [--width 480] [--seed 0] [--thing OBJ]

With --thing the bench bears that mesh, which stands on its own z = 0, and the frames go around it. The room (a floor,
two walls, a bench, things on it) is rendered by `phyvisgen render --ground-truth`. Depth gets the axial noise of Nguyen
et al. 2012, 1.2 mm + 1.9 mm (z - 0.4 m)^2/m^2, is rounded to millimetres and missing below 0.4 m.
Needs numpy and h5py; scripts/demo_capture.sh installs them.
"""
import argparse
import math
import pathlib
import shutil
import struct
import subprocess
import sys
import zlib

try:
    import h5py
    import numpy as np
except ModuleNotFoundError as error:
    sys.exit(f"synthetic_room: {sys.executable} lacks {error.name}; scripts/demo_capture.sh makes .venv-capture, which has it")

# low corner, high corner [m], colour, squares of a pattern [m] or 0
BOXES = {
    "floor": ((-2.0, -2.0, -0.80), (2.0, 2.0, -0.75), (0.45, 0.38, 0.30), 0.25),
    "wall_back": ((1.5, -2.0, -0.8), (1.55, 2.0, 1.5), (0.70, 0.68, 0.60), 0.0),
    "wall_side": ((-2.0, 1.5, -0.8), (2.0, 1.55, 1.5), (0.50, 0.58, 0.65), 0.0),
    "bench": ((-0.25, -0.75, -0.05), (1.15, 0.75, 0.0), (0.75, 0.55, 0.35), 0.1),
    "foot": ((0.3, -0.2, -0.75), (0.6, 0.2, -0.05), (0.25, 0.25, 0.27), 0.0),
    "books": ((0.85, 0.35, 0.0), (1.10, 0.65, 0.12), (0.65, 0.12, 0.10), 0.0),
    "box": ((0.80, -0.65, 0.0), (1.05, -0.40, 0.20), (0.15, 0.45, 0.20), 0.0),
    "shelf": ((1.25, -0.6, 0.50), (1.5, 0.9, 0.53), (0.40, 0.28, 0.18), 0.0),
}
LIGHTS = ("environment: [0.35, 0.37, 0.4]\nlights:\n  - {name: lamp, corner: [-0.4, -0.6, 1.9], edge_u: [0, 1.2, 0], "
          "edge_v: [1.2, 0, 0], radiance: [4, 3.9, 3.7]}\n")
CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def png(path, array):
    """8-bit RGB or 16-bit grey."""
    height, width = array.shape[:2]
    depth, kind = (8, 2) if array.ndim == 3 else (16, 0)
    rows = array.astype(">u2" if depth == 16 else "u1").tobytes()
    stride = len(rows) // height
    raw = b"".join(b"\0" + rows[y * stride:(y + 1) * stride] for y in range(height))

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw, 3)) + chunk(b"IEND", b""))


def write_box(path, low, high, square):
    """Texture coordinates in squares of the pattern."""
    points = [[(low, high)[c[k]][k] for k in range(3)] for c in CORNERS]
    text, n = "", 0
    for face in FACES:
        quad = np.array([points[i] for i in face])
        flat = [k for k in range(3) if np.ptp(quad[:, k]) > 0]
        for p in quad:
            text += "v %.9g %.9g %.9g\nvt %.9g %.9g\n" % (*p, p[flat[0]] / (8 * (square or 1)), p[flat[1]] / (8 * (square or 1)))
        text += "f %s\n" % " ".join("%d/%d" % (n + i, n + i) for i in (1, 2, 3))
        text += "f %s\n" % " ".join("%d/%d" % (n + i, n + i) for i in (1, 3, 4))
        n += 4
    path.write_text(text)


def pattern(seed):
    """8 x 8 squares of slightly different brightness, as of tiles or planks."""
    shades = np.random.default_rng(seed).uniform(0.75, 1.0, (8, 8))
    return np.repeat(np.repeat((255 * shades).astype("u1"), 16, 0), 16, 1)[:, :, None].repeat(3, 2)


def walk(n):
    """Eyes and what they look at."""
    for i in range(n):
        a = math.pi * (0.75 + 0.95 * i / n)
        r = 0.9 + 0.25 * (i % 3)
        yield (0.4 + r * math.cos(a), r * math.sin(a), 0.55 + 0.15 * (i % 4)), (0.55, 0.15 * math.sin(5 * a), (0, -0.2, 0.25)[i % 3])


def walk_around(n, middle):
    """Two rings, half a metre away."""
    for i in range(n):
        a = 2 * math.pi * i / n
        r, z = ((0.45, 0.25), (0.33, 0.42))[i % 2]
        yield (middle[0] + r * math.cos(a), middle[1] + r * math.sin(a), middle[2] + z), middle


THING_PLACE = (0.45, 0.0, 0.0)  # on the bench [m]


def write_scene(folder, views, width, height, thing=None, boxes=BOXES, lights=LIGHTS, pattern=pattern):
    """folder/scene.yaml; views: eyes and what they look at; pattern: picture on the box of a number"""
    materials, objects = [], []
    if thing:
        shutil.copy(thing, folder / "thing.obj")
        materials.append("  - {name: thing, kind: diffuse, color: [0.55, 0.2, 0.12]}\n")
        objects.append(f"  - {{name: thing, visuals: [{{mesh: thing.obj, material: thing}}], fixed: true, "
                       f"pose: {{x: {THING_PLACE[0]}, y: {THING_PLACE[1]}, z: {THING_PLACE[2]}}}}}\n")
    for k, (name, (low, high, color, square)) in enumerate(boxes.items()):
        write_box(folder / f"{name}.obj", low, high, square)
        texture = ""
        if square:
            png(folder / f"{name}.png", pattern(k))
            texture = f", texture: {name}.png"
        materials.append(f"  - {{name: {name}, kind: diffuse, color: {list(color)}{texture}}}\n")
        objects.append(f"  - {{name: {name}, visuals: [{{mesh: {name}.obj, material: {name}}}], fixed: true}}\n")
    cameras = []
    f = 585 * width / 640
    for i, (eye, at) in enumerate(views):
        cameras.append(f"  - {{name: c{i:03}, width: {width}, height: {height}, intrinsics: [{f}, {f}, {width / 2 - 0.5}, "
                       f"{height / 2 - 0.5}], position: {list(eye)}, look_at: {list(at)}, up: [0, 0, 1]}}\n")
    (folder / "scene.yaml").write_text(
        "schema: 1\nname: synthetic_room\ntime_step: 10 ms\nobjects:\n" + "".join(objects) + "materials:\n" +
        "".join(materials) + lights + "cameras:\n" + "".join(cameras) +
        "render: {frames_per_second: 10, samples: 16, max_depth: 4}\n")


def record(program, work, folder, n, seed):
    """The frames of the n cameras of work/scene.yaml, as the sensor would record them."""
    folder.mkdir(parents=True, exist_ok=True)
    subprocess.run([program, "render", work / "scene.yaml", "-o", work / "pictures", "--ground-truth", "--denoise"], check=True)
    random = np.random.default_rng(seed)
    for i in range(n):
        with h5py.File(work / f"pictures/c{i:03}_truth.h5") as truth:
            depth, pose, K = truth["depth"][0].astype(float), truth["T_world_camera"][0], truth["K"][()]
        depth[~np.isfinite(depth)] = 0
        sigma = 0.0012 + 0.0019 * (depth - 0.4) ** 2
        noisy = np.where((depth > 0.4) & (depth < 8), depth + sigma * random.standard_normal(depth.shape), 0)
        name = f"frame-{i:06}"
        png(folder / f"{name}.depth.png", np.round(1e3 * noisy))
        shutil.copy(work / f"pictures/c{i:03}_000000.png", folder / f"{name}.color.png")
        np.savetxt(folder / f"{name}.pose.txt", pose)
    np.savetxt(folder / "camera-intrinsics.txt", K)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("program")
    p.add_argument("folder", type=pathlib.Path)
    p.add_argument("--frames", type=int, default=24)
    p.add_argument("--width", type=int, default=480)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--thing", type=pathlib.Path, help="mesh (OBJ) that stands on the bench")
    a = p.parse_args()
    width, height = a.width // 2 * 2, a.width * 3 // 8 * 2
    work = a.folder.with_name(a.folder.name + "_scene")
    work.mkdir(parents=True, exist_ok=True)
    middle = (THING_PLACE[0], THING_PLACE[1], THING_PLACE[2] + 0.05)
    write_scene(work, walk_around(a.frames, middle) if a.thing else walk(a.frames), width, height, a.thing)
    record(a.program, work, a.folder, a.frames, a.seed)


if __name__ == "__main__":
    main()
