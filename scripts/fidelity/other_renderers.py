#!/usr/bin/env python3
"""The composed scene in a synthetic room, drawn by SAPIEN and by MuJoCo: what simulators make of a captured room.

    other_renderers.py PHYVISGEN OUT PICTURE.png [--samples 32]

OUT is what synthetic_composed.py left: `scene/captured.yaml`, exported as glTF, and `scene/reality.png`. Neither program
draws colours of vertices, so each triangle gets a texel of its mean colour. The room is a diffuse surface below the scene's
lamp. SAPIEN: rasterised below a point light of the lamp's intensity, and ray traced below a lamp of its size; MuJoCo:
rasterised below a spot, whose brightness has no unit, so that its picture is scaled to reality's mean. Prints PSNR
and SSIM of `evaluate fidelity` of each against reality. Needs sapien, mujoco, h5py and pillow, and a Vulkan driver with
VK_KHR_external_semaphore_fd: on a processor Mesa 24.3 or later (scripts/fidelity_tables.sh fetches one).
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys

import numpy as np
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "scripts"), str(ROOT / "data")]
from glb import read_glb  # noqa: E402
from synthetic_composed import AT, EYE, FIELD_OF_VIEW, HEIGHT, WIDTH, joined, run  # noqa: E402

# the lamp of synthetic_composed.LAMP: its middle [m], half of its side [m], radiance [W/(sr m^2)]; the environment
LAMP_AT, LAMP_HALF, LAMP_RADIANCE = np.array([0.925, 0.625, 1.4]), 0.175, np.array([26, 25, 23])
AMBIENT = [0.22, 0.24, 0.27]
LOOKS = {"glass": dict(transmission=1.0, ior=1.47, base_color=[1, 1, 1, 1], roughness=0.0, metallic=0.0),
         "steel": dict(base_color=[0.66, 0.65, 0.63, 1], roughness=0.3, metallic=1.0)}


def encoded(linear):
    """sRGB's curve"""
    linear = np.clip(linear, 0, 1)
    return np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def with_texels(points, triangles, colors, folder, name):
    """NAME.obj, whose triangles each show one texel of NAME.png"""
    n = len(triangles)
    side = int(np.ceil(np.sqrt(n)))
    texels = np.zeros((side * side, 3), np.uint8)
    texels[:n] = np.uint8(255 * encoded(colors[triangles].mean(1)) + 0.5)
    Image.fromarray(texels.reshape(side, side, 3)).save(folder / f"{name}.png")
    k = np.arange(n)
    with open(folder / f"{name}.obj", "w") as out:
        out.write(f"mtllib {name}.mtl\nusemtl room\n")
        np.savetxt(out, points, "v %.5f %.5f %.5f")
        np.savetxt(out, np.stack([(k % side + 0.5) / side, 1 - (k // side + 0.5) / side], 1), "vt %.6f %.6f")
        np.savetxt(out, np.stack([triangles + 1, np.repeat(k[:, None] + 1, 3, 1)], 2).reshape(n, 6), "f %d/%d %d/%d %d/%d")
    (folder / f"{name}.mtl").write_text(f"newmtl room\nKd 1 1 1\nmap_Kd {name}.png\n")


def without_texels(points, normals, triangles, folder, name):
    with open(folder / f"{name}.obj", "w") as out:
        np.savetxt(out, points, "v %.6f %.6f %.6f")
        np.savetxt(out, normals, "vn %.5f %.5f %.5f")
        np.savetxt(out, np.repeat(triangles + 1, 2, 1), "f %d//%d %d//%d %d//%d")


def parts_of(glb, folder):
    """An .obj of each mesh but the lamp, z up: the names of the files and of their looks, "room" of the captured"""
    gltf, array = read_glb(glb)
    parts = []
    for node in gltf["nodes"]:
        if "mesh" not in node:
            continue
        part = gltf["meshes"][node["mesh"]]["primitives"][0]
        look = gltf["materials"][part["material"]]["name"]
        to_world = np.reshape(node["matrix"], (4, 4)).T  # the root turns z to y, which glTF wants up
        points = array(part["attributes"]["POSITION"]) @ to_world[:3, :3].T + to_world[:3, 3]
        name, triangles = f"part_{len(parts)}", array(part["indices"])
        if look in LOOKS:
            without_texels(points, array(part["attributes"]["NORMAL"]), triangles, folder, name)
        elif "COLOR_0" in part["attributes"]:
            with_texels(points, triangles, array(part["attributes"]["COLOR_0"]), folder, name)
            look = "room"
        else:
            continue
        parts.append((name, look))
    return parts


def camera_axes():
    forward = np.subtract(AT, EYE) / np.linalg.norm(np.subtract(AT, EYE))
    left = np.cross([0, 0, 1], forward)
    left /= np.linalg.norm(left)
    return forward, left, np.cross(forward, left)


def draw_sapien(shader, parts, folder, file, samples):
    import sapien
    sapien.render.set_camera_shader_dir(shader)
    if shader == "rt":
        sapien.render.set_ray_tracing_samples_per_pixel(samples)
        sapien.render.set_ray_tracing_path_depth(12)
    scene = sapien.Scene([sapien.render.RenderSystem()])
    scene.set_ambient_light(AMBIENT)
    for name, look in parts:
        builder = scene.create_actor_builder()
        material = None
        if look in LOOKS:
            material = sapien.render.RenderMaterial()
            for key, value in LOOKS[look].items():
                setattr(material, key, value)
        builder.add_visual_from_file(str(folder / f"{name}.obj"), material=material)
        entity = sapien.Entity()
        entity.add_component(builder.build_render_component())
        scene.add_entity(entity)
    if shader == "rt":
        down = sapien.Pose(LAMP_AT, [0.5 ** 0.5, 0, 0.5 ** 0.5, 0])
        scene.add_area_light_for_ray_tracing(down, LAMP_RADIANCE, LAMP_HALF, LAMP_HALF)
    else:
        scene.add_point_light(LAMP_AT, LAMP_RADIANCE * (2 * LAMP_HALF) ** 2, shadow=True)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2] = camera_axes()
    pose[:3, 3] = EYE
    camera = scene.add_camera("view", WIDTH, HEIGHT, np.deg2rad(FIELD_OF_VIEW), 0.01, 100)
    camera.set_entity_pose(sapien.Pose(pose))
    scene.update_render()
    camera.take_picture()
    picture = np.clip(camera.get_picture("Color")[..., :3], 0, 1)
    Image.fromarray(np.uint8(255 * picture + 0.5)).save(file)


def draw_mujoco(parts, folder, file, reality):
    import mujoco
    _, left, up = camera_axes()
    assets, shapes = "", ""
    for name, look in parts:
        assets += f'<mesh name="{name}" file="{name}.obj" inertia="shell"/>'
        if look == "room":
            assets += f'<texture name="{name}" type="2d" file="{name}.png"/><material name="{name}" texture="{name}"/>'
        else:
            rgba = "1 1 1 0.15" if look == "glass" else "0.66 0.65 0.63 1"
            assets += f'<material name="{name}" rgba="{rgba}" specular="1" shininess="0.7"/>'
        shapes += f'<geom type="mesh" mesh="{name}" material="{name}" contype="0" conaffinity="0"/>'
    at, axes = (" ".join(f"{x:.6f}" for x in v) for v in (EYE, [*-left, *up]))
    xml = (f'<mujoco><compiler meshdir="{folder}" texturedir="{folder}"/><asset>{assets}</asset>'
           f'<visual><headlight ambient="0.3 0.3 0.3" diffuse="0 0 0" specular="0 0 0"/>'
           f'<quality shadowsize="8192"/><global offwidth="{WIDTH}" offheight="{HEIGHT}"/><map znear="0.01"/></visual>'
           f'<worldbody><light pos="{" ".join(map(str, LAMP_AT))}" dir="0 0 -1" cutoff="90" exponent="1" '
           f'diffuse="0.7 0.7 0.7" castshadow="true"/>'
           f'<camera name="view" pos="{at}" xyaxes="{axes}" fovy="{FIELD_OF_VIEW}"/>{shapes}</worldbody></mujoco>')
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    renderer = mujoco.Renderer(model, HEIGHT, WIDTH)
    renderer.update_scene(data, "view")
    picture = renderer.render() / 255.0
    wanted = np.asarray(Image.open(reality).convert("RGB")) / 255.0
    Image.fromarray(np.uint8(255 * np.clip(picture * wanted.mean() / picture.mean(), 0, 1) + 0.5)).save(file)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("picture", type=pathlib.Path)
    parser.add_argument("--samples", type=int, default=32, help="of SAPIEN's ray tracing")
    parser.add_argument("--only", help=argparse.SUPPRESS)  # one of them, in a process of its own: SAPIEN takes one shader
    o = parser.parse_args()
    scene, folder = o.out / "scene", (o.out / "others").resolve()
    folder.mkdir(parents=True, exist_ok=True)
    if o.only:
        parts = json.loads((folder / "parts.json").read_text())
        if o.only == "mujoco":
            draw_mujoco(parts, folder, folder / "mujoco.png", scene / "reality.png")
        else:
            draw_sapien({"sapien": "default", "sapien_rt": "rt"}[o.only], parts, folder, folder / f"{o.only}.png", o.samples)
        return
    run(o.program, "render", scene / "captured.yaml", "--receivers", "relit", "--samples", 1, "-o", folder / "one.png",
        "--export", folder / "captured.glb")
    (folder / "parts.json").write_text(json.dumps(parts_of(folder / "captured.glb", folder)))
    pictures = {"reality (synthetic)": Image.open(scene / "reality.png").convert("RGB")}
    for name in ("sapien", "sapien_rt", "mujoco"):
        done = subprocess.run([sys.executable, __file__, *map(str, (o.program, o.out, o.picture)), "--samples", str(o.samples),
                               "--only", name], env={"MUJOCO_GL": "egl", **os.environ}, capture_output=True, text=True)
        file = folder / f"{name}.png"
        if done.returncode:
            print(f"{name}: does not run here: {done.stderr.strip().splitlines()[-1] if done.stderr.strip() else done.returncode}")
            continue
        for side, source in (("real", scene / "reality.png"), ("sim", file)):
            (folder / name / side).mkdir(parents=True, exist_ok=True)
            (folder / name / side / "picture.png").write_bytes(source.read_bytes())
        run(o.program, "evaluate", "fidelity", folder / name / "real", folder / name / "sim", "-o", folder / name / "report")
        frame = json.loads((folder / name / "report/report.json").read_text())["frames"][0]
        print(f"{name}: PSNR {frame['psnr']:.2f} dB, SSIM {frame['ssim']:.3f}", flush=True)
        pictures[name] = Image.open(file).convert("RGB")
    joined(pictures).save(o.picture, optimize=True)


if __name__ == "__main__":
    main()
