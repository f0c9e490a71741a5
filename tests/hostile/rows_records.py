"""What the program wrote and reads again: states, checkpoints, sets, summaries. Damaged by a disk, a copy or a hand."""
from table import (DONE, FAILED, WRONG_USE, append, copy, cut, drop, edit, make_folder, poke, put, remove, rename, row,
                   set_json, states, write)

N = WRONG_USE
EPISODE = "set/episode_000000"
H5 = f"{EPISODE}/states.h5"
VIEW, EVALUATE, PACK = "view set -o v.html", "evaluate set", "pack set -o p --format act"
RENDER = "render scene.yaml --states st.h5 -o p --width 16 --height 16 --samples 1"

# ---- files that are no states
for name, *steps in (("no states file", remove(H5)), ("an empty states file", write(H5)), ("words", write(H5, "hello\n" * 999)),
                     ("a folder", remove(H5), make_folder(H5)), ("half of it", cut(H5, 0.5)), ("its first kilobyte", cut(H5, 0.001)),
                     ("zeros in the middle", lambda f: (lambda b: (f / H5).write_bytes(b[:2000] + bytes(30000) + b[32000:]))((f / H5).read_bytes()))):
    row(f"a states file: {name}", PACK, N, "states.h5|episode_000000", *steps, needs="set")
    if name != "no states file":  # of a failed episode none may have been kept
        row(f"a states file: {name}", VIEW, N, "states.h5|episode_000000", *steps, needs="set")
        row(f"a states file: {name}", EVALUATE, N, "states.h5|episode_000000", *steps, needs="set")


def truncate(name, n):
    def change(out):
        values = out[name][:n]
        put(name, values)(out)

    return change


def attribute(place, name, value):
    def change(out):
        if value is None:
            del out[place].attrs[name]
        else:
            out[place].attrs[name] = value

    return change


# each names the data set; all commands that read it share one reader
DAMAGED = [
    # what, which data set, how, commands
    ("a frame of step 1e12", "frame_step", poke("/frame_step", 0, 10**12), "VP"),
    ("a frame of step -1", "frame_step", poke("/frame_step", 0, -1), "VP"),
    ("frames that go back", "frame_step", poke("/frame_step", 1, 0), "VP"),
    ("no frames", "frame_step", drop("/frame_step"), "VP"),
    ("frames in two dimensions", "frame_step", put("/frame_step", [[1, 2], [3, 4]]), "VP"),
    ("/q without rows", "/q", truncate("/q", 0), "VP"),
    ("/q with a row too few", "/q", truncate("/q", 5), "VP"),
    ("/q without columns", "/q", put("/q", [[]] * 100, "f8"), "VP"),
    ("/q of NaN", "/q", poke("/q", (0, 0), float("nan")), "VP"),
    ("/q of texts", "/q", put("/q", [b"a", b"b"]), "VP"),
    ("no /q", "/q", drop("/q"), "VP"),
    ("a start of NaN", "/start/q", poke("/start/q", 0, float("nan")), "P"),
    ("a start of two joints", "/start/q", put("/start/q", [1.0, 2.0]), "P"),
    ("no objects at the start", "/start/T_rigid", drop("/start/T_rigid"), "P"),
    ("/a with a row too few", "/a", truncate("/a", 5), "P"),
    ("/torque with a row too few", "/torque", truncate("/torque", 5), "V"),
    ("no names of the joints", "names", attribute("/q", "names", None), "VP"),
    ("fewer names than joints", "1 name for 9", attribute("/q", "names", [b"a"]), "VP"),
    ("names that are numbers", "names", attribute("/q", "names", 7), "VP"),
    ("no /time", "/time", drop("/time"), "VEP"),
    ("/time without rows", "/time|no step|T_link|frame_step", truncate("/time", 0), "EP"),
    ("/time that goes back", "/time", poke("/time", 1, -1.0), "VEP"),
    ("/time of NaN", "/time", poke("/time", 0, float("nan")), "VEP"),
    ("/time in two dimensions", "/time", put("/time", [[1.0, 2.0]]), "VEP"),
    ("no /bodies/source", "source", drop("/bodies/source"), "VE"),
    ("/bodies/source of 99", "source", poke("/bodies/source", 0, 99), "VE"),
    ("/bodies/source of -1", "source", poke("/bodies/source", 0, -1), "VE"),
    ("/bodies/source with one entry", "source", truncate("/bodies/source", 1), "VE"),
    ("/bodies/row of 1e6", "row", poke("/bodies/row", 0, 10**6), "VE"),
    ("/bodies/row of -1", "row", poke("/bodies/row", 0, -1), "VE"),
    ("/bodies/is_fixed with one entry", "is_fixed", truncate("/bodies/is_fixed", 1), "VE"),
    ("no /bodies/is_fixed", "is_fixed", drop("/bodies/is_fixed"), "VE"),
    ("/bodies/noncolliding of 1e9", "noncolliding", poke("/bodies/noncolliding", (0, 0), 10**9), "E"),
    ("data sets that are not there", "data_sets|/moon", attribute("/bodies", "data_sets", [b"/moon"] * 4), "VE"),
    ("a triangle of vertex 4e9", "/mesh/beaker/triangles", poke("/mesh/beaker/triangles", (0, 0), 4 * 10**9), "VE"),
    ("triangles of two corners", "/mesh/beaker/triangles", put("/mesh/beaker/triangles", [[0, 1]]), "VE"),
    ("triangles in one dimension", "/mesh/beaker/triangles", put("/mesh/beaker/triangles", [0, 1, 2, 3]), "VE"),
    ("a mesh without points", "/mesh/beaker/rest", put("/mesh/beaker/rest", [[]], "f8"), "VE"),
    ("a mesh with a point of NaN", "/mesh/beaker/rest", poke("/mesh/beaker/rest", (0, 0), float("nan")), "VE"),
    ("no points of a mesh", "/mesh/beaker/rest", drop("/mesh/beaker/rest"), "VE"),
    ("a mesh of body 99", "/mesh/beaker/body", put("/mesh/beaker/body", 99), "E"),
    ("a soft body with a vertex too few", "/X_gripper/left", lambda out: put("/X_gripper/left", out["/X_gripper/left"][:, :-1])(out), "VE"),
    ("a soft body with a step too few", "/X_gripper/left", truncate("/X_gripper/left", 3), "VE"),
    ("/T_rigid with a step too few", "/T_rigid", truncate("/T_rigid", 3), "VEP"),
    ("/T_rigid without its last axis", "/T_rigid", lambda out: put("/T_rigid", out["/T_rigid"][..., 0])(out), "VEP"),
    ("/T_rigid of NaN", "/T_rigid", poke("/T_rigid", (0, 0, 0, 0), float("nan")), "EP"),
    ("/T_link without links", "/T_link", lambda out: put("/T_link", out["/T_link"][:, :0])(out), "VEP"),
    ("contacts that end before they begin", "/pair_force/offset", poke("/pair_force/offset", 3, -7), "V"),
    ("contacts beyond the list", "/pair_force/offset", poke("/pair_force/offset", -1, 10**9), "V"),
    ("fewer offsets than steps", "/pair_force/offset", truncate("/pair_force/offset", 2), "V"),
    ("no forces of pairs", "/pair_force", drop("/pair_force/normal"), "V"),
    ("no camera", "/camera/front", drop("/camera/front"), "P"),
    ("a camera with a frame too few", "/camera/front", truncate("/camera/front/K", 2), "P"),
    ("no configuration", "configuration", attribute("/", "configuration", None), "P"),
    ("a configuration that is no YAML", "configuration", attribute("/", "configuration", "{{{["), "P"),
    ("a configuration of a word", "configuration", attribute("/", "configuration", "hello"), "P"),
    ("a gripper without its keys", "configuration", attribute("/", "configuration", "gripper: {base_link: gripper_base}"), "P"),
    ("a time step of zero", "attribute `?h`?|time step", attribute("/", "h", 0.0), "P"),
    ("no time step", "`?h`?", attribute("/", "h", None), "P"),
    ("no task", "task", attribute("/", "task", None), "P"),
    ("an episode that is a word", "episode", attribute("/", "episode", "one"), "P"),
]
for name, place, change, commands in DAMAGED:
    for command in (c for key, c in (("V", VIEW), ("E", EVALUATE), ("P", PACK)) if key in commands):
        row(f"states: {name}", command, N, f"states.h5.*({place})", states(H5, change), needs="set")
row("states: a text of 2^40 letters", PACK, N, "states.h5", needs="set", shell=f"""
printf '\\377' | dd of={H5} bs=1 seek=700 conv=notrunc 2>/dev/null; printf '\\377\\377' | dd of={H5} bs=1 seek=1500 conv=notrunc 2>/dev/null
$B {PACK} 2>err; code=$?; cat err >&2; [ $code -le 2 ] && echo 'phyvisgen: states.h5' >&2; exit 2""", makes=["p", "err"], changes=[H5])

# ---- render and resume, of a scene
for name, place, change in (
        ("no /time", "time|states file", drop("/time")), ("no step", "step|T_link|T_rigid", truncate("/time", 0)), ("/bodies/source of 99", "source", poke("/bodies/source", 0, 99)),
        ("/bodies/row of 1e6", "row", poke("/bodies/row", 1, 10**6)), ("/T_rigid with a step too few", "T_link|T_rigid", truncate("/T_rigid", 1)),
        ("a pose of NaN", "T_link|T_rigid", poke("/T_rigid", (0, 0, 0, 0), float("nan"))), ("a frame of step 1e12", "frame_step", put("/frame_step", [10**12])),
        ("time that goes back", "/time", poke("/time", 1, -5.0)), ("a body of another name", "box", attribute("/bodies", "names", [b"ground", b"moon"]))):
    row(f"states: {name}", RENDER, N, f"st.h5.*({place})", states("st.h5", change), needs="recorded", notes=3, makes=["p"])
row("states of another scene", "render shown.yaml --states st.h5 -o p", N, "st.h5.*thing", needs="recorded shown")
row("states of a task, for another seed's scene", f"render task.yaml --states {H5} -o p --frames 0", N, "push|other", needs="task set",
    shell=f"sed -i s/push_beaker/other/ task.yaml; exec $B render task.yaml --states {H5} -o p --frames 0",
    changes=["task.yaml"])
row("states beside a glTF file", "render in.glb --states st.h5 -o p", N, "st.h5.*glTF", write("in.glb", "x"), needs="recorded")
RESUME = "simulate scene.yaml -o more.h5 --duration 0.03 --resume check.h5"
for name, *steps in (("no checkpoint", remove("check.h5")), ("an empty one", write("check.h5")), ("words", write("check.h5", "x" * 999)), ("half of one", cut("check.h5", 0.5)),
                     ("states", remove("check.h5"), copy("st.h5", "check.h5")), ("another scene's", edit("scene.yaml", "0.2", "0.3")),
                     ("positions of NaN", states("check.h5", poke("/position", 0, float("nan")))), ("positions too few", states("check.h5", truncate("/position", 3))),
                     ("a time of NaN", states("check.h5", put("/time", [float("nan")]))), ("a time of -1", states("check.h5", put("/time", [-1.0]))),
                     ("a time of 1e300", states("check.h5", put("/time", [1e300]))),
                     ("velocities too few", states("check.h5", truncate("/history/velocity", 3))), ("no velocities", states("check.h5", drop("/history/velocity"))),
                     ("joints that are not there", states("check.h5", put("/joint_position/values", [1.0] * 9))),
                     ("anchors that are not whole", states("check.h5", lambda out: (put("/anchors/values", [1e9] * 7)(out), put("/anchors/offset", [0, 7])(out)))),
                     ("anchors between sites below 0", states("check.h5", lambda out: (put("/anchors/values", [-1.0] * 8)(out), put("/anchors/offset", [0, 8])(out)))),
                     ("schema 99", states("check.h5", attribute("/", "schema", 99)))):
    row(f"a checkpoint: {name}", RESUME, N, "check.h5", *steps, needs="recorded")
row("a checkpoint at the run's end", "simulate scene.yaml -o more.h5 --duration 0.01 --resume check.h5", N, "check.h5.*duration", needs="recorded")

# ---- set.json
ALL = ("status set", VIEW, "merge set -o whole", EVALUATE, PACK, "generate task.yaml -n 2 --seed 3 -o set")
for name, *steps in (("empty", write("set/set.json")), ("words", write("set/set.json", "hello")), ("a list", write("set/set.json", "[1, 2]")),
                     ("null", write("set/set.json", "null")), ("cut off", cut("set/set.json", 0.5)), ("bytes", write("set/set.json", b"\xff\xfe\0" * 99)),
                     ("braces a hundred thousand deep", write("set/set.json", '{"a":' * 100000)), ("a folder", remove("set/set.json"), make_folder("set/set.json")),
                     ("1e18 episodes", set_json("set/set.json", episodes=10**18)), ("-1 episodes", set_json("set/set.json", episodes=-1)),
                     ("1.5 episodes", set_json("set/set.json", episodes=1.5)), ("2e20 episodes", set_json("set/set.json", episodes=2 * 10**20)),
                     ("episodes in words", set_json("set/set.json", episodes="two")),
                     ("no seed", set_json("set/set.json", seed=None)), ("a seed of -1", set_json("set/set.json", seed=-1)), ("no task", set_json("set/set.json", task=None)),
                     ("a task of 7", set_json("set/set.json", task=7)), ("versions in a list", set_json("set/set.json", versions=[1])),
                     ("a version of 7", set_json("set/set.json", versions={"program": 7})), ("a task that is no name", set_json("set/set.json", task="../../x"))):
    for command in ALL[:3] + ALL[5:]:
        if command.startswith("generate") and name in ("versions in a list", "a version of 7"):
            continue  # is replaced by what made them
        row(f"set.json: {name}", command, N, "set.json", *steps, needs="set task" if "generate" in command else "set")
for command in ("status nowhere", "evaluate nowhere", "pack nowhere -o p", "view nowhere -o v.html", "merge nowhere -o m"):
    row("a set that is not there", command, N, "nowhere")
    row("a file instead of a set", command, N, "nowhere", write("nowhere", "x"))
    row("an empty folder instead of a set", command, N, "nowhere", make_folder("nowhere"))
row("other options for a set that is there", "generate task.yaml -n 2 --seed 4 -o set", N, "set.json.*seed", needs="set task")
row("another task for a set that is there", "generate task.yaml -n 2 --seed 3 -o set", N, "set.json.*(task|configuration)",
    edit("task.yaml", "friction: 0.3", "friction: 0.4"), needs="set task")
row("a set that asked for too many, asked for fewer", "generate task.yaml -n 2 --seed 3 -o set", DONE, r'"episodes": 2,',
    set_json("set/set.json", episodes=100000), needs="set task", changes=["set/set.json"],
    shell="$B generate task.yaml -n 2 --seed 3 -o set >/dev/null 2>&1; cat set/set.json")

# ---- summary.json
SUMMARY = f"{EPISODE}/summary.json"
for name, *steps in (("empty", write(SUMMARY)), ("words", write(SUMMARY, "hello")), ("a list", write(SUMMARY, "[]")), ("null", write(SUMMARY, "null")), ("cut off", cut(SUMMARY, 0.5)),
                     ("cameras in a list", set_json(SUMMARY, cameras=[1, 2])), ("a camera without a size", set_json(SUMMARY, cameras={"front": {}})),
                     ("a camera of -1 pixels", set_json(SUMMARY, cameras={"front": {"width": -1, "height": 48}})),
                     ("a camera in words", set_json(SUMMARY, cameras={"front": {"width": "wide", "height": 48}})),
                     ("a camera that leaves the folder", set_json(SUMMARY, cameras={"../../x": {"width": 64, "height": 48}})),
                     ("a rate of zero", set_json(SUMMARY, frames_per_second=0)), ("a rate in words", set_json(SUMMARY, frames_per_second="ten")),
                     ("a rate of 1e300", set_json(SUMMARY, frames_per_second=1e300)), ("no rate", set_json(SUMMARY, frames_per_second=None)), ("no cameras", set_json(SUMMARY, cameras=None))):
    row(f"summary.json: {name}", PACK, N, "summary.json", *steps, needs="set")
    if "rate" not in name and "camera" not in name:
        row(f"summary.json: {name}", VIEW, N, "summary.json", *steps, needs="set")
FAILED_SUMMARY = "set/failed/episode_000001/summary.json"
for name, content in (("a list", "[]"), ("words", "hello"), ("a reason of 7", '{"reason": 7}'), ("no reason", "{}"), ("null", "null"), ("empty", "")):
    for command in ("status set", EVALUATE, "merge set -o whole"):
        row(f"a failed episode's summary.json: {name}", command, N, "episode_000001.*summary.json", remove("set/episode_000001"),
            write(FAILED_SUMMARY, content), needs="set")

# ---- videos and packing
for format in ("lerobot", "lerobot2", "act", "robomimic", "zarr"):
    row(f"a set without pictures, packed as {format}", f"pack bare -o p --format {format}", N, "episode_000000.*pictures", needs="bare")
    if not format.startswith("lerobot"):  # which look for Python with pyarrow first
        row(f"a video of no bytes, packed as {format}", f"pack set -o p --format {format}", FAILED, "front.mp4", write(f"{EPISODE}/front.mp4"), needs="set")
row("no video", PACK, FAILED, "front.mp4", remove(f"{EPISODE}/front.mp4"), needs="set")
row("half a video", PACK, FAILED, "front.mp4", cut(f"{EPISODE}/front.mp4", 0.5), needs="set")
row("words instead of a video", PACK, FAILED, "front.mp4", write(f"{EPISODE}/front.mp4", "hello" * 99), needs="set")
row("a picture of another size as a video", PACK, FAILED, "front.mp4", copy("rendered/front_0.png", "x.png"), rename("x.png", "y.png"),
    lambda f: (f / f"{EPISODE}/front.mp4").write_bytes((f / "y.png").read_bytes()), needs="set pictures")
row("an instruction of a page's script", "view set -o v.html", DONE, "", set_json(SUMMARY, task="</script><script>alert(1)</script>"), needs="set", makes=["v.html"])
row("no episode in a set", "pack set -o p", N, "set.*no.*episode", remove("set/episode_000000"), remove("set/episode_000001"), needs="set")
row("no episode in a set", EVALUATE, N, "set.*no episodes", remove("set/episode_000000"), remove("set/episode_000001"), needs="set")
