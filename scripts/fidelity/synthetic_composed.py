#!/usr/bin/env python3
"""The composed scene in a synthetic room, whose pictures may be shown: glass and steel on a captured table.

    synthetic_composed.py PHYVISGEN OUT PICTURE.png [--frames 32] [--samples 16] [--reality-samples 128]

Boxes with textures made here are rendered as a depth camera would record them and captured as a room. A glass beaker
and a steel cup are put on its table and drawn from a place that no frame was recorded from: as they stand in the true
room (reality), and in the captured one relit, emissive and as a shadow receiver, all by our own path tracer and under
the true lamp. The picture shows the four. Prints PSNR and SSIM of `evaluate fidelity` of each against reality.
Needs numpy, h5py and pillow; scripts/fidelity_tables.sh installs them.
"""
import argparse
import json
import pathlib
import subprocess
import sys

import numpy as np
from PIL import Image, ImageDraw

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "scripts"), str(ROOT / "data")]
import asset_tools  # noqa: E402
import steel_cup  # noqa: E402
import synthetic_room  # noqa: E402

# low corner, high corner [m], colour, size of an eighth of the texture [m] or 0: as synthetic_room.BOXES
BOXES = {
    **synthetic_room.BOXES,
    "floor": ((-2.0, -2.0, -0.80), (2.0, 2.0, -0.75), (0.50, 0.46, 0.42), 0.1),
    "bench": ((-0.25, -0.75, -0.05), (1.15, 0.75, 0.0), (0.80, 0.60, 0.40), 0.1),
    "poster": ((1.49, -0.30, 0.05), (1.5, 0.25, 0.42), (0.80, 0.80, 0.80), 0.07),
}
LAMP = ("environment: [0.22, 0.24, 0.27]\nlights:\n  - {name: lamp, corner: [0.75, 0.45, 1.4], edge_u: [0, 0.35, 0], "
        "edge_v: [0.35, 0, 0], radiance: [26, 25, 23]}\n")
EYE, AT = (-0.30, -0.52, 0.36), (0.48, -0.02, 0.05)
GLASS_AT, STEEL_AT = (0.24, -0.20), (0.26, 0.02)
WIDTH, HEIGHT, FIELD_OF_VIEW = 400, 280, 32
COLUMNS = ("relit", "emissive", "kept")


def texture(number):
    """Planks on the bench, tiles on the floor, coloured squares on the poster; [256 x 256 x 3]"""
    name = list(BOXES)[number]
    random = np.random.default_rng(number)
    y, x = np.mgrid[0:256, 0:256]
    if name == "bench":
        plank = y // 32
        rings = np.sin(0.9 * (y % 32) + 3 * np.sin(x / 40 + 2.1 * plank)) + random.normal(0, 0.3, (256, 1))
        shade = random.uniform(0.75, 0.95, 8)[plank] + 0.06 * rings
        shade[(y % 32) < 1] *= 0.5
    elif name == "floor":
        shade = random.uniform(0.7, 1.0, (4, 4))[y // 64, x // 64]
        shade[(y % 64 < 2) | (x % 64 < 2)] = 0.5
    else:
        hues = 0.5 * random.uniform(0.2, 0.9, (8, 8, 1)) + 0.5 * random.uniform(0.2, 0.9, (8, 8, 3))
        return np.uint8(255 * hues[y // 32, x // 32])
    return np.repeat(np.uint8(255 * np.clip(shade, 0, 1))[..., None], 3, 2)


def walk(n):
    """Around the bench on the side of the picture's camera, in three heights; none stands where the picture is taken."""
    for i in range(n):
        a = np.pi * (0.70 + 0.95 * i / n)
        r, z = 0.75 + 0.2 * (i % 3), 0.30 + 0.2 * (i % 4)
        yield (float(0.4 + r * np.cos(a)), float(r * np.sin(a)), z), (0.55, float(0.2 * np.sin(5 * a)), (0, -0.2, 0.2)[i % 3])


def vessels():
    """Their entries of `objects` and `materials`."""
    objects = "".join(
        f"  - {{name: {name}, visuals: [{{mesh: {mesh}, material: {look}}}], fixed: true, pose: {{x: {x}, y: {y}, z: 0.5 mm}}}}\n"
        for name, mesh, look, (x, y) in (("beaker", ROOT / "data/objects/beaker_visual.obj", "glass", GLASS_AT),
                                         ("cup", "cup.obj", "steel", STEEL_AT)))
    materials = ("  - {name: glass, kind: dielectric, index_of_refraction: 1.47}\n"
                 "  - {name: steel, kind: conductor, color: [0.66, 0.65, 0.63], roughness: 0.3}\n")
    return objects, materials


def write_scenes(work, room):
    objects, materials = vessels()
    camera = (f"cameras:\n  - {{name: view, width: {WIDTH}, height: {HEIGHT}, vertical_field_of_view: {FIELD_OF_VIEW} deg, "
              f"position: {list(EYE)}, look_at: {list(AT)}, up: [0, 0, 1]}}\n"
              "render: {frames_per_second: 10, max_depth: 12}\n")
    true = (work / "scene.yaml").read_text().split("cameras:")[0]
    (work / "reality.yaml").write_text(
        true.replace("objects:\n", "objects:\n" + objects).replace("materials:\n", "materials:\n" + materials) + camera)
    (work / "captured.yaml").write_text(
        f"schema: 1\nname: composed\ntime_step: 10 ms\nbackground: {{mesh: {room.resolve() / 'room.glb'}, shadow_strength: 0.9, "
        f"ambient: 0.3}}\nobjects:\n{objects}materials:\n{materials}{LAMP}{camera}")


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stderr}")
    return done.stdout


def joined(pictures):
    """Two rows of two with their names, in 256 colours"""
    sheet = Image.new("RGB", (2 * WIDTH + 4, 2 * HEIGHT + 4), "white")
    for k, (name, picture) in enumerate(pictures.items()):
        at = (k % 2 * (WIDTH + 4), k // 2 * (HEIGHT + 4))
        sheet.paste(picture, at)
        draw = ImageDraw.Draw(sheet)
        draw.rectangle((at[0], at[1], at[0] + 8 + draw.textlength(name), at[1] + 16), fill="white")
        draw.text((at[0] + 4, at[1] + 2), name, fill="black")
    return sheet.quantize(256, dither=Image.Dither.NONE)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("picture", type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=32)
    parser.add_argument("--samples", type=int, default=16, help="of our pictures, denoised")
    parser.add_argument("--reality-samples", type=int, default=128)
    o = parser.parse_args()
    work, frames, room = o.out / "scene", o.out / "frames", o.out / "room"
    work.mkdir(parents=True, exist_ok=True)
    synthetic_room.write_scene(work, list(walk(o.frames)), 480, 360, boxes=BOXES, lights=LAMP, pattern=texture)
    asset_tools.write_obj(str(work / "cup.obj"), steel_cup.mesh(), "a steel cup")
    synthetic_room.record(o.program, work, frames, o.frames, 0)
    run(o.program, "capture", "room", frames, "-o", room, "--keep-frame", "--align-colors", "no")
    write_scenes(work, room)
    run(o.program, "render", work / "reality.yaml", "--samples", o.reality_samples, "--denoise", "-o", work / "reality.png")
    pictures = {"reality (synthetic)": Image.open(work / "reality.png").convert("RGB")}
    for column in COLUMNS:
        file = work / f"{column}.png"
        run(o.program, "render", work / "captured.yaml", "--samples", o.samples, "--denoise", "--receivers", column, "-o", file)
        pictures["receiver" if column == "kept" else column] = Image.open(file).convert("RGB")
        for side, source in (("real", "reality"), ("sim", column)):
            (o.out / column / side).mkdir(parents=True, exist_ok=True)
            (o.out / column / side / "picture.png").write_bytes((work / f"{source}.png").read_bytes())
        run(o.program, "evaluate", "fidelity", o.out / column / "real", o.out / column / "sim", "-o", o.out / column / "report")
        frame = json.loads((o.out / column / "report/report.json").read_text())["frames"][0]
        print(f"{column}: PSNR {frame['psnr']:.2f} dB, SSIM {frame['ssim']:.3f}", flush=True)
    joined(pictures).save(o.picture, optimize=True)
    print(f"{o.picture}: {o.picture.stat().st_size} bytes")


if __name__ == "__main__":
    main()
