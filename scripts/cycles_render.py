"""Renders an exported scene with Blender's Cycles and compares the picture with ours. Runs inside Blender:

    blender -b -P scripts/cycles_render.py -- SCENE.glb OURS.exr DIR SAMPLES DEPTH [SEED]

Materials are made anew from the file's numbers, so that both programs mean the same: Lambert's law, clear glass with
absorption, Schlick's conductors with GGX, light from one side of a surface. Unlit surfaces become shadow catchers, laid over
their colour. Writes DIR/cycles.exr, DIR/compared.png
(ours, Cycles', five times the difference around grey) and DIR/compared.json.
"""
import json
import os
import struct
import sys
import time

import bpy
import numpy

numpy.bool = bool  # that Debian 12's importer of glTF still asks for
glb, ours, folder, samples, depth, seed = (sys.argv[sys.argv.index("--") + 1:] + ["0"])[:6]


def gltf_json(path):
    with open(path, "rb") as file:
        file.seek(12)
        length, _ = struct.unpack("<II", file.read(8))
        return json.loads(file.read(length))


def is_captured(description):
    return "KHR_materials_unlit" in description.get("extensions", {})


def shader(material, description):
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    out = nodes.new("ShaderNodeOutputMaterial")
    pbr, more = description.get("pbrMetallicRoughness", {}), description.get("extensions", {})
    color = pbr.get("baseColorFactor", [1, 1, 1, 1])
    strength = more.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
    emission = [strength * e for e in description.get("emissiveFactor", [0, 0, 0])]
    if is_captured(description):
        color = [1, 1, 1, 1]
    if max(emission) > 0:
        front, dark, mix, side = (nodes.new("ShaderNode" + n) for n in ("Emission", "Emission", "MixShader", "NewGeometry"))
        front.inputs["Color"].default_value = emission + [1]
        dark.inputs["Strength"].default_value = 0
        links.new(side.outputs["Backfacing"], mix.inputs[0])
        links.new(front.outputs[0], mix.inputs[1])
        links.new(dark.outputs[0], mix.inputs[2])
        links.new(mix.outputs[0], out.inputs["Surface"])
    elif "KHR_materials_transmission" in more:
        glass = nodes.new("ShaderNodeBsdfGlass")
        if "SHARP" in glass.bl_rna.properties["distribution"].enum_items:
            glass.distribution = "SHARP"  # Blender 4 has none: without roughness any is
        glass.inputs["Roughness"].default_value = 0
        glass.inputs["Color"].default_value = color
        glass.inputs["IOR"].default_value = more.get("KHR_materials_ior", {}).get("ior", 1.5)
        links.new(glass.outputs[0], out.inputs["Surface"])
        volume = more.get("KHR_materials_volume", {})
        if "attenuationDistance" in volume:
            absorb = nodes.new("ShaderNodeVolumeAbsorption")  # sigma = density (1 - color)
            sigma = [-numpy.log(c) / volume["attenuationDistance"] for c in volume["attenuationColor"]]
            absorb.inputs["Density"].default_value = max(sigma)
            absorb.inputs["Color"].default_value = [1 - s / max(sigma) for s in sigma] + [1]
            links.new(absorb.outputs[0], out.inputs["Volume"])
    elif pbr.get("metallicFactor", 1) == 1:
        metal = nodes.new("ShaderNodeBsdfPrincipled")
        metal.distribution = "GGX"
        metal.inputs["Base Color"].default_value = color
        metal.inputs["Metallic"].default_value = 1
        metal.inputs["Roughness"].default_value = pbr.get("roughnessFactor", 1)
        links.new(metal.outputs[0], out.inputs["Surface"])
    else:
        diffuse = nodes.new("ShaderNodeBsdfDiffuse")
        diffuse.inputs["Color"].default_value = color
        links.new(diffuse.outputs[0], out.inputs["Surface"])


def picture(path):
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    values = numpy.empty(width * height * image.channels, dtype=numpy.float32)
    image.pixels.foreach_get(values)
    return values.reshape(height, width, image.channels).astype(float)


def shown(linear):
    c = numpy.clip(linear, 0, 1)
    return numpy.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


def blurred(image):
    """Gaussian window of 11 pixels, sigma 1.5 (Wang et al. 2004)."""
    taps = numpy.exp(-0.5 * (numpy.arange(-5, 6) / 1.5) ** 2)
    taps /= taps.sum()
    for axis in (0, 1):
        image = numpy.apply_along_axis(lambda line: numpy.convolve(line, taps, "valid"), axis, image)
    return image


def structural_similarity(a, b):
    values = []
    for c in range(3):
        x, y = a[:, :, c], b[:, :, c]
        mx, my = blurred(x), blurred(y)
        xx, yy, xy = blurred(x * x) - mx * mx, blurred(y * y) - my * my, blurred(x * y) - mx * my
        values.append(((2 * mx * my + 1e-4) * (2 * xy + 9e-4) / ((mx * mx + my * my + 1e-4) * (xx + yy + 9e-4))).mean())
    return float(numpy.mean(values))


bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=glb)
described = {m["name"]: m for m in gltf_json(glb)["materials"]}
for material in bpy.data.materials:
    shader(material, described[material.name])
ours_picture = picture(ours)[:, :, :3]
scene = bpy.context.scene
captured = [o for o in scene.objects if o.type == "MESH" and is_captured(described[o.active_material.name])]
for thing in scene.objects if captured else []:  # lamps that are meshes belong to what was captured, too
    if thing.type == "MESH" and (thing in captured or max(described[thing.active_material.name].get("emissiveFactor", [0])) > 0):
        thing.is_shadow_catcher = True
scene.render.film_transparent = bool(captured)
scene.camera = next(o for o in scene.objects if o.type == "CAMERA")
scene.render.engine = "CYCLES"
scene.render.resolution_x, scene.render.resolution_y = ours_picture.shape[1], ours_picture.shape[0]
scene.render.pixel_aspect_x = scene.render.pixel_aspect_y = 1
scene.render.filter_size = 0.01
cycles = scene.cycles
cycles.device, cycles.samples, cycles.use_denoising, cycles.seed = "CPU", int(samples), False, int(seed)
cycles.use_adaptive_sampling = False
cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
for kind in ("max", "diffuse", "glossy", "transmission", "transparent_max"):
    setattr(cycles, kind + "_bounces", int(depth))
cycles.volume_bounces = 0
cycles.caustics_reflective = cycles.caustics_refractive = True
cycles.blur_glossy = cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
scene.world = bpy.data.worlds.new("dark")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0, 0, 0, 1)
scene.view_settings.view_transform = "Raw"
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.image_settings.color_mode = "RGBA"
theirs = os.path.join(folder, "cycles.exr")
scene.render.filepath = theirs
wall, cpu = time.perf_counter(), time.process_time()
bpy.ops.render.render(write_still=True)
wall, cpu = time.perf_counter() - wall, time.process_time() - cpu

theirs_picture = picture(theirs)
if captured:  # one colour behind the picture
    behind = described[captured[0].active_material.name]["pbrMetallicRoughness"]["baseColorFactor"][:3]
    theirs_picture = theirs_picture[:, :, :3] + (1 - theirs_picture[:, :, 3:4]) * numpy.array(behind)
theirs_picture = theirs_picture[:, :, :3]
means = [(float(ours_picture[:, :, c].mean()), float(theirs_picture[:, :, c].mean())) for c in range(3)]
result = {
    "samples": int(samples),
    "cycles_seconds": wall,
    "cycles_cpu_seconds": cpu,
    "mean_ours": [m[0] for m in means],
    "mean_cycles": [m[1] for m in means],
    "mean_difference_percent": [100 * (m[0] - m[1]) / m[1] for m in means],
    "structural_similarity": structural_similarity(shown(ours_picture), shown(theirs_picture)),
}
with open(os.path.join(folder, "compared.json"), "w") as file:
    json.dump(result, file, indent=1)
side = numpy.concatenate([shown(ours_picture), shown(theirs_picture),
                          numpy.clip(0.5 + 5 * (shown(ours_picture) - shown(theirs_picture)), 0, 1)], axis=1)
image = bpy.data.images.new("compared", side.shape[1], side.shape[0])
image.pixels.foreach_set(numpy.concatenate([side, numpy.ones(side.shape[:2] + (1,))], axis=2).astype(numpy.float32).ravel())
image.filepath_raw, image.file_format = os.path.join(folder, "compared.png"), "PNG"
image.save()
print(json.dumps(result, indent=1))
sys.stdout.flush()
os._exit(0)  # bpy 4.2 as a module of Python crashes where the interpreter takes itself down
