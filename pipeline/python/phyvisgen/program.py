"""Where the program and its tasks are."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

__all__ = ["find_program", "find_task", "tasks"]


def find_program() -> Path:
    """$PHYVISGEN_PROGRAM, else `phyvisgen` of the PATH, else the build folder of the source tree of this package."""
    named = os.environ.get("PHYVISGEN_PROGRAM")
    if named:
        program = Path(named)
        if not program.is_file():
            raise FileNotFoundError(f"PHYVISGEN_PROGRAM names {named}, which is no file; set it to the program's path")
        return program.resolve()
    on_path = shutil.which("phyvisgen")
    built = Path(__file__).resolve().parents[3] / "build/bin/phyvisgen"
    for program in ([Path(on_path)] if on_path else []) + [built]:
        if program.is_file():
            return program.resolve()
    raise FileNotFoundError("the program phyvisgen was not found; build it and set PHYVISGEN_PROGRAM to its path")


def _task_folders(program: Path) -> list[Path]:
    """Of an installation, and of a source tree whose build folder holds the program."""
    return [program.parent.parent / "share/phyvisgen/data/tasks", program.parent.parent.parent / "data/tasks"]


def tasks(program: Path | None = None) -> dict[str, Path]:
    """The program's own tasks by name."""
    for folder in _task_folders(program or find_program()):
        if folder.is_dir():
            return {file.stem: file for file in sorted(folder.glob("*.yaml"))}
    return {}


def find_task(task: str | os.PathLike[str], program: Path | None = None) -> Path:
    """A task file: the path itself, or the name of one of the program's own, such as `weigh_beaker`."""
    path = Path(task)
    if path.is_file():
        return path.resolve()
    known = tasks(program)
    if str(task) in known:
        return known[str(task)]
    raise FileNotFoundError(f"{task} is neither a task file nor one of {', '.join(known) or 'no tasks'}")
