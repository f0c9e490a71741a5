"""serve, policies in the loop, recorded sets of a task as measurements, and what an episode keeps."""
import json
import struct

from table import DATA, DONE, FAILED, REPOSITORY, WRONG_USE, cut, drop, edit, poke, put, remove, row, set_json, states, write

N = WRONG_USE

# ---- serve: a request is answered by an error, and the server goes on; a stream that is none ends it with a sentence
SERVE = "serve task.yaml --no-render"
row("serve nothing", "serve", N, "task")
row("serve what is not there", "serve none.yaml", N, "none.yaml")
row("serve a scene as several worlds", "serve scene.yaml --worlds 2", N, "--worlds is for tasks; .*scene.yaml", needs="scene")
row("serve a scene with fingers", "serve scene.yaml --gripper rigid", N, "--gripper rigid is for tasks", needs="scene")
for option, value in (("--width", 64), ("--height", 64), ("--samples", 4), ("--render-device", 0)):
    for file in ("task", "scene"):
        row(f"serve {option} without pictures of a {file}", f"serve {file}.yaml --no-render {option} {value}", N, f"--no-render.*{option}", needs=file)
row("serve on a socket that is a file", SERVE + " --socket mine", N, "mine.*another file", write("mine", "x"), needs="task")
row("serve on a socket that a server left", SERVE + " --socket left", DONE, "serves", needs="task", shell="""
python3 -c 'import socket; socket.socket(socket.AF_UNIX).bind("left")'
$B serve task.yaml --no-render --socket left 2>err & process=$!
for i in $(seq 80); do grep -q serves err && break; sleep 0.1; done
kill -TERM $process; cat err; rm -f left err""", makes=["left", "err"])
row("serve on a socket in no folder", SERVE + " --socket nowhere/s", N, "nowhere", needs="task")
row("serve on a socket where nobody may", SERVE + " --socket /proc/s", N, "/proc", needs="task")
for option, number in (("--width", "1"), ("--height", "99999"), ("--samples", "0"), ("--fps", "nan"), ("--gripper", "wet"), ("--device", "moon"),
                       ("--fps", "7")):
    row(f"serve {option} {number}", f"serve task.yaml --no-render {option}={number}", N, rf"{option[2:]}.*{number}|{number}.*(step|devices)", needs="task")


def message(head):
    text = head if isinstance(head, bytes) else json.dumps(head).encode()
    return struct.pack("<II", len(text), 0) + text


CLOSE = message({"do": "close"})
TALK = "timeout 20 $B serve task.yaml --no-render <in.bin >out.bin; code=$?; tr -cd '[:print:]' <out.bin; exit $code"
for name, stream, code, pattern in (
        ("nothing", b"", DONE, "protocol"),
        ("half a length", b"\x05\x00", FAILED, "stream|request|ends|cut"),
        ("a head that is cut off", message({"do": "reset"})[:-3], FAILED, "stream|request|ends|cut"),
        ("a head of 4 GB", b"\xff" * 8, FAILED, "head|long|large|bytes"),
        ("words instead of JSON", message(b"hello") + CLOSE, DONE, "no JSON object"),
        ("a list", message([1]) + CLOSE, DONE, "no JSON object"),
        ("an unknown request", message({"do": "dance"}) + CLOSE, DONE, "dance"),
        ("a request without `do`", message({}) + CLOSE, DONE, "`do`"),
        ("a reset without a seed", message({"do": "reset"}) + CLOSE, DONE, "needs the key"),
        ("a reset with a seed of -1", message({"do": "reset", "seed": -1, "episode": 0}) + CLOSE, DONE, "whole number"),
        ("a reset with a seed in words", message({"do": "reset", "seed": "x", "episode": 0}) + CLOSE, DONE, "whole number"),
        ("a step before the reset", message({"do": "step", "action": [0]}) + CLOSE, DONE, "reset"),
        ("an action in words", message({"do": "step", "action": "left"}) + CLOSE, DONE, "list of numbers|reset"),
        ("an unknown key", message({"do": "close", "why": 1}) + CLOSE, DONE, "no key"),
        ("bytes", bytes(range(255, -1, -1)) * 4, FAILED, "head|long|large|bytes")):
    row(f"serve reads {name}", "serve", code, pattern, write("in.bin", stream), needs="task", shell=TALK, makes=["out.bin"], seconds=20)

SCENE_TALK = TALK.replace("task.yaml", "scene.yaml")
for name, head, pattern in (
        ("no steps", {"do": "step", "n": 0}, "whole number from 1"),
        ("steps without end", {"do": "step", "n": 1e300}, "whole number from 1"),
        ("targets without a drive", {"do": "step", "targets": [[1]]}, "joints with a drive, this one has 1"),
        ("memory on a disk", {"do": "state", "memory": "scene.yaml"}, "no file in memory"),
        ("an action", {"do": "step", "action": [0]}, "no key `action`")):
    row(f"serve of a scene reads {name}", "serve", DONE, pattern, write("in.bin", message(head) + CLOSE), needs="scene", shell=SCENE_TALK,
        makes=["out.bin"], seconds=20)

# ---- evaluate policy
row("a policy without its package", "evaluate policy task.yaml --policy blind", N, "install_policy.sh|PVG_PYTHON", needs="task",
    environment={"PVG_PYTHON": None, "PVG_DATA": None}, shell="B=$(readlink -f $B); unset PVG_PYTHON; [ -e " + str(REPOSITORY) +
    "/.venv-policy ] && { echo 'phyvisgen: install_policy.sh was run' >&2; exit 2; }; exec $B evaluate policy task.yaml --policy blind")
row("an interpreter that is not there", "evaluate policy task.yaml --policy blind", N, "/nowhere/python", needs="task",
    environment={"PVG_PYTHON": "/nowhere/python"})
row("an interpreter that fails", "evaluate policy task.yaml --policy blind", FAILED, "evaluate policy", needs="task",
    environment={"PVG_PYTHON": "/bin/false"})
for name, pattern, words in (("no header", "header is not", "a,0.5\n"), ("nan", "sim.csv:2:", "name,success\na,nan\n"),
                             ("an empty file", "two names", ""), ("one row", "sim.csv|two|rows|policies", "name,success\na,0.5\n")):
    row(f"correlated rates: {name}", "evaluate correlate sim.csv sim.csv --json", N, pattern, write("sim.csv", words))

# ---- diagnose SET --task: an episode set, ours, as a measurement of the task's robots
D = "diagnose set --task task.yaml"
row("a set without its task", "diagnose set --check", N, "set", needs="set")
row("a set whose task is not there", "diagnose set --task none.yaml --check", N, "none.yaml", needs="set")
row("a set whose task is a scene", "diagnose set --task scene.yaml --check", N, "scene.yaml|robot", needs="set scene")
row("a set that is not there", "diagnose nowhere --task task.yaml --check", N, "nowhere", needs="task")
row("a set without episodes", D + " --check", N, "set", remove("set/episode_000000"), remove("set/episode_000001"), needs="set task")
row("a set that is empty", "diagnose empty --task task.yaml --check", N, "empty", lambda f: (f / "empty").mkdir(), needs="task")
row("the report into the set", D + " -o set", N, "set", needs="set task")
row("the report onto the task", D + " -o task.yaml", N, "task.yaml", needs="set task")
STATES = "set/episode_000000/states.h5"
for name, step in (("cut off", cut(STATES, 0.5)), ("empty", write(STATES)), ("bytes", write(STATES, bytes(range(256)) * 20)),
                   ("no joint positions", states(STATES, drop("/q"))), ("a nan position", states(STATES, poke("/q", (3, 2), float("nan")))),
                   ("no times", states(STATES, drop("/time"))),
                   ("positions of two joints", states(STATES, put("/q", [[0.0, 0.0]] * 5))),
                   ("actions of another length", states(STATES, put("/a", [[0.0] * 9] * 3)))):
    row(f"a measured episode: {name}", D + " --check", N, "states.h5", step, needs="set task")
row("a measured episode: times that do not ascend", D + " --check", N, "episode_000000 do not ascend at row 4", states(STATES, poke("/time", 4, 0.0)),
    needs="set task")
row("a measured episode of another robot", D + " --check", N, "task.yaml|states.h5|joint", needs="set robot",
    shell=f"sed -i 's/fr3_joint1/other_joint1/g' arm.urdf; exec $B {D} --check", changes=["arm.urdf"])
for name, text in (("no info.json", None), ("bytes", bytes(range(256))), ("an empty mapping", b"{}"), ("a format of the future", b'{"codebase_version": "v9.0"}'),
                   ("a list", b"[]"), ("features in words", b'{"codebase_version": "v3.0", "fps": 10, "features": "all"}'),
                   ("no rate", b'{"codebase_version": "v3.0", "features": {}}'), ("a rate of zero", b'{"codebase_version": "v3.0", "fps": 0, "features": {}}')):
    row(f"a LeRobot set: {name}", "diagnose lerobot --task task.yaml --check", N, "lerobot", lambda f: (f / "lerobot/data").mkdir(parents=True),
        *([write("lerobot/meta/info.json", text)] if text is not None else []), needs="task")

# ---- record, and what stands beside it
for text, pattern in (("record: {states: some}", "record.states.*full"), ("record: {states: }", "record.states"), ("record: full", "record"), ("record: []", "record"),
                      ("record: {frames: all}", "record.frames"), ("record: {states: full, states: frames}", "states"), ("recrod: {states: full}", "recrod")):
    row(f"a task with `{text}`", "generate task.yaml -o o", N, rf"task.yaml:\d+:.*({pattern})", lambda f, t=text: (f / "task.yaml").open("a").write(t + "\n") and None,
        needs="task")
