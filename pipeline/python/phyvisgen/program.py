"""Where the program, its tasks and its scenes are."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Mapping

__all__ = ["find_program", "find_scene", "find_task", "scenes", "serve_words", "tasks"]

OF_PICTURES = ("width", "height", "samples")  # options of `serve` that --no-render excludes


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


def _known(kind: str, program: Path | None) -> dict[str, Path]:
    """Of an installation, or of a source tree whose build folder holds the program."""
    program = program or find_program()
    for folder in (program.parent.parent / "share/phyvisgen/data", program.parent.parent.parent / "data"):
        if (folder / kind).is_dir():
            return {file.stem: file for file in sorted((folder / kind).glob("*.yaml"))}
    return {}


def tasks(program: Path | None = None) -> dict[str, Path]:
    """The program's own tasks by name."""
    return _known("tasks", program)


def scenes(program: Path | None = None) -> dict[str, Path]:
    """The program's own scenes by name."""
    return _known("scenes", program)


def _find(kind: str, named: str | os.PathLike[str], known: dict[str, Path]) -> Path:
    path = Path(named)
    if path.is_file():
        return path.resolve()
    if str(named) in known:
        return known[str(named)]
    raise FileNotFoundError(f"{named} is neither a {kind} file nor one of {', '.join(known) or f'no {kind}s'}")


def find_task(task: str | os.PathLike[str], program: Path | None = None) -> Path:
    """A task file: the path itself, or the name of one of the program's own, such as `weigh_beaker`."""
    return _find("task", task, tasks(program))


def find_scene(scene: str | os.PathLike[str], program: Path | None = None) -> Path:
    """A scene file: the path itself, or the name of one of the program's own, such as `two_arms`."""
    return _find("scene", scene, scenes(program))


def serve_words(program: Path, file: Path, render: bool, options: Mapping[str, object]) -> list[str]:
    """The command that serves a file. options: by name, without dashes; None: not given."""
    for name in OF_PICTURES:
        if not render and options.get(name) is not None:
            raise ValueError(
                f"{name} is for pictures, and none are made: render is False, or an environment shows no pixels and has "
                f"no render_mode; leave {name} out, or ask for pictures"
            )
    words = [str(program), "serve", str(file)]
    for name, value in options.items():
        if value is not None:
            words += [f"--{name}", str(value)]
    return words if render else [*words, "--no-render"]
