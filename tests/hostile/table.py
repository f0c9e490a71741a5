"""What a row of the hostile table is, and the short words that rows are written with.

A row is one input of the program: a command, the exit code that it must end with and a pattern that its one sentence
must match. Rows stand in rows_*.py, by subject; run.py runs them.
"""
import dataclasses
import json
import pathlib
import shutil
from typing import Callable, Sequence

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
DATA = REPOSITORY / "data"

DONE, FAILED, WRONG_USE, TRY_AGAIN = 0, 1, 2, 75

Step = Callable[[pathlib.Path], None]  # prepares the row's own folder


@dataclasses.dataclass
class Row:
    name: str  # what is wrong with the input
    command: str  # arguments of phyvisgen, run in the row's folder; words are split as a shell does
    code: int
    pattern: str  # regular expression; of stderr where the code is not 0, else of both outputs
    needs: Sequence[str] = ()  # fixtures to copy there: see fixtures.py
    steps: Sequence[Step] = ()  # then what spoils them
    makes: Sequence[str] = ()  # globs of files that may appear; nothing else may
    changes: Sequence[str] = ()  # globs of files that may change or go; all others must keep their bytes
    environment: dict = dataclasses.field(default_factory=dict)
    shell: str = ""  # a shell script to run instead, in which $B is the program; `command` then names it only
    notes: int = 0  # lines of the program that may stand beside the sentence
    seconds: float = 10  # longest


TABLE: list[Row] = []


def row(name, command, code, pattern, *steps, needs=(), **more):
    needs = needs.split() if isinstance(needs, str) else needs
    TABLE.append(Row(name, command, code, pattern, needs, steps, **more))


def write(file, content=""):
    """Makes a file of text or bytes, and its folder."""

    def step(folder):
        path = folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())

    return step


def edit(file, old, new, count=1):
    """Replaces a text that must be there; the table is out of date where it is not."""

    def step(folder):
        text = (folder / file).read_text()
        assert old in text, f"{file} holds no {old!r}"
        (folder / file).write_text(text.replace(old, new, count))

    return step


def append(file, text):
    def step(folder):
        with open(folder / file, "ab") as out:
            out.write(text if isinstance(text, bytes) else text.encode())

    return step


def cut(file, share):
    """Keeps the first bytes, as an interrupted copy does."""

    def step(folder):
        content = (folder / file).read_bytes()
        (folder / file).write_bytes(content[: int(len(content) * share)])

    return step


def remove(file):
    def step(folder):
        path = folder / file
        shutil.rmtree(path) if path.is_dir() else path.unlink()

    return step


def make_folder(name):
    return lambda folder: (folder / name).mkdir(parents=True)


def rename(old, new):
    return lambda folder: (folder / old).rename(folder / new)


def link(name, target):
    return lambda folder: (folder / name).symlink_to(target)


def copy(old, new):
    def step(folder):
        (shutil.copytree if (folder / old).is_dir() else shutil.copy)(folder / old, folder / new)

    return step


def set_json(file, **values):
    """Changes top-level keys of a JSON file; None takes the key out."""

    def step(folder):
        content = json.loads((folder / file).read_text())
        for key, value in values.items():
            if value is None:
                content.pop(key)
            else:
                content[key] = value
        (folder / file).write_text(json.dumps(content))

    return step


def states(file, change):
    """Changes a states file: `change` gets it as an h5py.File."""

    def step(folder):
        import h5py

        with h5py.File(folder / file, "r+") as out:
            change(out)

    return step


def put(name, values, dtype=None):
    """For states(): replaces a data set, with its attributes."""

    def change(out):
        import numpy

        attributes = dict(out[name].attrs) if name in out else {}
        if name in out:
            del out[name]
        out.create_dataset(name, data=numpy.asarray(values, dtype=dtype))
        for key, value in attributes.items():
            out[name].attrs[key] = value

    return change


def poke(name, index, value):
    """For states(): changes one value."""

    def change(out):
        out[name][index] = value

    return change


def drop(name):
    def change(out):
        del out[name]

    return change
