"""Recordings for diagnose, pictures for calibrate, tables, and the machine around the program."""
import fixtures
from table import DONE, FAILED, TRY_AGAIN, WRONG_USE, append, copy, cut, edit, link, make_folder, put, remove, rename, row, states, write

N = WRONG_USE
CHECK = "diagnose rec --check"
YAML, RUN = "rec/recording.yaml", "rec/run_0.csv"


def table(change, file=RUN):
    """Changes a CSV's rows, lists of texts, the first one the header."""

    def step(folder):
        rows = [line.split(",") for line in (folder / file).read_text().splitlines()]
        (folder / file).write_text("\n".join(",".join(r) for r in change(rows)) + "\n")

    return step


def scaled(column, factor):
    return lambda rows: [rows[0]] + [[repr(float(c) * factor) if i == column and c else c for i, c in enumerate(r)] for r in rows[1:]]


ALL_RUNS = [f"rec/run_{i}.csv" for i in range(4)]

# ---- recording.yaml
for name, *steps in (("none", remove(YAML)), ("empty", write(YAML)), ("words", write(YAML, "hello")), ("bytes", write(YAML, bytes(range(256)))), ("cut off", cut(YAML, 0.6)),
                     ("a folder", remove(YAML), make_folder(YAML))):
    row(f"recording.yaml: {name}", CHECK, N, "recording.yaml", *steps, needs="rec")
for old, new, key in (
        ("schema: 1", "schema: 2", "schema"), ("schema: 1\n", "", "schema"), ("scene: scene.yaml", "scene: none.yaml", "none.yaml"), ("scene: scene.yaml", "scene: .", "scene"),
        ("scene: scene.yaml", "scene: recording.yaml", "recording.yaml"), ("scene: scene.yaml", "scene: run_0.csv", "run_0"), ("scene: scene.yaml\n", "", "scene"),
        ("file: run_0.csv", "file: none.csv", "none.csv"), ("file: run_0.csv", "file: ../../../../etc/passwd", "passwd"), ("role: fit", "role: maybe", "role.*maybe"),
        ("role: fit", "rolle: fit", "role"), ("channels:", "chanels:", "chan"), ("column: q,", "column: nope,", "nope"), ("column: q,", "columns: [q, q],", "column"),
        ("column: q,", "", "column"), ("kind: position", "kind: smell", "smell"), ("joint: hinge", "joint: knee", "knee"), ("joint: hinge", "body: moon", "moon|columns"),
        ("joint: hinge, ", "", "joint|body"), ("joint: hinge", "joint: hinge, body: cube", "joint.*body"), ("unit: rad", "unit: m", "unit|`m`"), ("unit: rad", "unit: furlong", "furlong"),
        ("noise: 0.001", "noise: -1", "noise"), ("noise: 0.001", "noise: 0", "noise"), ("noise: 0.001", "noise: nan", "noise"), ("noise: 0.001", "noise: loud", "noise"),
        ("noise: 0.001", "noise: 0.001, colour: red", "colour"), ("initial: first_sample", "initial: guess", "initial|guess"),
        ("initial: first_sample", "initial: {joint/knee/position: 1}", "knee"), ("initial: first_sample", "initial: {joint/hinge/taste: 1}", "taste"),
        ("initial: first_sample", "initial: {joint/hinge/position: .nan}", "hinge"), ("initial: first_sample", "initial: {a: {b: c}}", "initial"),
        ("initial: first_sample", "initial: []", "initial"), ("runs:", "runs: []\nxruns:", "run"), ("runs:", "runs: 7\nxruns:", "runs"), ("channels:", "channels: []\nxchannels:", "chan"),
        ("channels:", "inputs: [{column: q, target: joint/hinge/position, unit: rad}]\nchannels:", "hinge|driv"), ("channels:", "inputs: [{column: q, target: nonsense}]\nchannels:", "nonsense"),
        ("channels:\n", "channels:\n  - {file: m.h5, kind: mask, camera: front, part: cube}\n", "m.h5"), ("channels:\n", "channels:\n  - {file: m.mp4, kind: video, camera: front}\n", "m.mp4|front"),
        ("kind: position, joint: hinge", "kind: marker, body: cube", "point|vertex|columns"), ("kind: position", "kind: position, vertex: 3", "vertex")):
    row(f"recording.yaml: {new!r} instead of {old!r}", CHECK, N, rf"(rec|yaml|csv).*({key})", edit(YAML, old, new), needs="rec")
row("every run held out", "diagnose rec -o r", N, "recording.yaml.*held out.*fit", edit(YAML, "role: fit", "role: held_out", 9), needs="rec", notes=9)
row("the same run twice to fit", CHECK, N, "run_0.csv.*(twice|same)", edit(YAML, "run_1.csv", "run_0.csv"), needs="rec")
row("a run that is fitted and held out", CHECK, N, "run_0.csv.*held", edit(YAML, "run_3.csv", "run_0.csv"), needs="rec")
row("a held-out run that is a copy of a fitted one", CHECK, N, "run_0.csv.*run_3.csv.*same.*proves nothing", remove("rec/run_3.csv"),
    copy(RUN, "rec/run_3.csv"), needs="rec")
row("a recording that is not there", "diagnose nowhere --check", N, "nowhere")
row("an empty suite", "diagnose --suite empty -o r", N, "empty", make_folder("empty"))
row("a suite that is not there", "diagnose --suite nowhere -o r", N, "nowhere")
row("a suite without an output", "diagnose --suite empty", N, "-o|empty", make_folder("empty"))

# ---- tables
for name, step, pattern in (
        ("empty", write(RUN), "run_0.csv"), ("a header alone", table(lambda r: r[:1]), "run_0.csv.*rows"), ("four rows", table(lambda r: r[:5]), "run_0.csv.*rows"),
        ("bytes", write(RUN, bytes(range(256)) * 40), "run_0.csv"), ("no column t", table(lambda r: [["s"] + r[0][1:]] + r[1:]), "run_0.csv.*`t`"),
        ("a column twice", table(lambda r: [["t", "t"]] + r[1:]), "run_0.csv.*twice"), ("a row with a cell too many", table(lambda r: r[:5] + [r[5] + ["1"]] + r[6:]), "run_0.csv.*line 6"),
        ("a word in a cell", table(lambda r: r[:5] + [[r[5][0], "abc"]] + r[6:]), "run_0.csv.*line 6.*abc"), ("a decimal comma", edit(RUN, ".", ","), "run_0.csv.*line 2"),
        ("semicolons", lambda f: (f / RUN).write_text((f / RUN).read_text().replace(",", ";")), "run_0.csv.*(;|semicolon|`t`)"), ("time that goes back", table(lambda r: r[:5] + [r[4]] + r[5:]), "run_0.csv.*time"),
        ("time that stands still", table(lambda r: r[:1] + [["1.0"] + x[1:] for x in r[1:]]), "run_0.csv.*time"), ("a time of nan", table(lambda r: r[:5] + [["nan", r[5][1]]] + r[6:]), "run_0.csv.*time"),
        ("a time of inf", table(lambda r: r[:-1] + [["inf", r[-1][1]]]), "run_0.csv.*line.*inf"), ("no number in a column", table(lambda r: r[:1] + [[x[0], ""] for x in r[1:]]), "run_0.csv|no number"),
        ("a value of 1e300", table(lambda r: r[:5] + [[r[5][0], "1e300"]] + r[6:]), "run_0.csv|large"), ("a value of inf", table(lambda r: r[:5] + [[r[5][0], "inf"]] + r[6:]), "run_0.csv.*line 6")):
    for_all = name == "no number in a column"
    steps = [step] if not for_all else [table(lambda r: r[:1] + [[x[0], ""] for x in r[1:]], f) for f in ALL_RUNS]
    row(f"a run: {name}", CHECK, N, pattern, *steps, needs="rec")
row("nothing that moves", CHECK, N, "constant|motion", *[table(lambda r, i=i: r[:1] + [[x[0], f"0.{i + 1}"] for x in r[1:]], f) for i, f in enumerate(ALL_RUNS)], needs="rec")
row("time in milliseconds", CHECK, DONE, r"run_0.csv.*milliseconds.*1000", *[table(scaled(0, 1000), f) for f in ALL_RUNS], needs="rec")
row("angles in degrees", CHECK, DONE, r"degrees.*57\.3", *[table(scaled(1, 57.29577951), f) for f in ALL_RUNS], needs="rec")
row("a byte-order mark", CHECK, DONE, "4 runs", *[lambda f, n=n: (f / n).write_bytes(b"\xef\xbb\xbf" + (f / n).read_bytes()) for n in ALL_RUNS], needs="rec")
row("line ends of another system", CHECK, DONE, "4 runs", *[lambda f, n=n: (f / n).write_bytes((f / n).read_bytes().replace(b"\n", b"\r\n")) for n in ALL_RUNS], needs="rec")
row("a run as HDF5 with columns of two lengths", CHECK, N, "run_0.h5.*numbers", edit(YAML, "run_0.csv", "run_0.h5"),
    lambda f: _h5(f / "rec/run_0.h5", t=[1.0, 2.0], q=[1.0]), needs="rec")
row("a run as HDF5 with a matrix", CHECK, N, "run_0.h5.*list", edit(YAML, "run_0.csv", "run_0.h5"), lambda f: _h5(f / "rec/run_0.h5", t=[[1.0, 2.0]]), needs="rec")
row("a run as HDF5 with texts", CHECK, N, "run_0.h5", edit(YAML, "run_0.csv", "run_0.h5"), lambda f: _h5(f / "rec/run_0.h5", t=[b"a", b"b"]), needs="rec")
row("a run as HDF5 of words", CHECK, N, "run_0.h5", edit(YAML, "run_0.csv", "run_0.h5"), write("rec/run_0.h5", "hello"), needs="rec")


def _h5(file, **columns):
    import h5py

    with h5py.File(file, "w") as out:
        for name, values in columns.items():
            out[name] = values


# ---- pictures for the table of colours
LUT = "calibrate lut --render rendered --real real -o l.csv"
for name, *steps in (("no folder", remove("real")), ("a file instead of a folder", remove("real"), write("real", "x")), ("an empty folder", remove("real"), make_folder("real")),
                     ("other names", rename("real/front_0.png", "real/a.png"), rename("real/front_1.png", "real/b.png")), ("an empty picture", write("real/front_0.png")),
                     ("words", write("real/front_0.png", "hello")), ("half a picture", cut("real/front_0.png", 0.5)), ("a folder as a picture", remove("real/front_0.png"), make_folder("real/front_0.png")),
                     ("another size", write("real/front_0.png", fixtures.png(8, 8, (1, 2, 3)))), ("a picture of 2^31 pixels", write("real/front_0.png", b"\x89PNG\r\n\x1a\n" + fixtures.struct.pack(
                         ">I4sIIBBBBB", 13, b"IHDR", 2**31 - 1, 2**31 - 1, 8, 2, 0, 0, 0) + b"\0" * 40)),
                     ("a JPEG of words", rename("real/front_0.png", "real/front_0.jpg"), write("real/front_0.jpg", "hello"))):
    row(f"real pictures: {name}", LUT, N, "real", *steps, needs="pictures")
row("real pictures: all black", LUT, N, "real|black|pixel", *[write(f"real/front_{i}.png", fixtures.png(64, 64, (0, 0, 0))) for i in range(2)], needs="pictures")
for name, content in (("empty", ""), ("words", "hello\n"), ("three rows", "r,g,b\n0,0,0\n1,1,1\n"), ("NaN", "r,g,b\n" + "nan,0,0\n" * 256), ("falling", "r,g,b\n" + "".join(f"{1 - i / 255},0,0\n" for i in range(256)))):
    row(f"a table of colours: {name}", "render shown.yaml -o p.png --lut l.csv", N, "l.csv", write("l.csv", content), needs="shown")
row("a table of colours that is not there", "render shown.yaml -o p.png --lut none.csv", N, "none.csv", needs="shown")
for name, content in (("words", "hello"), ("empty", ""), ("half", fixtures.png(32, 32, (1, 2, 3))[:40])):
    row(f"a texture: {name}", "render shown.yaml -o p.png", N, "skin.png", edit("shown.yaml", "color: [0.5, 0.5, 0.5]}", "texture: skin.png}"), write("skin.png", content), needs="shown")

# ---- the machine around it
row("no HOME that can be written", "simulate scene.yaml -o s.h5", DONE, "s.h5", needs="scene", environment={"HOME": "/proc/nowhere", "POCL_CACHE_DIR": None, "XDG_CACHE_HOME": None},
    makes=["s.h5"], seconds=60)
row("no HOME at all", "devices", DONE, "GiB", environment={"HOME": None, "POCL_CACHE_DIR": None, "XDG_CACHE_HOME": None}, seconds=60)
row("no device", "simulate scene.yaml -o s.h5", N, "OpenCL", needs="scene", environment={"OCL_ICD_VENDORS": "/nowhere"})
row("no tetgen", "generate task.yaml -o o --no-render", FAILED, "tetgen.*PATH", needs="task", environment={"PATH": "/nowhere"}, makes=["o"])
row("no ffmpeg", "generate task.yaml -o o", N, "ffmpeg", needs="task", environment={"PATH": "/nowhere"})
row("no place for temporary files", "simulate shown.yaml -o s.h5 --duration 0.01", DONE, "s.h5", needs="shown", environment={"TMPDIR": "/nowhere"}, makes=["s.h5"])
row("a folder of work that is gone", "status set", N, "set", shell="mkdir x && cd x && rmdir ../x && exec $B status set")
row("standard output closed", "devices", DONE, "", shell="exec $B devices >&-")
for name in ("HUP", "TERM", "INT", "USR1"):
    row(f"SIG{name} while it works", "simulate scene.yaml -o s.h5 --duration 1000", TRY_AGAIN, "stopped", needs="scene", shell=f"""
$B simulate scene.yaml -o s.h5 --duration 1000 & process=$!
for i in $(seq 80); do ls -A | grep -q partial && break; sleep 0.1; done; sleep 0.3
kill -{name} $process; wait $process""")
row("SIGTERM while kernels are compiled", "simulate scene.yaml -o s.h5", TRY_AGAIN, "stopped", needs="scene", environment={"POCL_CACHE_DIR": "cache"}, makes=["cache"], shell="""
mkdir cache; $B simulate scene.yaml -o s.h5 --duration 1000 & process=$!
sleep 1.5; start=$(date +%s%N); kill -TERM $process; wait $process; code=$?
took=$((($(date +%s%N) - start) / 1000000)); [ $took -le 2000 ] || echo "took $took ms" >&2; rm -rf cache
[ $took -le 2000 ] && exit $code""", seconds=60)
row("two containers that fill one folder", "generate task.yaml -n 2 --seed 3 -o ns", DONE, "all complete", needs="task", makes=["ns"], seconds=90, shell="""
for i in 1 2; do unshare --pid --fork --mount-proc bash -c 'exec $B generate task.yaml -n 2 --seed 3 -o ns --no-render' >log$i 2>&1 & eval p$i=$!; done
wait $p1; a=$?; wait $p2; b=$?; cat log1 log2; rm log1 log2
[ $a = 0 ] && [ $b = 0 ] && [ -f ns/episode_000000/summary.json ] && [ -f ns/episode_000001/summary.json ] && [ $(ls -A ns | wc -l) = 3 ] && echo all complete""")
