#!/usr/bin/env python3
"""Runs every block of commands in the README and the guide as it stands; the first one that fails is printed.

    tests/documentation/run_commands.py [--all | --list] SOURCE PROGRAM [PAGE ...]     PAGE: such as docs/guide/tasks.md; all without

The blocks of a page run one after the other in a folder that looks like the checkout after scripts/demo.sh: build/bin
holds PROGRAM, out/demo an episode, and what commands write stays in that folder. Blocks of `sh` run whole but for the
commands of SLOW, which --all (scripts/test_documentation.sh) runs too; blocks of `python` where Python has h5py; commands
of other blocks, whose prompt is `console`, are those of ELSEWHERE. --list runs nothing: it checks that every block is of
one of these three kinds and that ELSEWHERE has a reason for every command of `console`.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

BEFORE = r"scripts/demo\.sh"  # what this folder looks like; scripts/test_documentation.sh runs it
SLOW = {  # what only --all runs, and why
    r"scripts/install_pack\.sh": "fetches pyarrow from PyPI",
    r".*\bpack\b.*--format lerobot.*": "needs what scripts/install_pack.sh fetches",
}
ELSEWHERE = {  # what a block of `console` shows and why no test of one machine runs it
    r".* --device 0 --render-device 1 .*": "needs two GPUs",
    r"apt-get install .*": "changes the machine",
    r".* capture room kitchen.glb .*": "reads a mesh of one's own; RoomMesh.* read meshes that are written there",
    r".* capture room scans/kitchen .*": "reads a scan of one's own; scripts/demo_capture.sh captures a synthetic one",
    r".* capture object (pot_and_lid\.glb --parts|sponge\.stl .*--soft) .*": "reads meshes of one's own; ObjectParts.*, SoftObject.*",
    r".* capture object (scan\.stl|scans/can|point_cloud/.*\.ply) .*": "reads scans of one's own; scripts/demo_capture_object.sh",
    r".* capture object --revolve glass\.csv .*": "reads a profile of one's own",
    r".* capture object --masks scans/glass .*": "reads masks of one's own",
    r".* calibrate (camera|pose) .*": "reads photos of one's own, needs scripts/install_calibration.sh",
    r"scripts/install_denoiser\.sh": "fetches 60 MB from PyPI; scripts/demo.sh runs it",
    r".* render data/tasks/weigh_beaker\.yaml .* --denoise .*": "needs the denoiser of the command above it",
    r".* evaluate fidelity .*": "compares pictures of a real camera",
    r"scripts/(install_logs\.sh|convert_log\.py run_0\.mcap .*)": "reads logs of one's own; tests/scripts/convert_log_test.py writes some",
    r"scripts/hidden_suite/make_cases\.py .*": "needs the packages above it; minutes",
    r".* diagnose --suite out/cases .*": "reads what the command above it makes",
    r".* calibrate lut --render rendered --real photos .*": "needs photos of one's own",
    r".* render SCENE --lut lut\.csv .*": "needs the table of the command above it",
    r"lerobot-train .*": "needs lerobot, several GB; scripts/check_lerobot.sh trains",
    r"lerobot-eval .*": "needs lerobot and a checkpoint; scripts/test_policy.sh has both",
    r"pip install pipeline/python|export PHYVISGEN_PROGRAM=.*": "changes the user's Python; scripts/test_python.sh",
    r"scripts/install_(lerobot|policy)\.sh|(\w+=\S+ +)*scripts/train_and_evaluate\.sh .*": "several GB, hours of training",
    r".* evaluate policy .*": "needs a server of policies; scripts/test_python.sh has one",
    r".* view out/evaluation\.json .*": "reads what `evaluate policy` writes; scripts/test_view.sh has an evaluation",
    r".* evaluate correlate simulated\.csv real\.csv": "reads tables of one's own",
}
PYTHON = "/usr/bin/python3"  # Debian's
BLOCK = re.compile(r"^```(sh|python|console)\n(.*?)^```", re.M | re.S)
FENCE = re.compile(r"^ *```(\w*)\n.*?^ *```", re.M | re.S)
NOT_HERE = {"", "yaml", "cpp", "py"}  # scripts/test_python.sh runs blocks of py, tests/headers.cpp is like that of cpp


def make_checkout(source, program, folder):
    """links to the sources; data/tasks, where commands write, is a copy whose cameras have few pixels, for time's sake"""
    for entry in source.iterdir():
        if entry.name not in ("build", "out", "data", ".git") and not entry.name.startswith("build"):
            (folder / entry.name).symlink_to(entry)
    (folder / "data").mkdir()
    for entry in (source / "data").iterdir():
        if entry.name == "tasks":
            shutil.copytree(entry, folder / "data/tasks")
            for task in (folder / "data/tasks").glob("*.yaml"):
                text = task.read_text().replace("width: 640", "width: 160").replace("height: 360", "height: 90")
                task.write_text(text.replace(", denoise: true", ""))
        else:
            (folder / "data" / entry.name).symlink_to(entry)
    (folder / "build/bin").mkdir(parents=True)
    (folder / "build/bin/phyvisgen").symlink_to(program)
    run("build/bin/phyvisgen generate data/tasks/weigh_beaker.yaml --episodes 1 --samples 1 -o out/demo", folder,
        "what scripts/demo.sh makes, with one sample")


def run(text, folder, where):
    """ends this program where a command fails"""
    begin = time.monotonic()
    # the program looks beside its sources for what scripts/install_pack.sh installs, not in this copy
    place = 'export PVG_PYTHON="$PWD/.venv-pack/bin/python"\n' if "--format lerobot" in text else ""
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", place + text], cwd=folder, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    print(f"{where}: {time.monotonic() - begin:.0f} s", flush=True)
    if done.returncode:
        sys.exit(f"{where}: exit code {done.returncode} of\n{text}\n{done.stdout[-3000:]}")


def reason_in(table, command):
    return next((why for pattern, why in table.items() if re.fullmatch(pattern, command.strip())), None)


def commands_of(block, runs_all):
    """the block without the commands that are left out; a command goes on over lines that end with a backslash"""
    commands = re.sub(r"\\\n\s*", " ", block).splitlines(keepends=True)
    return "".join(c for c in commands if not re.fullmatch(BEFORE, c.strip()) and (runs_all or not reason_in(SLOW, c)))


def check_elsewhere(block, where):
    for command in re.sub(r"\\\n\s*", " ", block).splitlines():
        if command.strip() and not reason_in(ELSEWHERE, command):
            sys.exit(f"{where}: no reason is stated why no test runs\n{command}")


def has_h5py():
    return subprocess.run([PYTHON, "-c", "import h5py"], capture_output=True).returncode == 0


def blocks_of(page):
    """kind, commands and line of every block"""
    text = page.read_text()
    for block in BLOCK.finditer(text):
        yield *block.groups(), text.count("\n", 0, block.start()) + 1


def check_kinds(page, where):
    for kind in FENCE.findall(page.read_text()):
        if kind not in NOT_HERE | {"sh", "python", "console"}:
            sys.exit(f"{where}: nothing runs a block of the kind {kind}: it should be sh, python or console")


def run_pages(source, program, pages, runs_all):
    with tempfile.TemporaryDirectory() as folder:
        make_checkout(source, program, pathlib.Path(folder))
        for page in pages:
            for kind, commands, line in blocks_of(page):
                where = f"{page.relative_to(source)}:{line}"
                if kind == "sh" and commands_of(commands, runs_all).strip():
                    run(commands_of(commands, runs_all), folder, where)
                elif kind == "python" and (runs_all or has_h5py()):
                    run(f"{PYTHON} - <<'END'\n{commands}END", folder, where)


def main():
    words = sys.argv[1:]
    option = words.pop(0) if words[0].startswith("--") else ""
    source, program = pathlib.Path(words[0]).resolve(), pathlib.Path(words[1]).resolve()
    pages = [source / page for page in words[2:]]
    pages = pages or [source / "README.md"] + sorted((source / "docs/guide").glob("*.md"))
    for page in pages:
        check_kinds(page, page.relative_to(source))
        for kind, commands, line in blocks_of(page):
            if kind == "console":
                check_elsewhere(commands, f"{page.relative_to(source)}:{line}")
    if option != "--list":
        run_pages(source, program, pages, option == "--all")


if __name__ == "__main__":
    main()
