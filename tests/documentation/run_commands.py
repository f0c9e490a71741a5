#!/usr/bin/env python3
"""Runs every block of shell commands in the README and the guide as it stands; the first one that fails is printed.

    tests/documentation/run_commands.py SOURCE PROGRAM [PAGE ...]      PAGE: such as docs/guide/tasks.md; all without

The blocks of a page run one after the other in a folder that looks like the checkout after scripts/demo.sh: build/bin
holds PROGRAM, out/demo an episode, and what commands write stays in that folder.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

LEFT_OUT = [  # lines that install, build for long, or need what scripts/install_pack.sh fetches
    r"scripts/(demo|install|install_pack|build|test|test_\w+|fuzz|compare_cycles|task_success|format)\.sh.*",
    r"scripts/(python_env|check_lerobot|check_packed|recordings/\S+)\.sh.*",
    r".*\bpack\b.*--format lerobot.*",
    r"(cmake|ctest|ninja|make)\b.*",
]
BLOCK = re.compile(r"^```sh\n(.*?)^```", re.M | re.S)


def make_checkout(source, program, folder):
    """links to the sources; data/tasks, where commands write, is a copy"""
    for entry in source.iterdir():
        if entry.name not in ("build", "out", "data", ".git") and not entry.name.startswith("build"):
            (folder / entry.name).symlink_to(entry)
    (folder / "data").mkdir()
    for entry in (source / "data").iterdir():
        if entry.name == "tasks":
            shutil.copytree(entry, folder / "data/tasks")
        else:
            (folder / "data" / entry.name).symlink_to(entry)
    (folder / "build/bin").mkdir(parents=True)
    (folder / "build/bin/phyvisgen").symlink_to(program)
    run("build/bin/phyvisgen generate data/tasks/weigh_beaker.yaml --episodes 1 --samples 1 -o out/demo", folder,
        "what scripts/demo.sh makes, with one sample")


def run(text, folder, where):
    """ends this program where a command fails"""
    begin = time.monotonic()
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    print(f"{where}: {time.monotonic() - begin:.0f} s", flush=True)
    if done.returncode:
        sys.exit(f"{where}: exit code {done.returncode} of\n{text}\n{done.stdout[-3000:]}")


def commands_of(block):
    """the block without the commands that are left out; a command goes on over lines that end with a backslash"""
    commands = re.sub(r"\\\n\s*", "", block).splitlines(keepends=True)
    return "".join(c for c in commands if not any(re.fullmatch(out, c.strip()) for out in LEFT_OUT))


def main():
    source, program = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    pages = [source / page for page in sys.argv[3:]]
    pages = pages or [source / "README.md"] + sorted((source / "docs/guide").glob("*.md"))
    with tempfile.TemporaryDirectory() as folder:
        make_checkout(source, program, pathlib.Path(folder))
        for page in pages:
            text = page.read_text()
            for block in BLOCK.finditer(text):
                commands = commands_of(block[1])
                if commands.strip():
                    line = text.count("\n", 0, block.start()) + 1
                    run(commands, folder, f"{page.relative_to(source)}:{line}")


if __name__ == "__main__":
    main()
