"""Readers of what the program writes: episode sets and states.h5 (docs/reference/states.md)."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import Any, Iterator

import h5py
import numpy as np
from numpy.typing import NDArray

from .counted import counted

__all__ = ["Episode", "EpisodeSet"]


class Episode:
    """One recorded episode; arrays are read when they are asked for, such as `episode["/q"]`.

    Data sets have the names, shapes and units of docs/reference/states.md. What there is not is a KeyError, also of a
    closed episode.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        file = self.folder / "states.h5"
        try:
            self._file = h5py.File(file, "r")
        except OSError:
            raise ValueError(f"{file} is not there or no HDF5 file that can be read; name an episode of generate") from None

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A data set as an array, by its path."""
        if not self._file:
            raise KeyError(f"{self.folder} was closed; open the episode again, or read it while its turn in the set lasts")
        if name not in self._file:
            raise KeyError(f"{self.folder} has no data set {name}; it has {', '.join(self._file)}")
        item = self._file[name]
        if not isinstance(item, h5py.Dataset):
            raise KeyError(f"{name} of {self.folder} is a group of {', '.join(item)}")
        return item[()]

    @property
    def file(self) -> h5py.File:
        return self._file

    @property
    def seed(self) -> int:
        return int(self._file.attrs["seed"])

    @property
    def number(self) -> int:
        return int(self._file.attrs["episode"])

    @property
    def summary(self) -> dict[str, Any]:
        return json.loads((self.folder / "summary.json").read_text())

    @property
    def gripper(self) -> dict[str, NDArray[np.float64]]:
        """Nodes of the fingers. [n_steps, n_nodes, 3, m]; where only those of frames are kept, other rows are NaN"""
        return {name: data[()] for name, data in self._file["/X_gripper"].items()}

    @property
    def deformables(self) -> dict[str, NDArray[np.float64]]:
        """Nodes of soft objects and points of cloths. [n_steps, n_nodes, 3, m], likewise"""
        return {name: data[()] for name, data in self._file["/X_deform"].items()}

    def contacts(self, step: int) -> dict[str, NDArray[Any]]:
        """Of one step, from 0, by the names of /contact."""
        offset = self["/contact/offset"]
        if not 0 <= step < len(offset) - 1:
            raise IndexError(f"{self.folder} has {counted(len(offset) - 1, 'step')}, from 0 on; there is no step {step}")
        first, last = offset[step : step + 2]
        return {name: data[first:last] for name, data in self._file["/contact"].items() if name != "offset"}

    def close(self) -> None:
        self._file.close()

    def __enter__(self) -> Episode:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


class EpisodeSet:
    """A folder that `generate` filled; iterating opens its finished episodes in their order, each until the next."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        file = self.folder / "set.json"
        try:
            self.set: dict[str, Any] = json.loads(file.read_text())
        except OSError:
            raise FileNotFoundError(f"{file} is not there; name a folder that generate has filled") from None
        except ValueError:
            raise ValueError(f"{file} is no JSON that can be read; copy it again, or generate the set anew") from None

    @property
    def seed(self) -> int:
        return int(self.set["seed"])

    @property
    def done(self) -> list[int]:
        """Numbers of the finished episodes."""
        names = (re.fullmatch(r"episode_(\d+)", path.parent.name) for path in self.folder.glob("episode_*/states.h5"))
        return sorted(int(name[1]) for name in names if name)

    def episode(self, number: int) -> Episode:
        return Episode(self.folder / f"episode_{number:06d}")

    def __len__(self) -> int:
        return len(self.done)

    def __iter__(self) -> Iterator[Episode]:
        for number in self.done:
            with self.episode(number) as episode:
                yield episode
