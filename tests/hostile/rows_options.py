"""Options and numbers of the command line."""
from table import DONE, FAILED, WRONG_USE, make_folder, row, set_json, write

N = WRONG_USE

# ---- what is no number, or none that makes sense: the sentence names the option and repeats what was given
NUMBERS = {
    "whole": ["nan", "inf", "-1", "1e99", "", "0x10", "1.5", "99999999999999999999", "7 "],
    "real": ["nan", "inf", "-inf", "-1", "1e999", "", "0x10", "1,5"],
}
OPTIONS = [
    # command, option, kind
    ("generate task.yaml -o o", "-n", "whole"),
    ("generate task.yaml -o o", "--seed", "whole"),
    ("generate task.yaml -o o", "--samples", "whole"),
    ("generate task.yaml -o o", "--fps", "real"),
    ("generate task.yaml -o o", "--frames-under-way", "whole"),
    ("submit task.yaml -o o", "-n", "whole"),
    ("submit task.yaml -n 2 -o o", "--shards", "whole"),
    ("submit task.yaml -n 2 -o o", "--at-once", "whole"),
    ("simulate scene.yaml -o s.h5", "--duration", "real"),
    ("simulate scene.yaml -o s.h5", "--checkpoint-every", "real"),
    ("render shown.yaml -o p.png", "--fps", "real"),
    ("render shown.yaml -o p.png", "--seed", "whole"),
    ("diagnose rec -o r", "--minutes", "real"),
    ("evaluate set", "--every", "whole"),
    ("view set -o v.html", "-n", "whole"),
]
FIXTURE = {"task.yaml": "task", "scene.yaml": "scene", "shown.yaml": "shown", "rec": "rec", "set": "set"}
for command, option, kind in OPTIONS:
    for number in NUMBERS[kind]:
        shown = number.strip() or "empty|missing|``"
        row(f"the number `{number}` for {option}", f"{command} {option}='{number}'" if option.startswith("--")
            else f"{command} {option} '{number}'", N, rf"{'episodes' if option == '-n' else option}.*({shown})",
            needs=FIXTURE[command.split()[1]])
for option, number in (("--width", "1"), ("--width", "16385"), ("--height", "0"), ("--height", "wide"),
                       ("--max-depth", "0"), ("--max-depth", "1001"), ("--samples", "65537"), ("--samples", "0")):
    row(f"{option} out of its range", f"render shown.yaml -o p.png {option} {number}", N, rf"{option}.*{number}",
        needs="shown")
for command, option, number, low, high in (
        ("generate task.yaml -o o", "--seed", 2**64, 0, 2**64 - 1), ("generate task.yaml -o o", "--seed", 2**63, 0, 2**63 - 1),
        ("submit task.yaml -n 2 -o o", "--seed", 2**63, 0, 2**63 - 1), ("generate task.yaml -o o", "--samples", 2**64, 1, 2**20),
        ("generate task.yaml -o o", "--frames-under-way", 2**64, 1, 64), ("generate task.yaml -o o", "--fps", "1e400", 0.01, 1000),
        ("render shown.yaml -o p.png", "--max-depth", 5000, 1, 1000), ("bench physics", "--repeats", 0, 1, 1000)):
    row(f"{option} {number} is told its range", f"{command} {option} {number}", N, rf"{option} .*\b{low} to {high}\b",
        needs=FIXTURE.get(command.split()[1], ""))
for number in ("0", "1001", "some"):
    row("repeats out of their range", f"bench physics --repeats {number}", N, rf"--repeats.*{number}")
    row("repeats out of their range", f"bench render --repeats {number}", N, rf"--repeats.*{number}")
    row("repeats out of their range", f"bench solver --repeats {number}", N, rf"--repeats.*{number}")
for option, number in (("--max-effects", "0"), ("--max-effects", "5"), ("--jobs", "0"), ("--jobs", "65"),
                       ("--minutes", "10001")):
    row(f"{option} out of its range", f"diagnose rec -o r {option} {number}", N, rf"{option}.*{number}", needs="rec")
row("more episodes than a thousand million", "generate task.yaml -o o -n 1000000001", N, "episodes.*1000000001", needs="task")
row("no episode", "generate task.yaml -o o -n 0", N, "-n|--episodes", needs="task")
for option, value in (("--width", 64), ("--height", 64), ("--samples", 4), ("--render-device", 0)):
    row(f"{option} without pictures", f"generate task.yaml -o o --no-render {option} {value}", N, f"--no-render.*{option}", needs="task")
row("a rate of zero", "generate task.yaml -o o --fps 0", N, "--fps.*0", needs="task")
row("a rate that fits no step", "generate task.yaml -o o --fps 7", N, r"7.*step|frames per second", needs="task")
row("animation pictures out of range", "simulate scene.yaml -o s.h5 --animation a.glb --pictures-per-second 0", N,
    "--pictures-per-second", needs="scene")
row("a duration below half a step", "simulate scene.yaml -o s.h5 --duration 0.001", N, "duration.*step", needs="scene")
row("a duration of more steps than a run can have", "simulate scene.yaml -o s.h5 --duration 1e15", N, "--duration.*1e15|--duration.*1e\\+15",
    needs="scene")
for shard in ("0/18446744073709551615", "1/1", "2/1", "-1/2", "0/0", "a/b", "0", "1/", "/2", "0/2/3", "0x0/2", "", "1 / 2",
              "0/99999999999999999999"):
    row(f"the shard `{shard}`", f"generate task.yaml -o o --shard='{shard}'", N, r"--shard.*(i/n|missing)", needs="task")
for frames in ("5:2", "0:99999", "a:b", "-1", "1:", ":0", "0:1:2", "99999999999999999999"):
    row(f"the frames `{frames}`", f"render shown.yaml -o p --frames='{frames}'", N, r"--frames", needs="shown")

row("a rate without a motion", "render shown.yaml -o p.png --fps 10", N, "--fps is for a motion.*--states", needs="shown")
row("through glass without ground truth", "render shown.yaml -o p.png --through-glass", N, "--through-glass.*--ground-truth", needs="shown")
row("frames of a scene without states", "render shown.yaml -o p.png --frames 5:6", N, "--frames 5:6: shown.yaml without --states has the frame 0 alone", needs="shown")

# ---- names that are none
row("no command", "", N, "needs a command|subcommand.*required|--help")
row("an unknown command", "foo", N, r"`?foo`?")
for typo, command in (("generat", "generate"), ("Generate", "generate"), ("simulat", "simulate"), ("rendr", "render"),
                      ("diagnosis", "diagnose"), ("veiw", "view"), ("statsu", "status"), ("device", "devices")):
    row("a command with a slip", typo, N, rf"{typo}.*{command}")
row("an unknown command of bench", "bench phisics", N, r"phisics.*physics")
row("bench without what to measure", "bench", N, "physics|subcommand")
row("calibrate without what to fit", "calibrate", N, "lut|subcommand")
row("an unknown command of evaluate", "evaluate polcy", N, r"evaluate polcy.*did you mean `evaluate policy`")
row("an unknown command of evaluate with words of its own", "evaluate corelate sim.csv real.csv", N, r"evaluate corelate.*evaluate correlate")
row("a set whose name is near no command", "evaluate nowhere", N, r"nowhere is no folder")
row("a set whose name is near a command", "evaluate polici", N, r"polici holds no episodes", make_folder("polici"))
row("an unknown command of calibrate", "calibrate table", N, "table.*lut|lut")
for command in ("generate", "simulate", "render", "pack", "merge", "status", "submit", "evaluate", "validate", "diagnose",
                "view", "devices", "bench physics", "bench solver", "bench render", "calibrate lut"):
    row("an unknown option", f"{command} --no-such-option", N, "--no-such-option")
for command, nearest in (("generate task.yaml -o o --episode 3", "--episodes"), ("render shown.yaml -o p.png --sample=4", "--samples"),
                         ("bench physics --repeat 2", "--repeats")):
    row("an option with a slip", command, N, f"no option --.*{nearest}")
for command, flag in (("devices --json=3", "--json"), ("evaluate set --json=true", "--json"), ("generate task.yaml -o o --no-render=no", "--no-render"),
                      ("bench physics --list=all", "--list"),
                      ("--version=2", "--version"), ("status set --json=", "--json")):
    row("a flag with a value", command, N, f"{flag}.*takes no value")
row("a word too many", "generate a.yaml b.yaml -o o", N, "`b.yaml`.*too many")
for worlds in ("many", "0", "-1", "1025"):
    row(f"the worlds `{worlds}`", f"generate task.yaml -o o --worlds={worlds}", N, f"--worlds {worlds}", needs="task")
row("a video of an odd width", "generate task.yaml -o o --width 63", N, "front.*--width.*even.*63", needs="task")
row("a rendered video of an odd height", "render shown.yaml -o v.mp4 --height 31", N, "-o v.mp4, camera front.*even.*31", needs="shown")
for command, what in (("generate", "task file"), ("simulate", "scene file"), ("render", "scene"), ("pack", "DIR|set|folder"),
                      ("merge", "folders"), ("status", "folder|DIR"), ("submit", "task file"), ("evaluate", "folder|SET"),
                      ("view", "folder|DIR"), ("diagnose", "recording"), ("calibrate lut", "--render")):
    row("nothing to work on", command, N, what)
for command, need in (("generate task.yaml", "task"), ("simulate scene.yaml", "scene"), ("render shown.yaml", "shown"),
                      ("pack set", "set"), ("merge set", "set"), ("submit task.yaml -n 2", "task"), ("view set", "set"),
                      ("diagnose rec", "rec")):
    row("no output", command, N, "-o", needs=need)
row("an option without its value", "generate task.yaml -o", N, "-o", needs="task")
row("an option twice", "generate task.yaml -o a -o b", N, "-o", needs="task")
row("two task files", "generate task.yaml task.yaml -o o", N, "task.yaml", needs="task")
row("an unknown gripper", "generate task.yaml -o o --gripper wet", N, "--gripper.*wet.*soft", needs="task")
row("an unknown format", "pack set -o p --format tar", N, "--format.*tar.*lerobot", needs="set")
row("an unknown way to decide", "diagnose rec -o r --decide guess", N, "--decide.*guess.*workflow", needs="rec")
row("an unknown preconditioner", "bench physics --preconditioner magic", N, "--preconditioner.*magic.*factor")
row("an unknown scene of bench", "bench physics --scene moon", N, "moon")
row("an unknown scene of bench", "bench solver --scene moon", N, "moon")
row("an unknown scene of bench", "bench render --scene moon", N, "moon")
row("an unknown case", "validate --case moon", N, "moon")
row("an unknown case beside a known one", "validate --case slope --case moon", N, "moon")
row("cases in a folder that is not there", "validate --case slope --scenes nowhere", N, "nowhere")
for device in ("9", "-1", "H100 of my dreams", "99999999999999999999"):
    row(f"the device `{device}`", f"simulate scene.yaml -o s.h5 --device='{device}'", N, r"device.*`phyvisgen devices`|device.*devices",
        needs="scene")
    row(f"the device `{device}`", f"render shown.yaml -o p.png --device='{device}'", N, r"device.*devices", needs="shown")
row("an unknown rendering device", "generate task.yaml -o o --render-device 7", N, "--render-device 7.*devices", needs="task")
row("an unknown camera", "render shown.yaml -o p.png --camera back", N, "back.*front", needs="shown")
row("an unknown camera of a set", "pack set -o p --camera back", N, "back", needs="set")
for command, need in (("pack set -o p", "set"), ("generate task.yaml -n 1 -o o", "task")):
    row(f"the same camera twice: {command}", command + " --camera front --camera front", N, "--camera front .*twice", needs=need)
row("a page of a states file", "view st.h5 -o v.html", N, "st.h5 is no JSON file.*view takes .*evaluate policy --json.*folder of a set or of an episode",
    needs="recorded")
row("a table between equal pictures", "calibrate lut --render rendered --real rendered -o lut.csv", DONE, "^(?!.*PSNR inf).*equal colours",
    needs="pictures", makes=["lut.csv"])
row("a task given to simulate", "simulate task.yaml -o s.h5", N, r"task.yaml:\d+: `motion` is a key of tasks.*phyvisgen generate", needs="task")
row("a scene given to generate", "generate scene.yaml -n 1 -o o", N, r"scene.yaml:\d+: `bodies` is a key of scenes.*phyvisgen simulate", needs="scene")
row("a scene of objects given to generate", "generate shown.yaml -n 1 -o o", N, r"shown.yaml:\d+: .*neither `robot`.*phyvisgen simulate", needs="shown")
row("the same camera twice", "render shown.yaml -o p.png --camera front --camera front", N, "front.*(twice|two|2)", needs="shown")
row("more shards than episodes", "submit task.yaml -n 2 --shards 3 -o o", N, "shards", needs="task")
row("an option for generate that it does not know", "submit task.yaml -n 2 -o o --generate=--moon", N, "--moon", needs="task")
row("an option for generate that submit gives", "submit task.yaml -n 2 -o o --generate=--shard=0/2", N, "--shard",
    needs="task")
row("a line for Slurm with a line break", "submit task.yaml -n 2 -o o --sbatch=$'--a\\nrm'", N, "--sbatch", needs="task",
    shell="exec $B submit task.yaml -n 2 -o o --sbatch=$'--a\\nrm -rf x'")
row("submit without Slurm", "submit --run", N, "sbatch.*PATH", needs="task",
    shell="PATH=/nowhere exec $B submit task.yaml -n 2 -o o --run", makes=["o"])

# ---- what is asked for and is right
row("help", "--help", DONE, "generate")
row("version", "--version", DONE, r"\d")
row("the list of effects", "diagnose --list-effects", DONE, "friction")
row("the devices", "devices", DONE, "GiB")
row("the devices as JSON", "devices --json", DONE, '"memory_bytes"')
row("the devices: no more memory than the machine has", "devices", DONE, "all well", shell=r"""
have=$(awk '/MemTotal/ {print $2 * 1024}' /proc/meminfo)
$B devices --json | tr -d ' ,"' | awk -F: -v have=$have '/^kind:cpu/ {cpu=1} /^memory_bytes/ && cpu {if ($2 > have * 1.01 || $2 < have * 0.05) bad=1; cpu=0} END {print bad ? "wrong" : "all well"}'""")

row("one step in the singular", "simulate scene.yaml -o s.h5 --duration 0.01", DONE, ": 1 step, ", needs="scene", makes=["s.h5"])
row("one episode in the singular", "status set", DONE, "1 episode asked for", set_json("set/set.json", episodes=1), needs="set")

# ---- serve and evaluate
row("serve without a task", "serve", N, "needs a task or scene file")
row("a socket whose path is too long", f"serve task.yaml --no-render --socket {'s' * 200}", N, "longer than the 107 bytes",
    needs="task")
row("a seed that belongs to evaluation", "generate task.yaml --seed 9223372036854775808 -o o", N, "belongs to evaluation",
    needs="task")
row("poses of objects in a format that has none", "pack set --format act --environment-state -o p", N,
    "--format lerobot", needs="set")
row("an instruction in a format that has none", "pack set --format act --instruction lift -o p", N, "--instruction.*--format lerobot", needs="set")
row("rates that are a folder", "evaluate correlate set set", N, "set cannot be read; name a CSV file", needs="set")
for name, text, pattern in (("no header", "a,0.5\n", "header is not"), ("a rate above 1", "name,success\na,2\n", "sim.csv:2:"),
                            ("a name twice", "name,success\na,0.1\na,0.2\n", "sim.csv:3:.*line 2"),
                            ("a row without comma", "name,success\na\n", "sim.csv:2:")):
    row(f"rates with {name}", "evaluate correlate sim.csv sim.csv", N, pattern, write("sim.csv", text))
row("rates that do not exist", "evaluate correlate none.csv none.csv", N, "none.csv cannot be read")
