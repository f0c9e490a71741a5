"""Outputs that would lose something, and places where nothing can be written."""
from table import DONE, FAILED, TRY_AGAIN, WRONG_USE, copy, cut, edit, link, make_folder, row, set_json, write

N = WRONG_USE
ONTO = "reads|same|itself|input|over"

# ---- onto what is read
row("the page onto a states file", "view set -o set/episode_000000/states.h5", N, f"states.h5.*({ONTO}|html)", needs="set")
row("the page onto set.json", "view set -o set/set.json", N, f"set.json.*({ONTO}|html)", needs="set")
row("the page onto a summary", "view set -o set/episode_000000/summary.json", N, f"summary.json.*({ONTO}|html)", needs="set")
row("the page onto a video", "view set/episode_000000 -o set/episode_000000/front.mp4", N, f"front.mp4.*({ONTO}|html)",
    needs="set")
row("the exported scene onto the states", "render scene.yaml --states st.h5 --export st.h5", N, f"st.h5.*({ONTO}|glb)",
    needs="recorded", notes=3)
row("the exported scene onto the scene file", "render scene.yaml --export scene.yaml", N, f"scene.yaml.*({ONTO}|glb)",
    needs="scene", notes=3)
row("the exported scene onto the glTF file", "render in.glb --export in.glb", N, f"in.glb.*({ONTO})", needs="scene",
    shell="$B render scene.yaml --export in.glb 2>/dev/null && exec $B render in.glb --export ./in.glb", makes=["in.glb"])
row("states onto the scene file", "simulate scene.yaml -o scene.yaml", N, f"scene.yaml.*({ONTO})", needs="scene")
row("states onto the scene file by another name", "simulate scene.yaml -o ./x/../scene.yaml", N, f"scene.yaml.*({ONTO})",
    make_folder("x"), needs="scene")
row("states onto the scene file by a link", "simulate scene.yaml -o other.h5", N, f"other.h5.*({ONTO})",
    link("other.h5", "scene.yaml"), needs="scene")
row("states onto the checkpoint", "simulate scene.yaml -o check.h5 --resume check.h5 --duration 0.03", N,
    f"check.h5.*({ONTO})", needs="recorded")
row("the animation onto the scene file", "simulate scene.yaml -o s.h5 --animation scene.yaml", N,
    f"scene.yaml.*({ONTO}|glb)", needs="scene")
row("the animation onto the states", "simulate scene.yaml -o s.h5 --animation s.h5", N, f"s.h5.*({ONTO}|glb|same)", needs="scene")
row("states onto a mesh of the scene", "simulate shown.yaml -o thing.obj", N, f"thing.obj.*({ONTO}|h5)", needs="shown")
row("pictures onto the scene's mesh", "render shown.yaml --export thing.obj", N, f"thing.obj.*({ONTO}|glb)", needs="shown")
row("a picture onto a texture", "render shown.yaml -o skin.png", N, f"skin.png.*({ONTO})",
    edit("shown.yaml", "color: [0.5, 0.5, 0.5]}", "texture: skin.png}"), copy("rendered/front_0.png", "skin.png"),
    needs="shown pictures")
row("the table onto a picture", "calibrate lut --render rendered --real real -o real/front_0.png", N,
    f"front_0.png.*({ONTO}|csv)", needs="pictures")
row("the set into its own task file", "generate task.yaml -o task.yaml", N, "task.yaml", needs="task")
row("the packed set into the set", "pack set -o set", N, "set.*", needs="set")
row("the packed set into the set's folder", "pack set -o set/packed", N, "set/packed.*inside|inside.*set|in the set",
    needs="set")
row("the packed set into an episode", "pack set -o set/episode_000000", N, "episode_000000", needs="set")
row("the packed set above the set", "pack x/set -o x", N, "x", make_folder("x"), lambda f: (f / "set").rename(f / "x/set"),
    needs="set")
row("the packed set onto another folder", "pack set -o mine", N, "mine", write("mine/precious"), needs="set")
row("the report onto the recording", "diagnose rec -o rec/recording.yaml", N, "recording.yaml", needs="rec")
row("the report into a file", "diagnose rec -o rec/run_0.csv", N, "run_0.csv", needs="rec")

# ---- merge
row("merge into a part, and remove the part", "merge set -o set/whole --remove", N, "set/whole.*(inside|in )", needs="set")
row("merge into a part", "merge set -o set/whole", N, "set/whole.*(inside|in )", needs="set")
row("merge by `..` into a part, and remove the part", "merge set -o set/../set/whole --remove", N, "inside|in ", needs="set")
row("merge by a link into a part, and remove the part", "merge set -o way/whole --remove", N, "inside|in ",
    link("way", "set"), needs="set")
row("merge above the part, as jobs of submit do, and remove the part", "merge set/part -o set --remove", DONE,
    "2 there before", copy("set", "part"), lambda f: (f / "part").rename(f / "set/part"), needs="set",
    changes=["set/set.json", "set/part", "set/part/*"])
row("merge, and remove what is not ours", "merge set -o whole --remove", DONE, "2 merged",
    write("set/notes.txt", "mine"), write("set/mine/photo.png", "mine"), needs="set", makes=["whole"],
    changes=["set/set.json", "set/episode_*"])
row("merge, and remove an episode with a file that is not ours", "merge set -o whole --remove", DONE, "2 merged",
    write("set/episode_000001/notes.txt", "mine"), needs="set", makes=["whole"],
    changes=["set/set.json", "set/episode_000000", "set/episode_000000/*", "set/episode_000001/s*",
             "set/episode_000001/c*", "set/episode_000001/front*"])
row("merge of a part with itself", "merge set set -o whole", N, "set.*twice|same|two", needs="set")
row("merge of sets with other seeds", "merge set bare -o whole", N, "not parts of one set", needs="set bare")
row("merge of sets with other seeds", "merge set two -o whole", N, "seeds", copy("set", "two"),
    set_json("two/set.json", seed=4), needs="set")
row("merge of sets of other tasks", "merge set two -o whole", N, "tasks", copy("set", "two"),
    set_json("two/set.json", task="other"), needs="set")
row("merge onto a file", "merge set -o out", N, "out", write("out", "mine"), needs="set")
row("merge of an episode that differs", "merge set two -o whole", FAILED, "episode 0 differs", copy("set", "two"),
    cut("two/episode_000000/states.h5", 0.9), needs="set", makes=["whole"])

# ---- names that leave the folder
for escape in ("../../evil", "/proc/evil", "a/b", ".hidden", "..", "."):
    row(f"a camera that is called {escape}", "generate task.yaml -o o", N, "task.yaml:.*name.*letters",
        edit("task.yaml", "name: front", f"name: {escape}"), needs="task")
    row(f"a camera that is called {escape}", "render shown.yaml -o p", N, "shown.yaml:.*name.*letters",
        edit("shown.yaml", "name: front", f"name: {escape}"), needs="shown")

# ---- places that cannot be written
for command, need in (("generate task.yaml", "task"), ("pack set", "set"), ("merge set", "set"), ("diagnose rec", "rec"),
                      ("submit task.yaml -n 2", "task")):
    row("a folder below a file", f"{command} -o file/o", N, "file", write("file", "mine"), needs=need)
    row("a folder where nobody may write", f"{command} -o /proc/o", N, "/proc", needs=need)
    row("an empty name of a folder", f"{command} -o ''", N, "-o", needs=need)
for command, need, ending in (("simulate scene.yaml", "scene", "h5"), ("render shown.yaml", "shown", "png"),
                              ("view set", "set", "html"),
                              ("calibrate lut --render rendered --real real", "pictures", "csv")):
    if ending == "html":  # a page may be the first thing of its folder
        row("a file in a folder that is not there", f"{command} -o nowhere/o.{ending}", DONE, "nowhere", needs=need, makes=["nowhere"])
    else:
        row("a file in a folder that is not there", f"{command} -o nowhere/o.{ending}", N, "nowhere", needs=need)
    row("a file where nobody may write", f"{command} -o /proc/o.{ending}", N, "/proc", needs=need)
    row("a folder where a file should be", f"{command} -o o.{ending}", N, rf"o\.{ending}.*folder|folder.*o\.{ending}",
        make_folder(f"o.{ending}"), needs=need)
    row("a file below a file", f"{command} -o file/o.{ending}", N, "file", write("file", "mine"), needs=need)
    row("an empty name of a file", f"{command} -o ''", N, "-o|output", needs=need)
    row("a name of 300 letters", f"{command} -o {'n' * 300}.{ending}", N, "nnn.*(long|could not|cannot)", needs=need)
row("a page that is no page", "view set -o page.txt", N, "page.txt.*html", needs="set")
# a device of the row's own, as /dev/full is: what is renamed onto it would be gone for the whole machine
DEVICE = """[ "$(id -u)" = 0 ] && mknod {file} c 1 7 || mkfifo {file}
$B {command}
code=$?
[ -c {file} ] || [ -p {file} ] || echo "LOST the device" >&2
rm -f {file}; exit $code"""
for command, file, need in (("view set", "full.html", "set"), ("simulate scene.yaml", "full.h5", "scene"),
                            ("calibrate lut --render rendered --real real", "full.csv", "pictures"),
                            ("render shown.yaml", "full.png", "shown")):
    row("an output onto a device", f"{command} -o {file}", N, rf"\A(?!.*LOST).*{file}", needs=need,
        shell=DEVICE.format(command=f"{command} -o {file}", file=file))
row("a picture of an unknown kind", "render shown.yaml -o p.gif", N, "p.gif.*png", needs="shown")
row("an exported scene of an unknown kind", "render shown.yaml --export p.obj", N, "p.obj.*glb", needs="shown")
row("an exported scene in no folder", "render shown.yaml --export nowhere/p.glb", N, "nowhere", needs="shown")
row("an animation in no folder", "simulate scene.yaml -o s.h5 --animation nowhere/a.glb", N, "nowhere", needs="scene")
row("one picture of two cameras", "render shown.yaml -o p.png", N, "p.png.*camera", edit("shown.yaml", "cameras:\n",
    "cameras:\n  - {name: two, width: 16, height: 16, vertical_field_of_view: 40 deg, position: [1, 0, 0], look_at: [0, 0, 0.2]}\n"),
    needs="shown")
row("curves where a file is", "validate --case slope --plots file", N, "file", write("file", "mine"))

# ---- a full disk: nothing half-written stays (as root, where a small disk can be mounted)
FULL = """mkdir disk && mount -t tmpfs -o size={size} none disk || {{ echo "phyvisgen: disk full: not root"; exit {code}; }}
trap 'umount disk' EXIT
{before}
$B {command}
code=$?
left=$(find disk -type f ! -name filler)
[ -z "$left" ] || echo "LEFT: $left" >&2
exit $code"""
FILL = "head -c 10M /dev/zero >disk/filler 2>/dev/null"
for command, need in (("view set -o disk/v.html", "set"), ("render shown.yaml -o disk/p.png", "shown"),
                      ("render shown.yaml -o disk/p.mp4 --width 640 --height 480", "shown"),
                      ("render shown.yaml --export disk/p.glb", "shown"),
                      ("simulate scene.yaml -o disk/s.h5", "scene"),
                      ("simulate scene.yaml -o s.h5 --animation disk/a.glb", "scene"),
                      ("calibrate lut --render rendered --real real -o disk/l.csv", "pictures"),
                      ("pack set -o disk/p --format act", "set"), ("merge set -o disk/m", "set"),
                      ("submit task.yaml -n 2 -o disk/o", "task"), ("generate task.yaml -o disk/o", "task")):
    row("a full disk", command, FAILED, r"\A(?!.*LEFT)(?!.*partial-).*disk", needs=need,
        shell=FULL.format(size="64k", code=FAILED, before=FILL, command=command), makes=["disk", "s.h5"])
