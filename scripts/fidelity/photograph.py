"""A real camera's view of a simulated grasp: drawn by Cycles, then bent by a lens, blurred, and noisy.

Needs bpy, h5py and opencv-python-headless. Nothing of our renderer is used: the surfaces come from the states file.
"""
import math

import bpy
import cv2
import h5py
import numpy as np

MARGIN = 1.3  # the pinhole picture is wider than the camera's by this factor, for the lens to bend in


def text_of(value):
    return value.decode() if isinstance(value, bytes) else str(value)


class Motion:
    """What a states file tells over time."""

    def __init__(self, path):
        self.file = h5py.File(path)
        self.time = self.file["time"][:]
        self.rows = {text_of(n): row for row, n in enumerate(self.file["T_rigid"].attrs["names"])}

    def pose(self, name, step):
        """[3, 4] of a rigid body"""
        return self.file["T_rigid"][step, self.rows[name]]

    def fingers(self, step):
        """points [V, 3, m]"""
        return self.file["X_gripper/fingers"][step]

    def triangles(self):
        """of the fingers, [n, 3]"""
        return self.file["mesh/fingers/triangles"][:]


def mesh_object(name, points, triangles, material):
    mesh = bpy.data.meshes.new(name)
    used = np.unique(triangles)
    new = np.zeros(len(points), int)
    new[used] = np.arange(len(used))
    mesh.from_pydata(points[used].tolist(), [], new[triangles].tolist())
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def material(name, kind, **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    shader, out = nodes.new(kind), nodes.new("ShaderNodeOutputMaterial")
    for key, value in inputs.items():
        shader.inputs[key.replace("_", " ")].default_value = value
    links.new(shader.outputs[0], out.inputs["Surface"])
    return made


class Photographer:
    """camera: width, height, field [degrees, vertical], position, target, up; lens: k1, blur [pixels], noise."""

    def __init__(self, camera, lens, samples, random):
        self.camera, self.lens, self.samples, self.random = camera, lens, samples, random
        self.focal = camera["height"] / 2 / math.tan(math.radians(camera["field"]) / 2)
        self.wide = [2 * round(MARGIN * camera[side] / 2) for side in ("width", "height")]

    def draw(self, surfaces, is_coverage):
        """surfaces: name -> (points, triangles). Linear picture [H, W, 3] of the wide pinhole camera. is_coverage: fingers
        shine, all else is black, and glass is left out, as who outlines a gripper looks through it."""
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = bpy.context.scene
        glass = material("glass", "ShaderNodeBsdfGlass", IOR=1.47, Roughness=0.0)
        black = material("black", "ShaderNodeBsdfDiffuse", Color=(0, 0, 0, 1))
        if is_coverage:
            looks = {"fingers": material("white", "ShaderNodeEmission", Color=(1, 1, 1, 1)), "table": black}
        else:
            looks = {"fingers": material("tpu", "ShaderNodeBsdfPrincipled", Base_Color=(0.025, 0.12, 0.44, 1), Roughness=0.45),
                     "table": material("wood", "ShaderNodeBsdfDiffuse", Color=(0.45, 0.36, 0.27, 1))}
        for name, (points, triangles) in surfaces.items():
            if name in looks or not is_coverage:
                mesh_object(name, points, triangles, looks.get(name, glass))
        square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
        mesh_object("table", square, np.array([[0, 1, 2], [0, 2, 3]]), looks["table"])
        scene.world = bpy.data.worlds.new("room")
        scene.world.use_nodes = True
        scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0,) * 3 + (1,) if is_coverage else (0.5, 0.55, 0.6, 1)
        if not is_coverage:
            lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "AREA"))
            lamp.data.size, lamp.data.energy, lamp.location = 0.5, 12, (0.4, -0.5, 0.9)
            lamp.rotation_euler = (0.6, 0.45, 0)
            scene.collection.objects.link(lamp)
        seen = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        scene.collection.objects.link(seen)
        scene.camera = seen
        seen.matrix_world = self.pose()
        seen.data.sensor_fit = "VERTICAL"
        seen.data.angle = 2 * math.atan(self.wide[1] / 2 / self.focal)
        seen.data.clip_start = 0.001
        scene.render.engine = "CYCLES"
        scene.render.resolution_x, scene.render.resolution_y = self.wide
        scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", self.samples, False
        scene.cycles.use_adaptive_sampling = False
        scene.cycles.max_bounces = scene.cycles.transmission_bounces = 12
        scene.view_settings.view_transform = "Raw"
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.render.image_settings.color_depth = "32"
        scene.render.filepath = bpy.app.tempdir + "drawn.exr"
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        image.colorspace_settings.name = "Non-Color"
        values = np.empty(self.wide[0] * self.wide[1] * image.channels, np.float32)
        image.pixels.foreach_get(values)
        return values.reshape(self.wide[1], self.wide[0], image.channels)[::-1, :, :3]

    def pose(self):
        from mathutils import Matrix
        at, to, up = (np.array(self.camera[k], float) for k in ("position", "target", "up"))
        back = (at - to) / np.linalg.norm(at - to)
        right = np.cross(up, back) / np.linalg.norm(np.cross(up, back))
        pose = np.eye(4)
        pose[:3] = np.stack([right, np.cross(back, right), back, at], 1)
        return Matrix(pose.tolist())

    def matrix(self, width, height):
        return np.array([[self.focal, 0, (width - 1) / 2], [0, self.focal, (height - 1) / 2], [0, 0, 1]])

    def through_lens(self, picture):
        """The camera's picture, bent by the lens, blurred, with noise."""
        width, height = self.camera["width"], self.camera["height"]
        grid = np.stack(np.meshgrid(np.arange(width), np.arange(height)), -1).reshape(-1, 1, 2).astype(np.float64)
        straight = cv2.undistortPoints(grid, self.matrix(width, height), np.array([self.lens["k1"], 0, 0, 0]),
                                       P=self.matrix(*self.wide)).reshape(height, width, 2).astype(np.float32)
        bent = cv2.remap(np.ascontiguousarray(picture), straight[..., 0], straight[..., 1], cv2.INTER_LINEAR)
        bent = cv2.GaussianBlur(bent, (0, 0), self.lens["blur"])
        return bent + self.random.normal(0, 1, bent.shape) * self.lens["noise"] * np.sqrt(np.maximum(bent, 0) + 0.05)


def shown(linear):
    c = np.clip(linear, 0, 1)
    return np.uint8(255 * np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055) + 0.5)
