"""Captures of rooms and objects, calibration of cameras, and pictures compared with reality."""
import json

import fixtures
from table import DONE, WRONG_USE, copy, cut, edit, make_folder, remove, row, set_json, write

N = WRONG_USE
GLB = bytes(range(256)) * 8


def capture(name, folder, pattern, *steps, code=N, **more):
    row(f"{folder}: {name}", f"capture room {folder} -o room", code, pattern, *steps, needs="captures", **more)


# ---- what is no capture
row("a capture that is not there", "capture room nowhere -o room", N, "nowhere: there is no such folder of frames or mesh")
row("a capture that is a file", "capture room file -o room", N, "file: meshes are read from", write("file", "mine"))
row("a capture that is empty", "capture room empty -o room", N, "empty is no capture", make_folder("empty"))
row("a capture of nothing", "capture room", N, "capture room needs")
row("capture of what", "capture", N, "needs a command: object, room.*--help")
row("capture of something else", "capture rooms", N, "rooms.*room")
row("the room into its capture", "capture room seven -o seven", N, "seven", needs="captures")
row("the room within its capture", "capture room seven -o seven/room", N, "seven/room", needs="captures")
row("the room into a folder that is mine", "capture room seven -o mine", N, "mine", write("mine/precious"), needs="captures")
row("the room into a file", "capture room seven -o mine", N, "mine", write("mine", "x"), needs="captures")
row("the room where nobody may write", "capture room seven -o /proc/room", N, "/proc", needs="captures")
for option, number in (("--voxel", "0"), ("--voxel", "nan"), ("--max-depth", "-1"), ("--depth-unit", "0"), ("--noise", "inf"),
                       ("--memory", "1"), ("--least-piece", "-1"), ("--triangles", "-5"), ("--hold-out", "-1"),
                       ("--ground", "1000"), ("--align-colors", "maybe"), ("--device", "moon")):
    row(f"capture room {option} {number}", f"capture room seven -o room {option}={number}", N, rf"{option[2:]}.*{number}|{number}.*devices",
        needs="captures")

row("a texture without photos", "capture room seven -o room --texture", N, "--texture needs photos",
    *(remove(f"seven/frame-00000{i}.color.png") for i in range(2)), needs="captures")

# ---- 7-Scenes
capture("no intrinsics", "seven", "camera-intrinsics.txt is missing", remove("seven/camera-intrinsics.txt"))
for name, text in (("empty", ""), ("in words", "wide"), ("four numbers", "1 2 3 4"), ("nan", "nan 0 1 0 60 1 0 0 1"),
                   ("zero", "0 0 31.5 0 0 23.5 0 0 1"), ("negative", "-60 0 31.5 0 -60 23.5 0 0 1"), ("1e300", "1e300 0 31.5 0 1e300 23.5 0 0 1")):
    capture(f"intrinsics {name}", "seven", "camera-intrinsics.txt|camera|focal|fx|depth|surface", write("seven/camera-intrinsics.txt", text))
POSE = "seven/frame-000001.pose.txt"
for name, text in (("in words", "here"), ("three numbers", "1 2 3"), ("that scales", "2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1"),
                   ("that mirrors", "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"), ("1e12 m away", "1 0 0 1e12 0 1 0 0 0 0 1 0 0 0 0 1")):
    capture(f"a pose {name}", "seven", "frame-000001|m apart.*in metres", write(POSE, text))
capture("a pose of nan", "seven --align-colors no", "1 of 2 frames lacks depth or a finite pose", write(POSE, "nan " * 16), code=DONE, makes=["room"])
capture("poses of nan", "seven", "no frame .* a finite pose", write(POSE, "nan " * 16), write(POSE.replace("1.pose", "0.pose"), "nan " * 16))
capture("no pose at all", "seven", "none of 2 frames has a pose", remove(POSE), remove(POSE.replace("1.pose", "0.pose")))
DEPTH = "seven/frame-000001.depth.png"
for name, step in (("empty", write(DEPTH)), ("bytes", write(DEPTH, GLB)), ("cut off", cut(DEPTH, 0.5)),
                   ("of 8 bits", write(DEPTH, fixtures.png(64, 48, (9, 9, 9)))), ("a folder", lambda f: ((f / DEPTH).unlink(), (f / DEPTH).mkdir()))):
    capture(f"a depth picture {name}", "seven", "frame-000001", step)
for name, depth in (("of zeros", 0), ("65 m away", 65535)):
    capture(f"depth pictures {name}", "seven", "depth", *(write(f"seven/frame-00000{i}.depth.png", fixtures.depth_png(64, 48, depth)) for i in range(2)))
COLOR = "seven/frame-000001.color.png"
for name, step in (("empty", write(COLOR)), ("bytes", write(COLOR, GLB)), ("cut off", cut(COLOR, 0.5))):
    capture(f"a photo {name}", "seven --align-colors no", "frame-000001.color", step)

# ---- TUM
capture("no optics", "tum", "camera.txt is missing", remove("tum/camera.txt"))
for name, file, text, pattern in (("optics of five numbers", "camera.txt", "1 2 3 4 5", "camera.txt"), ("optics in words", "camera.txt", "wide", "camera.txt"),
                                  ("optics that are nan", "camera.txt", "nan nan nan nan", "camera|focal"), ("no poses", "groundtruth.txt", "", "groundtruth"),
                                  ("a pose of seven numbers", "groundtruth.txt", "1 0 0 0 0 0 1\n", "groundtruth"), ("poses at other times", "groundtruth.txt", "99 0 0 0 0 0 0 1\n", "tum"),
                                  ("a quaternion of length 2", "groundtruth.txt", "1 0 0 0 0 0 0 2\n", "quaternion"), ("a quaternion of zeros", "groundtruth.txt", "1 0 0 0 0 0 0 0\n", "quaternion"),
                                  ("a time in words", "depth.txt", "noon depth/0.png\n", "depth.txt"), ("a line without a file", "depth.txt", "1\n", "depth.txt"),
                                  ("a depth picture that is not there", "depth.txt", "1 depth/9.png\n", "9.png"), ("a photo that is not there", "rgb.txt", "1 rgb/9.png\n", "9.png"),
                                  ("no depth pictures", "depth.txt", "", "tum")):
    capture(name, "tum", pattern, write(f"tum/{file}", text))

# ---- nerfstudio
T = "nerf/transforms.json"
capture("bytes", "nerf", "transforms.json", write(T, GLB))
capture("cut off", "nerf", "transforms.json", cut(T, 0.5))
capture("a list", "nerf", "transforms.json", write(T, "[]"))
capture("a depth picture of another size", "nerf", "1.png has 32 x 24", write("nerf/depth/1.png", fixtures.depth_png(32, 24)))
capture("nested a million times", "nerf", "transforms.json", write(T, "[" * 1000000))
for name, change in (("frames in words", {"frames": "two"}), ("no frames", {"frames": []}), ("frames that are numbers", {"frames": [1, 2]}),
                     ("no width", {"w": None}), ("a width in words", {"w": "wide"}), ("a width of 1e300", {"w": 1e300}), ("a negative width", {"w": -64}),
                     ("a focal length of zero", {"fl_x": 0}), ("a model that is not read", {"camera_model": "EQUIRECTANGULAR"}),
                     ("a model that is a number", {"camera_model": 7}), ("k1 in words", {"k1": "much"}), ("k1 of 1e300", {"k1": 1e300})):
    capture(name, "nerf", "transforms.json|camera|depth|nerf", set_json(T, **change))
for old, new in (('"depth/1.png"', "7"), ('"depth/1.png"', '"../../../etc/passwd"'), ('"depth/1.png"', '"depth/9.png"'), ('"images/1.png"', "[1]"),
                 ('"images/1.png"', '"images/9.png"'), ('"transform_matrix"', '"matrix"'), ("0.02", '"far"'), ("0.02", "1e400")):
    capture(f"{new} instead of {old}", "nerf", "transforms.json|png|passwd|pose", edit(T, old, new))

# ---- COLMAP
C, I = "colmap/sparse/0/cameras.txt", "colmap/sparse/0/images.txt"
capture("no cameras", "colmap", "cameras.txt is missing", remove(C))
capture("no depth maps", "colmap", "depth map", remove("colmap/depth"))
for name, file, text in (("a camera in words", C, "one\n"), ("a model that is not read", C, "1 FULL_OPENCV 64 48 1 1 1 1\n"), ("a camera without size", C, "1 PINHOLE\n"),
                         ("a size of 10^9", C, "1 PINHOLE 1000000000 1000000000 60 60 32 24\n"), ("a camera of no image", C, "2 PINHOLE 64 48 60 60 32 24\n"),
                         ("an image in words", I, "one\n\n"), ("a quaternion of length 2", I, "1 2 0 0 0 0 0 0 1 0.png\n\n"), ("a nan position", I, "1 1 0 0 0 nan 0 0 1 0.png\n\n"),
                         ("no image", I, "")):
    capture(name, "colmap", "colmap|camera 0.png", write(file, text))
for file in ("cameras.bin", "images.bin"):
    for name, content in (("empty", b""), ("of 2^64 - 1 rows", b"\xff" * 8), ("bytes", GLB)):
        capture(f"{file} {name}", "colmap", "sparse|colmap", write("colmap/sparse/0/images.bin", b"\0" * 8),
                write("colmap/sparse/0/cameras.bin", b"\0" * 8), write(f"colmap/sparse/0/{file}", content))

# ---- objects
OBJ = fixtures.cube_obj()
row("an object that is not there", "capture object none.obj -o can", N, "none.obj")
row("an object of nothing", "capture object", N, "capture object needs")
for name, text in (("empty", ""), ("words", "hello"), ("points without triangles", "v 0 0 0\nv 1 0 0\n"), ("one point three times", "v 0 0 0\nf 1 1 1\n"),
                   ("a point that is nan", OBJ.replace("0.05", "nan", 1)), ("a point at 1e300", OBJ.replace("0.05", "1e300", 1)),
                   ("an index that is not there", OBJ + "f 1 2 99\n")):
    row(f"an object: {name}", "capture object thing.obj -o can", N, "thing.obj", write("thing.obj", text))
row("the object onto its mesh", "capture object thing.obj -o thing.obj", N, "thing.obj", write("thing.obj", OBJ))
row("the object into a folder that is mine", "capture object thing.obj -o mine", N, "mine", write("thing.obj", OBJ), write("mine/precious"))
row("an object of two masses", "capture object thing.obj -o can --mass 1 --density 1000", N, "--density and --mass", write("thing.obj", OBJ))
for option, number in (("--scale", "0"), ("--density", "-1"), ("--mass", "nan"), ("--detail", "0"), ("--bridge", "inf"), ("--error", "-1"), ("--triangles", "few"),
                       ("--triangles", "0"), ("--triangles", "3")):
    row(f"capture object {option} {number}", f"capture object thing.obj -o can {option}={number}", N, rf"{option}.*{number}", write("thing.obj", OBJ))
row("a thing on no table", "capture object seven -o can", N, "plane|stands|surface", needs="captures")
row("a thing in a folder that is no capture", "capture object empty -o can", N, "empty is no capture", make_folder("empty"))
row("a thing with a scale", "capture object seven -o can --scale 0.001", N, "--scale.*--depth-unit", needs="captures")
row("a thing into its capture", "capture object seven -o seven/can", N, "seven", needs="captures")
row("an object finer than can be", "capture object thing.obj -o can --wrap --detail 0.001", N, "detail", write("thing.obj", OBJ))

# ---- calibrate camera
row("a board and no photo", "calibrate camera -o c.yaml --board charuco,7x5,30,22", N, "photo")
row("photos without the usual board", "calibrate camera rendered -o c.yaml", N, "board is found in 0 of 2", needs="pictures")
for board in ("", "charuco", "charuco,7x5", "charuco,7x5,30", "charuco,7x5,22,30", "charuco,0x5,30,22", "charuco,7x,30,22", "charuco,7x5,nan,22",
              "charuco,99999x99999,30,22", "charuco,7x5,-30,-22", "moon,7x5,30,22", "chessboard,7x5,30,22,1"):
    row(f"the board `{board}`", f"calibrate camera rendered -o c.yaml --board='{board}'", N, "--board|board", needs="pictures")
row("photos without a board in them", "calibrate camera rendered -o c.yaml --board charuco,7x5,30,22", N, "rendered|board", needs="pictures", notes=3)
row("photos that are not there", "calibrate camera nowhere -o c.yaml --board charuco,7x5,30,22", N, "nowhere")
row("photos that are none", "calibrate camera bad.png -o c.yaml --board charuco,7x5,30,22", N, "bad.png", write("bad.png", "no photo"))
row("the camera onto a photo", "calibrate camera rendered -o rendered/front_0.png --board charuco,7x5,30,22", N, "front_0.png", needs="pictures")
row("the board onto a photo", "calibrate camera rendered --print rendered/front_0.png --board charuco,7x5,30,22", N, "front_0.png", needs="pictures")
row("three numbers of distortion", "calibrate camera rendered -o c.yaml --board charuco,7x5,30,22 --distortion 3", N, "--distortion.*3", needs="pictures")
row("the board where nobody may write", "calibrate camera --board charuco,7x5,30,22 --print /proc/b.svg", N, "/proc")

# ---- calibrate pose
TAGS = "tags:\n  - {id: 0, size: 64 mm, position: [0.3, 0.1, 0]}\n"
CAMERA = "schema: 1\nmodel: pinhole\nwidth: 64\nheight: 64\nintrinsics: [60, 60, 32, 32]\ndistortion: [0, 0, 0, 0, 0]\n"
POSE_OF = "calibrate pose photo.png --tags tags.yaml --camera camera.yaml"
GIVEN = (write("tags.yaml", TAGS), write("camera.yaml", CAMERA), write("photo.png", fixtures.png(64, 64, (90, 90, 90))))
row("a photo without tags", POSE_OF, N, "photo.png", *GIVEN)
row("no photo", "calibrate pose", N, "PHOTO")
row("no tags", "calibrate pose photo.png --camera camera.yaml", N, "--tags", *GIVEN)
row("no camera", "calibrate pose photo.png --tags tags.yaml", N, "--camera", *GIVEN)
row("the pose onto the tags", POSE_OF + " -o tags.yaml", N, "tags.yaml", *GIVEN)
for name, text in (("empty", ""), ("none", "tags: []\n"), ("a number", "tags: 7\n"), ("an id that is none", TAGS.replace("id: 0", "id: 587")),
                   ("no size", TAGS.replace("size: 64 mm, ", "")), ("a size of nan", TAGS.replace("64 mm", ".nan")),
                   ("an unknown key", TAGS.replace("id: 0", "id: 0, colour: red")), ("the same id twice", TAGS + TAGS[6:])):
    row(f"tags: {name}", POSE_OF, N, "tags.yaml", *GIVEN, write("tags.yaml", text))
for name, old, new in (("no width", "width: 64\n", ""), ("a width of 1e9", "width: 64", "width: 1000000000"), ("three intrinsics", "60, 60, 32, 32", "60, 60, 32"),
                       ("intrinsics of zero", "60, 60", "0, 0"), ("an unknown model", "pinhole", "plenoptic"), ("another size than the photo", "width: 64", "width: 32"),
                       ("a schema of the future", "schema: 1", "schema: 2")):
    row(f"a camera file: {name}", POSE_OF, N, "camera.yaml|photo.png", *GIVEN, edit("camera.yaml", old, new))

HAND_OF = "calibrate pose photo.png --tags tags.yaml --camera camera.yaml --hand hand.csv"
HAND = "x,y,z,qx,qy,qz,qw\n0.1,0,0.3,0,0,0,1\n"
HELD = (*GIVEN, write("hand.csv", HAND))
row("two photos without the hand", POSE_OF.replace("photo.png", "photo.png photo.png"), N, "--hand", *GIVEN)
row("a robot without the hand", POSE_OF + " --robot arm.urdf --link tip", N, "--hand", *GIVEN)
row("a hand without tags in the photo", HAND_OF, N, "0 of 1 photo;", *HELD)
row("a link without a robot", HAND_OF + " --link tip", N, "--robot", *HELD)
row("a robot that is not there", HAND_OF + " --robot nowhere.urdf --link tip", N, "nowhere.urdf", *HELD)
for name, old, new, code in (("a row too many", HAND[-18:], HAND[-18:] * 2, N), ("no quaternion", "qw", "w", N), ("a quaternion of zero", "0,0,0,1", "0,0,0,0", N),
                             ("a gap", "0.3", "", N), ("text", "0.3", "far", N), ("nothing", HAND, "", N)):
    row(f"the hand's log: {name}", HAND_OF, code, "hand.csv", *GIVEN, write("hand.csv", HAND.replace(old, new)))
GLASS = "capture object --revolve glass.csv --wall 2 --scale 0.001 -o out"
for name, text in (("a rim in the axis", "radius,height\n0,0\n0,10\n30,80\n"), ("a negative radius", "radius,height\n0,0\n-3,0\n30,80\n"),
                   ("a wall thicker than the glass", "radius,height\n0,0\n1,0\n1,80\n"), ("no heights", "radius\n0\n1\n1\n"), ("a word", "radius,height\n0,0\nx,5\n"), ("nothing", "")):
    row(f"a profile: {name}", GLASS, N, "glass.csv", write("glass.csv", text))
row("a profile that is not there", GLASS, N, "glass.csv.*no such")
row("a profile and a mesh", GLASS + " glass.csv", N, "--revolve", write("glass.csv", "radius,height\n0,0\n30,0\n30,80\n"))

# ---- a vessel from masks
MASKED = "capture object --masks glass --wall 2 -o out"


def transforms(**changes):
    rows = [[1, 0, 0, 0.1], [0, 0, -1, -0.5], [0, 1, 0, 0.05], [0, 0, 0, 1]]
    frames = [{"mask_path": f"{i}.png", "transform_matrix": rows} for i in range(3)]
    return json.dumps({"w": 16, "h": 16, "fl_x": 20, "fl_y": 20, "cx": 8, "cy": 8, "frames": frames, **changes})


WHITE = [write(f"glass/{i}.png", fixtures.png(16, 16, (255, 255, 255))) for i in range(3)]
TRANSFORMS = "glass/transforms.json"
row("masks that are not there", MASKED, N, "glass.*transforms.json")
row("masks in an empty folder", MASKED, N, "glass.*transforms.json", make_folder("glass"))
for name, text, pattern in (("no JSON", "{", "transforms.json"), ("a list", "[]", "transforms.json"), ("no frames", transforms(frames=[]), "three photos"),
                            ("frames without masks", transforms(frames=[{"file_path": "0.png"}]), "three photos"),
                            ("a frame without a pose", transforms(frames=[{"mask_path": "0.png"}]), "transform_matrix.*pose"),
                            ("no focal length", transforms(fl_x="wide"), "fl_x"), ("a focal length of zero", transforms(fl_x=0), "focal|fx"),
                            ("no size", transforms(w=0), "`w`"), ("another size", transforms(w=32, h=32), "0.png has 16 x 16.*32 x 32"),
                            ("all white", transforms(), "0.png.*no outline")):
    row(f"masks: {name}", MASKED, N, pattern, *WHITE, write(TRANSFORMS, text))
row("masks: one is missing", MASKED, N, "0.png", *WHITE, write(TRANSFORMS, transforms()), remove("glass/0.png"))
row("masks: bytes", MASKED, N, "0.png", *WHITE, write(TRANSFORMS, transforms()), write("glass/0.png", GLB))
row("masks and a mesh", MASKED + " thing.obj", N, "one of a source.*--masks", write("thing.obj", OBJ))
row("masks and a profile", MASKED + " --revolve glass.csv", N, "one of a source.*--masks")
row("a wall of a mesh", "capture object thing.obj --wall 2 -o out", N, "--wall is for", write("thing.obj", OBJ))
row("the vessel into its masks", "capture object --masks glass --wall 2 -o glass/out", N, "glass", *WHITE, write(TRANSFORMS, transforms()))

# ---- evaluate fidelity
F = "evaluate fidelity real sim"
row("fidelity of one folder", "evaluate fidelity real", N, "REAL and SIM", needs="compared")
row("fidelity of what is not there", "evaluate fidelity real nowhere", N, "nowhere", needs="compared")
row("fidelity of an empty folder", "evaluate fidelity real empty", N, "empty", make_folder("empty"), needs="compared")
row("fidelity of a file", "evaluate fidelity real sim/0.png", N, "0.png", needs="compared")
row("fidelity without a common name", F, N, "real.*sim|sim.*real|same name|common", *(lambda f, i=i: ((f / f"sim/{i}.png").rename(f / f"sim/x{i}.png"),
    (f / f"sim/masks/{i}.png").rename(f / f"sim/masks/x{i}.png")) for i in range(3)), needs="compared")
for name, step in (("bytes", write("sim/1.png", GLB)), ("cut off", cut("sim/1.png", 0.5)), ("of another size", write("sim/1.png", fixtures.png(16, 16, (1, 2, 3)))),
                   ("a mask of bytes", write("sim/masks/1.png", GLB)), ("a mask of another size", write("sim/masks/1.png", fixtures.png(16, 16, (0, 0, 0))))):
    row(f"fidelity: a picture {name}", F, N, "1.png|picture 1|mask 1", step, needs="compared")
row("fidelity: masks that are no HDF5", "evaluate fidelity sim other", N, "front_masks.h5|other", write("other/front_masks.h5", GLB), needs="compared")
row("the report into what it compares", F + " -o sim/report", N, "sim/report", needs="compared")
row("the report where nobody may write", F + " -o /proc/report", N, "/proc", needs="compared")
for frames in ("3:1", "0:99", "a:b", "", "-1:2"):
    row(f"fidelity of the frames `{frames}`", F + f" --frames='{frames}'", N, "--frames", needs="compared")
for baseline in ("rigid", "=sim", "rigid=", "rigid=nowhere"):
    row(f"the baseline `{baseline}`", F + f" --baseline {baseline}", N, "--baseline|nowhere|rigid", needs="compared")
for option, number in (("--stretch", "0"), ("--shown", "-1"), ("--stretch", "nan")):
    row(f"fidelity {option} {number}", F + f" {option}={number}", N, rf"{option}.*{number}", needs="compared")
row("fidelity with a table that is none", F + " --lut t.csv", N, "t.csv", write("t.csv", "hello"), needs="compared")
row("fidelity that is well", F, DONE, "mean IoU", needs="compared")
