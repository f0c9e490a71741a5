"""A policy behind OpenPI's WebSocket protocol: msgpack frames, arrays as maps with binary keys. The server speaks first
(metadata); each observation is answered by a chunk of actions; a text frame is an error."""

from __future__ import annotations

from contextlib import ExitStack
from typing import Any

import msgpack
import numpy as np
from numpy.typing import NDArray
from websockets.sync.client import connect

from .server import Answer, ServeError, Server

__all__ = ["OpenPiPolicy", "pack", "unpack"]


def _pack_array(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return {b"__ndarray__": True, b"data": value.tobytes(), b"dtype": value.dtype.str, b"shape": value.shape}
    if isinstance(value, np.generic):
        return {b"__npgeneric__": True, b"data": value.item(), b"dtype": value.dtype.str}
    return value


def _unpack_array(value: dict[Any, Any]) -> Any:
    if b"__ndarray__" in value:
        return np.frombuffer(value[b"data"], np.dtype(value[b"dtype"])).reshape(value[b"shape"])
    if b"__npgeneric__" in value:
        return np.dtype(value[b"dtype"]).type(value[b"data"])
    return value


def pack(value: Any) -> bytes:
    return msgpack.packb(value, default=_pack_array)


def unpack(data: bytes) -> Any:
    return msgpack.unpackb(data, object_hook=_unpack_array)


class OpenPiPolicy:
    """url: ws://HOST:PORT. Of each chunk of actions the first `executed` are done before the server is asked again.

    An observation holds "observation/state" [n_columns, f32], "observation/environment_state" [f32],
    "observation/images/<camera>" [height, width, 3, u8] and "prompt".
    """

    def __init__(self, url: str, prompt: str, cameras: tuple[str, ...] = (), executed: int | None = None) -> None:
        self.name = url
        self.cameras = cameras
        self._prompt = prompt
        self._executed = executed
        self._opened = ExitStack()
        try:
            self._socket = self._opened.enter_context(connect(url, compression=None, max_size=None))
        except OSError as error:
            raise ServeError(f"no server of policies answers at {url}: {error}") from error
        self.metadata = self._receive()
        self._chunk: list[NDArray[np.float64]] = []

    def _receive(self) -> Any:
        frame = self._socket.recv()
        if isinstance(frame, str):
            raise ServeError(f"the server of policies reports an error: {frame.strip().splitlines()[-1]}")
        return unpack(frame)

    def _ask(self, seen: Answer) -> list[NDArray[np.float64]]:
        observation: dict[str, Any] = {
            "observation/state": seen.arrays["agent_pos"].astype(np.float32),
            "observation/environment_state": seen.arrays["environment_state"].astype(np.float32),
            "prompt": self._prompt,
        }
        for name, picture in seen.pictures.items():
            observation[f"observation/images/{name}"] = np.ascontiguousarray(picture)
        self._socket.send(pack(observation))
        actions = np.atleast_2d(np.asarray(self._receive()["actions"], dtype=np.float64))
        return list(actions[: self._executed])

    def reset(self, start: Answer) -> None:
        self._chunk = []

    def step(self, server: Server, seen: Answer) -> Answer:
        if not self._chunk:
            self._chunk = self._ask(seen)
        return server.step(self._chunk.pop(0), self.cameras)

    def close(self) -> None:
        self._opened.close()
