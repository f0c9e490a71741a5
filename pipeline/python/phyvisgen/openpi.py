"""A policy behind OpenPI's WebSocket protocol: msgpack frames, arrays as maps with binary keys. The server speaks first
(metadata); each observation is answered by a chunk of actions; a text frame is an error."""

from __future__ import annotations

import socket
from contextlib import ExitStack
from typing import Any

import msgpack
import numpy as np
from numpy.typing import NDArray
from websockets.exceptions import InvalidURI, WebSocketException
from websockets.sync.client import connect
from websockets.uri import parse_uri

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


SECONDS_TO_ANSWER = 10.0  # until the connection stands, and again until the server's first frame
WHAT_TO_DO = "start the server of policies there, or name the address of one that runs: --policy ws://HOST:PORT"


def _check_address(url: str) -> None:
    try:
        parse_uri(url)
    except (InvalidURI, ValueError) as error:
        raise ValueError(f"--policy {url} is no address; write ws://HOST:PORT, such as ws://localhost:8000") from error


def _reason(error: Exception) -> str:
    """Why no connection stands, without numbers of the operating system."""
    if isinstance(error, ConnectionRefusedError):
        return "the machine answers, but no program listens on this port"
    if isinstance(error, socket.gaierror):
        return "no machine of this name is known"
    if isinstance(error, TimeoutError):
        return f"nothing came back within {SECONDS_TO_ANSWER:g} s"
    if isinstance(error, WebSocketException | EOFError):
        return f"a program answers that does not speak OpenPI's protocol ({error})"
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


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
        _check_address(url)
        try:
            connection = connect(url, compression=None, max_size=None, open_timeout=SECONDS_TO_ANSWER)
            self._socket = self._opened.enter_context(connection)
            self.metadata = self._receive(SECONDS_TO_ANSWER)
        except (OSError, EOFError, WebSocketException) as error:
            self._opened.close()
            raise ServeError(f"no server of policies could be reached at {url}: {_reason(error)}; {WHAT_TO_DO}") from error
        self._chunk: list[NDArray[np.float64]] = []

    def _receive(self, seconds: float | None = None) -> Any:
        """The next frame, waited for as long as it takes or `seconds`."""
        frame = self._socket.recv(seconds)
        if isinstance(frame, str):
            raise ServeError(f"the server of policies reports an error: {frame.strip().splitlines()[-1]}")
        try:
            return unpack(frame)
        except (ValueError, msgpack.UnpackException) as error:
            raise ServeError(f"{self.name} sent a frame that is no msgpack; is it a server of policies?") from error

    def _ask(self, seen: Answer) -> list[NDArray[np.float64]]:
        observation: dict[str, Any] = {
            "observation/state": seen.arrays["agent_pos"].astype(np.float32),
            "observation/environment_state": seen.arrays["environment_state"].astype(np.float32),
            "prompt": self._prompt,
        }
        for name, picture in seen.pictures.items():
            observation[f"observation/images/{name}"] = np.ascontiguousarray(picture)
        try:
            self._socket.send(pack(observation))
            answer = self._receive()
        except (OSError, WebSocketException) as error:
            raise ServeError(
                f"the server of policies at {self.name} ended the connection when it was asked for actions ({error}); "
                "its own messages tell why"
            ) from error
        if not isinstance(answer, dict) or "actions" not in answer:
            raise ServeError(f"the server of policies at {self.name} answered an observation without `actions`")
        try:
            actions = np.atleast_2d(np.asarray(answer["actions"], dtype=np.float64))
        except (TypeError, ValueError):
            actions = np.zeros(0)
        if actions.ndim != 2 or actions.size == 0 or not np.isfinite(actions).all():
            raise ServeError(
                f"the server of policies at {self.name} answered `actions` that are no rows of finite numbers"
            )
        return list(actions[: self._executed])

    def reset(self, start: Answer) -> None:
        self._chunk = []

    def step(self, server: Server, seen: Answer) -> Answer:
        if not self._chunk:
            self._chunk = self._ask(seen)
        return server.step(self._chunk.pop(0), self.cameras)

    def close(self) -> None:
        self._opened.close()
