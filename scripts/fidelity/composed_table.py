#!/usr/bin/env python3
"""The composed scene of the pictures table: a glass beaker and a steel cup on the table of a captured room.

    composed_table.py ROOM PHOTOS OUT [--frames N...]

ROOM was written by `capture room PHOTOS -o ROOM --hold-out N`. Reality is each left-out photograph with both vessels
drawn into it by Cycles (room_photograph.py). Our columns show the captured room from the same camera: relit, emissive,
receiver. Tables are fitted to our picture of the empty room and the photograph as it is, which does not show the
vessels. Prints PSNR and SSIM of `evaluate fidelity`, of the whole picture and of a window around the vessels.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path += [str(HERE), str(HERE.parent.parent / "data")]
import asset_tools  # noqa: E402
import room_photograph as cycles  # noqa: E402
import steel_cup  # noqa: E402
from glb import read_glb  # noqa: E402

ROOT = HERE.parent.parent
PROGRAM = pathlib.Path(os.environ.get("PVG_PROGRAM", ROOT / "build/bin/phyvisgen"))
STEEL, STEEL_ROUGHNESS, GLASS_INDEX = (0.66, 0.65, 0.63), 0.3, 1.47
COLUMNS = ["relit", "emissive", "receiver"]


class Room:
    """Points, triangles and colours of all meshes of room.glb, in the room's frame: z up, as the file's buffers are."""

    def __init__(self, path):
        gltf, array = read_glb(path)
        points, triangles, colors = [], [], []
        for mesh in gltf["meshes"]:
            part = mesh["primitives"][0]
            if "COLOR_0" not in part["attributes"]:
                sys.exit(f"{path}: {mesh['name']} has no colours of points; capture the room with photographs")
            triangles.append(array(part["indices"]) + sum(map(len, points)))
            points.append(array(part["attributes"]["POSITION"]))
            colors.append(array(part["attributes"]["COLOR_0"]))
        self.points, self.triangles, self.colors = (np.concatenate(a) for a in (points, triangles, colors))


def read_obj(path):
    lines = [line.split() for line in path.read_text().splitlines()]
    points = np.array([line[1:4] for line in lines if line[:1] == ["v"]], float)
    faces = [[int(c.split("/")[0]) - 1 for c in line[1:]] for line in lines if line[:1] == ["f"]]
    return points, np.array([[f[0], f[k], f[k + 1]] for f in faces for k in range(1, len(f) - 1)])


def roll_pitch_yaw(q):
    r = cycles.rotation(q)
    return [np.arctan2(r[2, 1], r[2, 2]), np.arcsin(-r[2, 0]), np.arctan2(r[1, 0], r[0, 0])]


def scene_text(room, light, views, glass_at, steel_at, has_things):
    things = [("beaker", ROOT / "data/objects/beaker_visual.obj", "glass", glass_at), ("cup", "cup.obj", "steel", steel_at)]
    text = f"schema: 1\nname: composed\ntime_step: 10 ms\nbackground: {{mesh: {room.resolve() / 'room.glb'}, shadow_strength: 1}}\n"
    text += f"environment_map: {{file: {light.resolve()}}}\nobjects:\n"
    for name, mesh, look, at in things:
        x, y = (at[0], at[1]) if has_things else (50, 50)
        text += f"  - {{name: {name}, visuals: [{{mesh: {mesh}, material: {look}}}], fixed: true, pose: {{x: {x}, y: {y}, z: {at[2]}}}}}\n"
    text += "materials:\n" + f"  - {{name: glass, kind: dielectric, index_of_refraction: {GLASS_INDEX}}}\n"
    text += f"  - {{name: steel, kind: conductor, color: {list(STEEL)}, roughness: {STEEL_ROUGHNESS}}}\ncameras:\n"
    for name, view in views.items():
        width, height = view["size"]
        text += (f"  - {{name: {name}, width: {width}, height: {height}, intrinsics: {view['intrinsics']}, "
                 f"position: {view['position']}, rotation: {[float(a) for a in roll_pitch_yaw(view['quaternion'])]}}}\n")
    return text


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stderr}")
    return done.stdout


def draw(scene, name, column, samples, file):
    """linear picture by our renderer"""
    receivers = [] if column == "receiver" else ["--receivers", column]
    run(PROGRAM, "render", scene, "--camera", name, "--samples", samples, "--denoise", *receivers, "-o", file)
    return cycles.read_exr(file)[..., :3]


def score(folder, real, picture, region, lut):
    """(PSNR, SSIM) of a region, and after the table"""
    left, top, right, bottom = region
    for side, pixels in (("real", real), ("sim", picture)):
        (folder / side).mkdir(parents=True, exist_ok=True)
        cycles.write_coded(folder / side / "picture.png", pixels[top:bottom, left:right])
    run(PROGRAM, "evaluate", "fidelity", folder / "real", folder / "sim", "--lut", lut, "-o", folder / "report")
    frame = json.loads((folder / "report/report.json").read_text())["frames"][0]
    return frame


def print_table(rows):
    names = sorted({name for _, name, _ in rows})
    print("| region, column | PSNR [dB], SSIM, mean | with a table | each, with a table |\n|---|---|---|---|")
    for where in ("whole", "window"):
        for column in COLUMNS:
            frames = [rows[where, name, column] for name in names]
            raw, lut = (", ".join(f"{np.mean([f[k] for f in frames]):.{d}f}" for k, d in keys)
                        for keys in ((("psnr", 2), ("ssim", 3)), (("lut_psnr", 2), ("lut_ssim", 3))))
            each = "; ".join(f"{f['lut_psnr']:.2f}, {f['lut_ssim']:.3f}" for f in frames)
            print(f"| {where}, {column} | {raw} | {lut} | {each} |")
    print("views: " + ", ".join(names))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("room", type=pathlib.Path)
    parser.add_argument("photos", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--frames", nargs="*", help="words in the names of the left-out photographs; else all that show both vessels")
    parser.add_argument("--glass", type=float, nargs=2, default=(-0.24, 0.34), help="place on the table, x y [m]")
    parser.add_argument("--steel", type=float, nargs=2, default=(-0.14, 0.42), help="[m]")
    parser.add_argument("--samples", type=int, default=16, help="of our pictures")
    parser.add_argument("--reality-samples", type=int, default=64, help="of Cycles")
    o = parser.parse_args()
    o.out.mkdir(parents=True, exist_ok=True)
    room = Room(o.room / "room.glb")

    def top(at):  # the table is not quite even: a thing stands on the highest point below it
        near = room.points[np.linalg.norm(room.points[:, :2] - at, axis=1) < steel_cup.RADIUS]
        return float(np.percentile(near[np.abs(near[:, 2]) < 0.02, 2], 90)) if len(near) else 0.0
    glass_at, steel_at = ([*at, top(at)] for at in (o.glass, o.steel))
    asset_tools.write_obj(str(o.out / "cup.obj"), steel_cup.mesh(), "a steel cup")
    beaker, cup = read_obj(ROOT / "data/objects/beaker_visual.obj"), read_obj(o.out / "cup.obj")
    things = [(beaker[0] + glass_at, beaker[1],
               lambda: cycles.material("glass", "ShaderNodeBsdfGlass", IOR=GLASS_INDEX, Roughness=0.0)[0]),
              (cup[0] + steel_at, cup[1],
               lambda: cycles.material("steel", "ShaderNodeBsdfAnisotropic", Color=STEEL + (1,), Roughness=STEEL_ROUGHNESS)[0])]
    camera_man = cycles.RoomPhotographer(room, things, (np.array(glass_at) + steel_at) / 2, o.out, o.reality_samples)
    known = camera_man.make_light()
    print(f"light: {100 * known:.0f} % of all directions are in the photographs, the rest is filled from their borders", flush=True)
    views = {}
    for view in json.loads((o.room / "report.json").read_text())["photos"]["each"]:
        pixels, depth = (np.concatenate(a) for a in zip(*(cycles.project(view, p) for p, _, _ in things)))
        is_seen = (depth > 0.1).all() and (pixels > 8).all() and (pixels < np.array(view["size"]) - 8).all()
        if is_seen and (not o.frames or any(word in view["file"] for word in o.frames)):
            views["f" + "".join(filter(str.isdigit, view["file"]))] = view
    scenes = {}
    for state in ("stood", "empty"):
        scenes[state] = o.out / f"{state}.yaml"
        scenes[state].write_text(scene_text(o.room, camera_man.light, views, glass_at, steel_at, state == "stood"))
    kept = o.out / "rows.json"  # of views that were drawn before
    rows = {tuple(key): frame for *key, frame in json.loads(kept.read_text())} if kept.exists() else {}
    for name, view in views.items():
        folder = o.out / name
        folder.mkdir(exist_ok=True)
        photo = cycles.read_linear(o.photos / view["file"])
        real, _ = camera_man.photograph(view, photo, name)
        pictures = {"photo": photo, "real": real}
        for column in COLUMNS:
            pictures[column] = draw(scenes["stood"], name, column, o.samples, folder / f"{column}.exr")
            if column != "emissive":
                empty = draw(scenes["empty"], name, column, o.samples, folder / f"empty_{column}.exr")
                # lamps of a relit room are as bright as the photograph wants them
                factor = photo.sum() / empty.sum() if column == "relit" else 1
                pictures[column], pictures["empty_" + column] = pictures[column] * factor, empty * factor
        for key, picture in pictures.items():
            cycles.write_coded(folder / f"{key}.png", picture)
        luts = {}
        for column in ("relit", "receiver"):
            for side, key in (("a", "empty_" + column), ("b", "photo")):
                (folder / column / side).mkdir(parents=True, exist_ok=True)
                cycles.write_coded(folder / column / side / "picture.png", pictures[key])
            luts[column] = folder / f"{column}.csv"
            run(PROGRAM, "calibrate", "lut", "--render", folder / column / "a", "--real", folder / column / "b", "-o", luts[column])
        for where, region in (("whole", (0, 0, *view["size"])), ("window", tuple(camera_man.window(view)))):
            for column in COLUMNS:
                frame = score(folder / where / column, real, pictures[column], region, luts.get(column, luts["receiver"]))
                rows[where, name, column] = frame
        kept.write_text(json.dumps([[*key, frame] for key, frame in rows.items()], indent=1))
        print(f"{name} is done", flush=True)
    print_table(rows)


if __name__ == "__main__":
    main()
