#!/usr/bin/env python3
"""Writes seeds/mesh_<format>/, seeds/splats/ and seeds/colmap/: one tetrahedron in every mesh format, in text and in
binary, with what the format has beside (normals, texture coordinates, groups, nodes); its corners as splats; one camera
with one image. The other seeds and files/ are written by hand."""
import base64
import json
import pathlib
import struct

SEEDS = pathlib.Path(__file__).parent / "seeds"
POINTS = [(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def write(name, content):
    path = SEEDS / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())


def splats():
    names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
             "rot_0", "rot_1", "rot_2", "rot_3"]
    header = ("ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(POINTS) +
              "".join("property float %s\n" % name for name in names) + "end_header\n")
    body = b"".join(struct.pack("<14f", *p, 0.1, 0.2, 0.3, 2, -3, -3, -4, 1, 0, 0, 0) for p in POINTS)
    write("splats/four.ply", header.encode() + body)


def colmap():
    cameras = struct.pack("<QIiQQ4d", 1, 1, 1, 64, 48, 50, 50, 32, 24)
    images = struct.pack("<QI4d3dI", 1, 1, 1, 0, 0, 0, 0, 0, 1, 1) + b"a.png\0" + struct.pack("<QddQ", 1, 3, 4, 5)
    write("colmap/one.bin", bytes([len(cameras)]) + cameras + images)


def obj():
    vertices = "".join("v %g %g %g\n" % p for p in POINTS)
    faces = "".join("f %d %d %d\n" % tuple(i + 1 for i in f) for f in FACES)
    write("mesh_obj/plain.obj", vertices + faces)
    corners = "".join("f %s\n" % " ".join("%d/%d/%d" % (i + 1, i + 1, 1) for i in f) for f in FACES)
    write("mesh_obj/full.obj", "mtllib a.mtl\no part\ng one two\ns 1\nusemtl red\n" + vertices +
          "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nvn 0 0 1\n" + corners + "p 1\nl 1 2 3\nf -1 -2 -3 -4\n")


def ply():
    header = ("ply\nformat %s 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
              "element face 4\nproperty list uchar int vertex_indices\nend_header\n")
    text = "".join("%g %g %g\n" % p for p in POINTS) + "".join("3 %d %d %d\n" % f for f in FACES)
    write("mesh_ply/text.ply", header % "ascii" + text)
    for order, name in (("<", "binary_little_endian"), (">", "binary_big_endian")):
        body = b"".join(struct.pack(order + "3f", *p) for p in POINTS)
        body += b"".join(struct.pack(order + "B3i", 3, *f) for f in FACES)
        write("mesh_ply/%s.ply" % name, (header % name).encode() + body)


def stl():
    text = "solid t\n"
    body = b"\0" * 80 + struct.pack("<I", len(FACES))
    for face in FACES:
        text += "facet normal 0 0 0\nouter loop\n"
        body += struct.pack("<3f", 0, 0, 0)
        for i in face:
            text += "vertex %g %g %g\n" % POINTS[i]
            body += struct.pack("<3f", *POINTS[i])
        text += "endloop\nendfacet\n"
        body += struct.pack("<H", 0)
    write("mesh_stl/text.stl", text + "endsolid t\n")
    write("mesh_stl/binary.stl", body)


def dae():
    numbers = " ".join("%g %g %g" % p for p in POINTS)
    corners = " ".join("%d %d %d" % f for f in FACES)
    write("mesh_dae/plain.dae", f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit name="m" meter="1"/>
<up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="a" count="12">{numbers}</float_array><technique_common><accessor source="#a" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>{corners}</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1
</matrix><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene>
<instance_visual_scene url="#s"/></scene></COLLADA>
""")


def gltf():
    buffer = b"".join(struct.pack("<3f", *p) for p in POINTS) + b"".join(struct.pack("<3H", *f) for f in FACES)
    model = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1], "rotation": [0, 0, 0, 1]}, {"mesh": 0, "scale": [2, 2, 2]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0],
                       "max": [1, 2, 3]}, {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]}
    inside = dict(model, buffers=[{"byteLength": len(buffer)}])
    text = json.dumps(inside).encode()
    text += b" " * (-len(text) % 4)
    write("mesh_glb/plain.glb", struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(buffer)) +
          struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(buffer), b"BIN\0") + buffer)
    uri = "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()
    write("mesh_gltf/plain.gltf", json.dumps(dict(model, buffers=[{"byteLength": len(buffer), "uri": uri}])))


for make in (obj, ply, splats, colmap, stl, dae, gltf):
    make()
