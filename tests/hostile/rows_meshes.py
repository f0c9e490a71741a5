"""Meshes and robots: files that are damaged, and shapes that no body can have."""
import json
import struct

from fixtures import CUBE_POINTS, CUBE_TRIANGLES, cube_obj, cube_ply, cube_stl
from table import DONE, FAILED, WRONG_USE, append, cut, edit, make_folder, remove, rename, row, write

N = WRONG_USE
BODY, SEEN = "simulate shown.yaml -o s.h5 --duration 0.01", "render shown.yaml -o p.png"


def of_kind(ending, content):
    return write(f"thing.{ending}", content), edit("shown.yaml", "thing.obj", f"thing.{ending}", 2)


# ---- what is no mesh, by kind
for ending in ("obj", "stl", "ply", "dae", "gltf", "glb"):
    for name, content in (("empty", b""), ("noise", bytes((i * 37 + i // 256) % 256 for i in range(5000))), ("words", b"hello world\n" * 50)):
        row(f"a .{ending} of {name}", BODY, N, f"thing.{ending}", *of_kind(ending, content), needs="shown")
row("a mesh of a kind that is not read", BODY, N, "thing.fbx.*obj", *of_kind("fbx", "x"), needs="shown")
row("a mesh without an ending", BODY, N, "thing", rename("thing.obj", "thing"), edit("shown.yaml", "thing.obj", "thing", 2), needs="shown")
row("no mesh file", BODY, N, r"shown.yaml:\d+:.*thing.obj", remove("thing.obj"), needs="shown")
row("a folder instead of a mesh", BODY, N, r"thing.obj", remove("thing.obj"), make_folder("thing.obj"), needs="shown")
for ending, content in (("stl", cube_stl()), ("ply", cube_ply().encode()), ("obj", cube_obj().encode())):
    row(f"a .{ending} that is cut off", BODY, N, f"thing.{ending}", *of_kind(ending, content), cut(f"thing.{ending}", 0.6), needs="shown")
row("an STL that counts 4e9 triangles", BODY, N, "thing.stl", *of_kind("stl", cube_stl()[:80] + struct.pack("<I", 2**32 - 1) + cube_stl()[84:]),
    needs="shown")
row("a PLY that counts 4e9 vertices", BODY, N, "thing.ply", *of_kind("ply", cube_ply().replace("vertex 8", "vertex 4000000000")), needs="shown")
row("a PLY with a triangle of vertex 4e9", BODY, N, "thing.ply", *of_kind("ply", cube_ply().replace("3 0 2 1", "3 0 2 4000000000")), needs="shown")

# ---- what no body can be
for name, change, pattern in (
        ("a vertex that is no number", edit("thing.obj", "v -0.05", "v nan"), "thing.obj.*finite|thing.obj"),
        ("a vertex in infinity", edit("thing.obj", "v -0.05", "v inf"), "thing.obj"),
        ("a vertex at 1e30", edit("thing.obj", "v -0.05", "v 1e30"), "thing.obj.*away"),
        ("a vertex with two numbers", edit("thing.obj", "v -0.05 -0.05 -0.05", "v -0.05 -0.05"), "thing.obj"),
        ("a face of a vertex that is not there", edit("thing.obj", "f 1 3 2", "f 1 3 999"), "thing.obj"),
        ("a face of vertex 0", edit("thing.obj", "f 1 3 2", "f 0 3 2"), "thing.obj"),
        ("a face of vertex -99", edit("thing.obj", "f 1 3 2", "f -99 3 2"), "thing.obj"),
        ("a face of vertex 2^63", edit("thing.obj", "f 1 3 2", "f 9223372036854775808 3 2"), "thing.obj"),
        ("a face of two corners", edit("thing.obj", "f 1 3 2", "f 1 3"), "thing.obj"),
        ("a hole", edit("thing.obj", "f 1 3 2\n", ""), "thing.obj.*(closed|hole|open|boundary)"),
        ("a flipped triangle", edit("thing.obj", "f 1 3 2", "f 1 2 3"), "thing.obj.*(orient|flip|twice|same)"),
        ("a triangle twice", append("thing.obj", "f 1 3 2\n"), "thing.obj"),
        ("no triangle", write("thing.obj", "v 0 0 0\n"), "thing.obj"),
        ("all points in one", write("thing.obj", cube_obj(scale=0)), "thing.obj"),
        ("a flat cube", write("thing.obj", "\n".join(" ".join(l.split()[:3] + ["0"]) if l[0] == "v" else l for l in cube_obj().splitlines())), "thing.obj"),
        ("inside out", write("thing.obj", "\n".join(f"f {l.split()[1]} {l.split()[3]} {l.split()[2]}" if l[0] == "f" else l for l in cube_obj().splitlines())),
         "thing.obj.*(inside|inward|outward|volume)"),
        ("two parts that overlap", append("thing.obj", cube_obj(1, (0.05, 0, 0), 9)), "thing.obj.*(overlap|intersect|twice)"),
        ("a part inside another", append("thing.obj", cube_obj(0.5, (0, 0, 0), 9)), "thing.obj.*(inside|overlap|twice)")):
    row(f"a body's mesh: {name}", BODY, N, pattern, change, needs="shown")
row("a body's mesh: millimetres", BODY, DONE, "thing.obj.*173 m .*mm.*0.001", write("thing.obj", cube_obj(1000)), needs="shown",
    makes=["s.h5"])
row("a body's mesh of two parts that are apart", BODY, DONE, "s.h5", append("thing.obj", cube_obj(1, (0.5, 0, 0), 9)), needs="shown",
    makes=["s.h5"])


# ---- glTF
def gltf(change=lambda g: None, raw=None):
    points = b"".join(struct.pack("<3f", *p) for p in CUBE_POINTS)
    triangles = b"".join(struct.pack("<3H", *t) for t in CUBE_TRIANGLES)
    content = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
               "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
               "buffers": [{"uri": "thing.bin", "byteLength": len(points + triangles)}],
               "bufferViews": [{"buffer": 0, "byteLength": len(points)},
                               {"buffer": 0, "byteOffset": len(points), "byteLength": len(triangles)}],
               "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [-0.05] * 3, "max": [0.05] * 3},
                             {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]}
    change(content)
    return write("thing.bin", points + triangles), write("thing.gltf", raw or json.dumps(content))


def at(path, value):
    def change(content):
        place = content
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = value

    return change


LOOK = "render thing.gltf -o p.png --width 16 --height 16 --samples 1"
SPOILT = [(f"a scale of {s}", at(["nodes", 0, "scale"], [s] * 3)) for s in (1e38, 1e300)]
SPOILT += [("a translation of 1e38", at(["nodes", 0, "translation"], [1e38, 0, 0])), ("a rotation of zero", at(["nodes", 0, "rotation"], [0, 0, 0, 0])),
           ("a matrix of zeros", at(["nodes", 0, "matrix"], [0] * 16)), ("a matrix of 3 numbers", at(["nodes", 0, "matrix"], [1, 2, 3])),
           ("a node that holds itself", at(["nodes", 0, "children"], [0])), ("a child that is not there", at(["nodes", 0, "children"], [99])),
           ("a child -5", at(["nodes", 0, "children"], [-5])), ("a mesh that is not there", at(["nodes", 0, "mesh"], 9)),
           ("a scene that is not there", at(["scene"], 9)), ("a root that is not there", at(["scenes", 0, "nodes"], [7])),
           ("points that are not there", at(["meshes", 0, "primitives", 0, "attributes", "POSITION"], 77)),
           ("indices that are not there", at(["meshes", 0, "primitives", 0, "indices"], 77)),
           ("a material that is not there", at(["meshes", 0, "primitives", 0, "material"], 7)),
           ("a count beyond the buffer", at(["accessors", 0, "count"], 4000000000)), ("a negative count", at(["accessors", 0, "count"], -8)),
           ("an offset beyond the buffer", at(["bufferViews", 1, "byteOffset"], 10**12)), ("a view beyond the buffer", at(["bufferViews", 0, "byteLength"], 10**9)),
           ("a buffer longer than its file", at(["buffers", 0, "byteLength"], 10**9)), ("a buffer that is not there", at(["buffers", 0, "uri"], "none.bin")),
           ("a buffer outside of the folder", at(["buffers", 0, "uri"], "../../../../../etc/passwd")),
           ("data that are no base64", at(["buffers", 0, "uri"], "data:application/octet-stream;base64,@@@")),
           ("an unknown component type", at(["accessors", 0, "componentType"], 1)), ("points that are VEC2", at(["accessors", 0, "type"], "VEC2")),
           ("a stride of 1", at(["bufferViews", 0, "byteStride"], 1)), ("version 1", at(["asset", "version"], "1.0")),
           ("an extension that must be known", at(["extensionsRequired"], ["KHR_draco_mesh_compression"])),
           ("points only", at(["meshes", 0, "primitives", 0, "mode"], 0)), ("no mesh", at(["nodes", 0], {}))]
for name, change in SPOILT:
    row(f"glTF with {name}", LOOK, N, r"thing\.(gltf|bin)", *gltf(change))
for scale in (0, 1e-300):  # nothing is left to be seen of it, which is allowed
    row(f"glTF with a scale of {scale}", LOOK, DONE, "p.png|pictures", *gltf(at(["nodes", 0, "scale"], [scale] * 3)), makes=["p.png"])
row("glTF with braces a hundred thousand deep", LOOK, N, "thing.gltf", *gltf(raw='{"a":' * 100000))
row("glTF that is cut off", LOOK, N, "thing.gltf", *gltf(), cut("thing.gltf", 0.5))
row("glTF with indices beyond the points", LOOK, N, "thing.gltf", *gltf(), write("thing.bin", bytes(96) + b"\xff" * 72))
row("glTF with points that are no numbers", LOOK, N, "thing.gltf", *gltf(), write("thing.bin", b"\xff" * 96 + bytes(72)))
for name, content in (("a header alone", struct.pack("<4sII", b"glTF", 2, 12)), ("a length of 4e9", struct.pack("<4sIIII", b"glTF", 2, 2**32 - 1, 2**32 - 1, 0x4E4F534A)),
                      ("a chunk of 4e9", struct.pack("<4sIIII", b"glTF", 2, 24, 2**32 - 1, 0x4E4F534A) + b"{}  ")):
    row(f"a .glb with {name}", "render in.glb -o p.png", N, "in.glb", write("in.glb", content))

# ---- robots
TASK = "generate task.yaml -o o --no-render"
for name, change, pattern in (
        ("empty", write("arm.urdf"), "arm.urdf"), ("words", write("arm.urdf", "hello"), "arm.urdf"), ("cut off", cut("arm.urdf", 0.5), "arm.urdf"),
        ("no robot", write("arm.urdf", "<sofa/>"), "arm.urdf"), ("an XML bomb", write("arm.urdf", '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa">' + "".join(
            f'<!ENTITY {chr(98 + i)} "{f"&{chr(97 + i)};" * 10}">' for i in range(9)) + ']><robot name="&j;"/>'), "arm.urdf"),
        ("a file of the system", write("arm.urdf", '<!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/passwd">]><robot name="&e;"/>'), "arm.urdf"),
        ("brackets a hundred thousand deep", write("arm.urdf", "<a>" * 100000), "arm.urdf"),
        ("a joint without limits", edit("arm.urdf", "<limit ", "<unlimited "), "arm.urdf.*fr3_joint1.*limit"),
        ("a mesh that is not there", edit("arm.urdf", "link7.obj", "none.obj"), "none.obj"),
        ("a mesh by http", edit("arm.urdf", 'mesh filename="', 'mesh filename="http://example.com/'), "arm.urdf|http"),
        ("a mass that is no number", edit("arm.urdf", 'mass value="2', 'mass value="x'), "arm.urdf"),
        ("a mass of NaN", edit("arm.urdf", 'mass value="2.3966"', 'mass value="nan"'), "arm.urdf"),
        ("a mass of 1e999", edit("arm.urdf", 'mass value="2.9274653454"', 'mass value="1e999"'), "arm.urdf"),
        ("a negative mass", edit("arm.urdf", 'mass value="2.9274653454"', 'mass value="-1"'), "arm.urdf.*mass"),
        ("no inertia", edit("arm.urdf", 'ixx="0.0239', 'ixx="-0.0239'), "arm.urdf"), ("a link twice", edit("arm.urdf", 'link name="fr3_link3"', 'link name="fr3_link2"'), "arm.urdf"),
        ("a joint of a link that is not there", edit("arm.urdf", 'child link="fr3_link3"', 'child link="moon"'), "arm.urdf"),
        ("a loop", edit("arm.urdf", 'child link="fr3_link3"', 'child link="fr3_link1"'), "arm.urdf"),
        ("an axis of zero", edit("arm.urdf", '<axis xyz="0 0 1"', '<axis xyz="0 0 0"'), "arm.urdf.*axis|axis"),
        ("a joint of an unknown type", edit("arm.urdf", 'type="revolute"', 'type="rubber"'), "arm.urdf"),
        ("a link that is called ../evil", edit("arm.urdf", "fr3_link3", "../evil", 99), "arm.urdf.*name"),
        ("an origin of two numbers", edit("arm.urdf", 'origin xyz="-0.0172 0.0004 0.0745"', 'origin xyz="-0.0172 0.0004"'), "arm.urdf")):
    row(f"a robot: {name}", TASK, N, pattern, change, needs="robot")
