"""Small valid inputs that rows copy and spoil. Each is a folder or a file; sets and states are made once by the program
itself."""
import json
import pathlib
import shutil
import struct
import subprocess
import zlib

from table import DATA, REPOSITORY

SCENE = """schema: 1
name: box
time_step: 10 ms
duration: 20 ms
bodies:
  - {name: ground, kind: half_space}
  - {name: box, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, density: 1000, pose: {position: [0, 0, 0.2]}}
"""

# seen, with files of its own
SHOWN = """schema: 1
name: shown
time_step: 10 ms
objects:
  - {name: thing, mesh: thing.obj, visuals: [{mesh: thing.obj, material: grey}], density: 1000, pose: {x: 0, y: 0, z: 0.2}}
materials:
  - {name: grey, kind: diffuse, color: [0.5, 0.5, 0.5]}
environment: [0.6, 0.6, 0.6]
cameras:
  - {name: front, width: 16, height: 16, vertical_field_of_view: 40 deg, position: [1, 0, 0.3], look_at: [0, 0, 0.2], up: [0, 0, 1]}
render: {frames_per_second: 10, samples: 1, max_depth: 2}
"""

# a cube of 0.1 m, closed, outward
CUBE_POINTS = [(x, y, z) for z in (-0.05, 0.05) for y in (-0.05, 0.05) for x in (-0.05, 0.05)]
CUBE_TRIANGLES = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2),
                  (2, 4, 6), (1, 3, 5), (3, 7, 5)]


def cube_obj(scale=1.0, offset=(0, 0, 0), first=1):
    lines = ["v " + " ".join(repr(scale * p + o) for p, o in zip(point, offset)) for point in CUBE_POINTS]
    lines += ["f " + " ".join(str(first + i) for i in triangle) for triangle in CUBE_TRIANGLES]
    return "\n".join(lines) + "\n"


def cube_stl():
    out = b"binary cube".ljust(80, b" ") + struct.pack("<I", len(CUBE_TRIANGLES))
    for triangle in CUBE_TRIANGLES:
        out += struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *CUBE_POINTS[i]) for i in triangle) + b"\0\0"
    return out


def cube_ply():
    lines = ["ply", "format ascii 1.0", f"element vertex {len(CUBE_POINTS)}", "property float x", "property float y",
             "property float z", f"element face {len(CUBE_TRIANGLES)}", "property list uchar int vertex_indices",
             "end_header"]
    lines += [" ".join(map(str, p)) for p in CUBE_POINTS] + ["3 " + " ".join(map(str, t)) for t in CUBE_TRIANGLES]
    return "\n".join(lines) + "\n"


def png(width, height, color):
    """A picture of one colour, or with `color` a function of (x, y)."""
    pixel = color if callable(color) else lambda x, y: color
    rows = b"".join(b"\0" + b"".join(bytes(pixel(x, y)) for x in range(width)) for y in range(height))

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def depth_png(width, height, depth=1000):
    """A 16-bit picture of depths, in millimetres."""
    row = b"\0" + struct.pack(f">{width}H", *[depth] * width)

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(row * height)) +
            chunk(b"IEND", b""))


def captures():
    """A wall 1 m in front of a camera of 64 x 48 pixels, seen from two places, in the four layouts that are read."""
    depth, photo = depth_png(64, 48), png(64, 48, (90, 120, 60))
    pose = [f"1 0 0 {x}\n0 1 0 0\n0 0 1 0\n0 0 0 1\n" for x in (0, 0.02)]
    files = {"seven/camera-intrinsics.txt": "60 0 31.5\n0 60 23.5\n0 0 1\n", "tum/camera.txt": "60 60 31.5 23.5\n",
             "tum/depth.txt": "1 depth/0.png\n2 depth/1.png\n", "tum/rgb.txt": "1 rgb/0.png\n2 rgb/1.png\n",
             "tum/groundtruth.txt": "1 0 0 0 0 0 0 1\n2 0.02 0 0 0 0 0 1\n",
             "colmap/sparse/0/cameras.txt": "1 PINHOLE 64 48 60 60 32 24\n",
             "colmap/sparse/0/images.txt": "1 1 0 0 0 0 0 0 1 0.png\n\n2 1 0 0 0 -0.02 0 0 1 1.png\n\n"}
    frames = []
    for i in range(2):
        files |= {f"seven/frame-00000{i}.depth.png": depth, f"seven/frame-00000{i}.color.png": photo,
                  f"seven/frame-00000{i}.pose.txt": pose[i], f"tum/depth/{i}.png": depth, f"tum/rgb/{i}.png": photo,
                  f"nerf/depth/{i}.png": depth, f"nerf/images/{i}.png": photo, f"colmap/depth/{i}.png": depth,
                  f"colmap/images/{i}.png": photo}
        frames.append({"file_path": f"images/{i}.png", "depth_file_path": f"depth/{i}.png",
                       "transform_matrix": [[1, 0, 0, 0.02 * i], [0, -1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]})
    files["nerf/transforms.json"] = json.dumps({"w": 64, "h": 48, "fl_x": 60, "fl_y": 60, "cx": 32, "cy": 24,
                                                "frames": frames}, indent=1)
    return files


def compared():
    """Two folders with pictures and masks of the same names."""
    files = {}
    for i in range(3):
        for k, name in ((1, "real"), (2, "sim")):
            files[f"{name}/{i}.png"] = png(32, 24, lambda x, y, k=k: (8 * x // k, 10 * y // k, 60))
            files[f"{name}/masks/{i}.png"] = png(32, 24, lambda x, y, k=k: (255,) * 3 if 8 < x < 20 + k else (0,) * 3)
    return files


def text_fixture(files):
    def make(folder, program):
        for name, content in files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content if isinstance(content, bytes) else content.encode())

    return make


def task(folder, program):
    """task.yaml with its gripper and finger; robots and objects stay in data/."""
    small = REPOSITORY / "tests/pipeline/small_task"
    for file in small.iterdir():
        target = folder / ("task.yaml" if file.name == "push_beaker.yaml" else file.name)
        if file.suffix == ".yaml":
            target.write_text(file.read_text().replace("../../../data", str(DATA)))
        else:
            shutil.copy(file, target)


def robot(folder, program):
    """The task with a copy of the URDF of its arm, so that a row can spoil it."""
    task(folder, program)
    source = DATA / "robots/fr3"
    text = (source / "fr3.urdf").read_text().replace('filename="', f'filename="{source}/')
    (folder / "arm.urdf").write_text(text)
    file = folder / "task.yaml"
    file.write_text(file.read_text().replace(str(source / "fr3.urdf"), "arm.urdf"))


def run(program, *arguments, cwd):
    subprocess.run([program, *map(str, arguments)], cwd=cwd, check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)


def episode_set(name, *options):
    def make(folder, program):
        task(folder, program)
        run(program, "generate", "task.yaml", "-n", 2, "--seed", 3, "-o", name, *options, cwd=folder)
        for file in ("task.yaml", "gripper.yaml", "finger.obj"):
            (folder / file).unlink()

    return make


def recorded(folder, program):
    """st.h5, the states of scene.yaml, which lies beside it, and a checkpoint."""
    (folder / "scene.yaml").write_text(SCENE)
    run(program, "simulate", "scene.yaml", "-o", "st.h5", "--checkpoint-every", 0.01, cwd=folder)
    (folder / "st.h5.checkpoint.h5").rename(folder / "check.h5")


def recording(folder, program):
    for file in (DATA / "hidden/pendulum_magnet").iterdir():
        if file.name != "truth.json":
            path = folder / "rec" / file.name
            path.parent.mkdir(exist_ok=True)
            shutil.copy(file, path)


FIXTURES = {
    "scene": text_fixture({"scene.yaml": SCENE}),
    "shown": text_fixture({"shown.yaml": SHOWN, "thing.obj": cube_obj()}),
    "task": task,
    "robot": robot,
    "set": episode_set("set"),
    "bare": episode_set("bare", "--no-render"),
    "recorded": recorded,
    "rec": recording,
    "captures": text_fixture(captures()),
    "compared": text_fixture(compared()),
    "pictures": text_fixture({f"{kind}/front_{i}.png": png(64, 64, lambda x, y, k=k: ((60 + 2 * x) // k, (50 + 2 * y) // k,
                                                                                       (40 + x + y) // k))
                              for k, kind in ((1, "rendered"), (2, "real")) for i in range(2)}),
}


def make_all(store: pathlib.Path, program: str):
    for name, make in FIXTURES.items():
        folder = store / name
        folder.mkdir(parents=True)
        make(folder, program)
