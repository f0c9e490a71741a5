"""Photographs of things on the table of a captured room, as Cycles makes them of a real photograph.

The room's own light is an environment map: what the captured surface looks like from where the things stand, its holes
filled from their borders. What changes is drawn, the rest stays the photograph (Debevec 1998): beside the things each
pixel is the photograph times the ratio of the table with and without them, on them it is Cycles' picture, in which the
room looks as in the photograph where that shows it. Needs bpy and opencv-python-headless; nothing of our renderer.
"""
import math

import bpy
import cv2
import numpy as np
from mathutils import Matrix

LOCAL = 0.7        # the table within this distance takes shadows [m]
ALBEDO = 0.5       # of the table, for light that goes between it and the things
SEEN_WITHIN = 0.03  # of the depth that the photograph's camera sees [m]


def linear(srgb):
    c = np.float32(srgb) / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def coded(values):
    c = np.clip(values, 0, 1)
    return np.uint8(255 * np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055) + 0.5)


def read_linear(path):
    return linear(cv2.imread(str(path))[..., ::-1])


def write_coded(path, values):
    cv2.imwrite(str(path), coded(values)[..., ::-1])


def read_exr(path):
    """[H, W, 3 or 4] red first"""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name, image.alpha_mode = "Non-Color", "CHANNEL_PACKED"
    width, height = image.size
    values = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    return values.reshape(height, width, -1)[::-1]


def rotation(q):
    x, y, z, w = np.array(q) / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def project(camera, points):
    """pixels [n, 2] and depths [n]; the middle of the first pixel is 0"""
    fx, fy, cx, cy = camera["intrinsics"]
    p = (points - np.array(camera["position"])) @ rotation(camera["quaternion"])
    z = np.where(np.abs(p[:, 2]) > 1e-6, p[:, 2], 1e-6)
    return np.stack([fx * p[:, 0] / z + cx, fy * p[:, 1] / z + cy], 1), p[:, 2]


def filled(picture, is_known):
    """holes from their borders, by means over ever larger surroundings; the picture goes around"""
    out, left = picture * is_known[..., None], ~is_known
    width = picture.shape[1]
    for sigma in (2, 4, 8, 16, 32, 64, 128):
        wide = [np.tile(np.float32(a), (1, 3) + (1,) * (a.ndim - 2)) for a in (picture * is_known[..., None], is_known)]
        mean, share = (cv2.GaussianBlur(a, (0, 0), sigma)[:, width:2 * width] for a in wide)
        take = left & (share > 1e-3)
        out[take] = mean[take] / share[take][:, None]
        left &= ~take
    return out


def fresh(samples, denoise):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device = "CYCLES", "CPU"
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = samples, denoise, False
    scene.cycles.max_bounces = scene.cycles.transmission_bounces = 12
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.image_settings.color_mode, scene.render.film_transparent = "RGBA", True
    return scene


def render(scene, path):
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    picture = read_exr(path)
    return picture[..., :3], picture[..., 3]


def material(name, kind=None, **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.node_tree.nodes.clear()
    out = made.node_tree.nodes.new("ShaderNodeOutputMaterial")
    if kind:
        shader = made.node_tree.nodes.new(kind)
        for key, value in inputs.items():
            shader.inputs[key.replace("_", " ")].default_value = value
        made.node_tree.links.new(shader.outputs[0], out.inputs["Surface"])
    return made, made.node_tree.nodes, made.node_tree.links, out


def add_mesh(name, points, triangles, look, is_smooth=False):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], triangles.tolist())
    if is_smooth:
        mesh.shade_smooth()
        mesh.set_sharp_from_angle(angle=0.7)
    mesh.materials.append(look)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def add_camera(scene, camera):
    width, height = camera["size"]
    fx, _, cx, cy = camera["intrinsics"]
    seen = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation(camera["quaternion"]) @ np.diag([1, -1, -1]), camera["position"]
    seen.matrix_world = Matrix(pose.tolist())
    seen.data.sensor_fit, seen.data.sensor_width, seen.data.lens = "HORIZONTAL", 36, 36 * fx / width
    seen.data.shift_x, seen.data.shift_y = (width / 2 - cx - 0.5) / width, (cy + 0.5 - height / 2) / width
    seen.data.clip_start = 0.01
    scene.collection.objects.link(seen)
    scene.camera, (scene.render.resolution_x, scene.render.resolution_y) = seen, (width, height)


def add_world(scene, path):
    scene.world = bpy.data.worlds.new("room")
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    map_ = tree.nodes.new("ShaderNodeTexEnvironment")
    map_.image = bpy.data.images.load(str(path))
    map_.image.colorspace_settings.name = "Non-Color"
    tree.links.new(map_.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def emitting(photo=None):
    """The room as it looks: the colours of its points, or the photograph where the attribute `seen` is 1."""
    made, nodes, links, out = material("room")
    shine, color = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeAttribute")
    color.attribute_name = "look"
    last = color.outputs["Color"]
    if photo is not None:
        picture, seen, mix = (nodes.new("ShaderNode" + n) for n in ("TexImage", "Attribute", "MixRGB"))
        picture.image, picture.extension, seen.attribute_name = photo, "EXTEND", "seen"
        links.new(seen.outputs["Fac"], mix.inputs[0])
        links.new(last, mix.inputs[1])
        links.new(picture.outputs["Color"], mix.inputs[2])
        last = mix.outputs[0]
    links.new(last, shine.inputs["Color"])
    links.new(shine.outputs[0], out.inputs["Surface"])
    made.cycles.emission_sampling = "NONE"
    return made


def add_room(room, look, gain, uvs=None, seen=None):
    thing = add_mesh("room", room.points, room.triangles, look)
    values = np.ones((len(room.points), 4), np.float32)
    values[:, :3] = room.colors * gain
    thing.data.attributes.new("look", "FLOAT_COLOR", "POINT").data.foreach_set("color", values.ravel())
    if uvs is not None:
        thing.data.attributes.new("seen", "FLOAT", "POINT").data.foreach_set("value", np.float32(seen))
        layer = thing.data.uv_layers.new(name="photo")
        layer.data.foreach_set("uv", np.float32(uvs[room.triangles.ravel()]).ravel())
    return thing


class RoomPhotographer:
    """room: points, triangles, colors; things: [(points, triangles, look)], look: function that makes a material."""

    def __init__(self, room, things, center, folder, samples):
        self.room, self.things, self.center, self.folder, self.samples = room, things, np.array(center), folder, samples
        self.light = folder / "light.hdr"

    def make_light(self, width=512):
        scene = fresh(8, False)
        add_room(self.room, emitting(), 1)
        seen = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        seen.data.type, seen.data.panorama_type = "PANO", "EQUIRECTANGULAR"
        seen.location, seen.rotation_euler = self.center + [0, 0, 0.05], (math.pi / 2, 0, -math.pi / 2)
        scene.collection.objects.link(seen)
        scene.camera, scene.render.resolution_x, scene.render.resolution_y = seen, width, width // 2
        color, alpha = render(scene, self.folder / "seen.exr")
        light = filled(color / np.maximum(alpha, 1e-6)[..., None], alpha > 0.5)
        cv2.imwrite(str(self.light), np.float32(light[..., ::-1]))
        return float((alpha > 0.5).mean())

    def window(self, camera):
        """pixels (left, top, right, bottom) around the things, with half their size as a margin"""
        at = np.concatenate([project(camera, points)[0] for points, _, _ in self.things])
        low, high = at.min(0), at.max(0)
        margin = 0.5 * (high - low)
        size = np.array(camera["size"])
        return np.concatenate([np.clip(low - margin, 0, size), np.clip(high + margin, 0, size)]).astype(int)

    def draw(self, camera, name, samples, has_things, look_of_room, denoise=True):
        scene = fresh(samples, denoise)
        add_camera(scene, camera)
        add_world(scene, self.light)
        look_of_room()
        for points, triangles, look in self.things if has_things else []:
            add_mesh("thing", points, triangles, look(), True)
        left, top, right, bottom = self.window(camera)
        width, height = camera["size"]
        scene.render.use_border = True
        scene.render.border_min_x, scene.render.border_max_x = left / width, right / width
        scene.render.border_min_y, scene.render.border_max_y = 1 - bottom / height, 1 - top / height
        return render(scene, self.folder / (name + ".exr"))

    def gain_and_depth(self, camera, photo):
        """What the photograph's exposure makes of the captured colours, and the depth of the room in it."""
        pixels, depth = project(camera, self.room.points)
        width, height = camera["size"]
        at = np.rint(pixels).astype(int)
        inside = (depth > 0.1) & (at >= 0).all(1) & (at < [width, height]).all(1)
        nearest = np.full((height, width), np.inf)
        for dx in (-2, -1, 0, 1, 2):
            for dy in (-2, -1, 0, 1, 2):
                x, y = np.clip(at[inside, 0] + dx, 0, width - 1), np.clip(at[inside, 1] + dy, 0, height - 1)
                np.minimum.at(nearest, (y, x), depth[inside])
        seen = inside.copy()
        seen[inside] = depth[inside] < nearest[at[inside, 1], at[inside, 0]] + SEEN_WITHIN * (1 + depth[inside])
        shown, captured = photo[at[seen, 1], at[seen, 0]], self.room.colors[seen]
        usable = (shown.min(1) > 0.01) & (shown.max(1) < 0.9) & (captured.min(1) > 0.01)
        return np.median(shown[usable] / captured[usable], 0), pixels, seen

    def photograph(self, camera, photo, name):
        """The photograph with the things in it, linear; and the share of each pixel that they cover."""
        width, height = camera["size"]
        gain, pixels, seen = self.gain_and_depth(camera, photo)
        local = np.linalg.norm(self.room.points[:, :2] - self.center[:2], axis=1) < LOCAL
        near = self.room.triangles[local[self.room.triangles].all(1)]

        def table():
            add_mesh("table", self.room.points, near, material("table", "ShaderNodeBsdfDiffuse", Color=(ALBEDO,) * 3 + (1,))[0])

        def room():
            rgba = np.ones((height, width, 4), np.float32)
            rgba[..., :3] = photo[::-1]
            image = bpy.data.images.new("photo", width, height, float_buffer=True)
            image.colorspace_settings.name = "Non-Color"
            image.pixels.foreach_set(rgba.ravel())
            uvs = (pixels + 0.5) / [width, height]
            uvs[:, 1] = 1 - uvs[:, 1]
            add_room(self.room, emitting(photo=image), gain, uvs, seen)
            scene = bpy.context.scene  # what the mesh leaves open shines with the same exposure
            scale = scene.world.node_tree.nodes.new("ShaderNodeVectorMath")
            scale.operation, scale.inputs[1].default_value = "MULTIPLY", gain
            links, background = scene.world.node_tree.links, scene.world.node_tree.nodes["Background"]
            links.new(scene.world.node_tree.nodes["Environment Texture"].outputs["Color"], scale.inputs[0])
            links.new(scale.outputs[0], background.inputs["Color"])

        def holdout():
            add_mesh("room", self.room.points, self.room.triangles, material("room", "ShaderNodeHoldout")[0])

        empty, _ = self.draw(camera, name + "_empty", self.samples, False, table)
        stood, _ = self.draw(camera, name + "_stood", self.samples, True, table)
        seen_things, _ = self.draw(camera, name + "_things", self.samples, True, room)
        things = self.things
        self.things = [(p, t, lambda: material("plain", "ShaderNodeEmission")[0]) for p, t, _ in things]
        _, covered = self.draw(camera, name + "_covered", 16, True, holdout, False)
        self.things = things
        ratio = np.where(empty > 1e-4, stood / np.maximum(empty, 1e-4), 1)
        left, top, right, bottom = self.window(camera)
        out = photo.copy()
        inside = (slice(top, bottom), slice(left, right))
        share = covered[inside][..., None]
        out[inside] = photo[inside] * ratio[inside] * (1 - share) + seen_things[inside] * share
        return out, covered
