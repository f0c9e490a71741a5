"""Messages to and from `phyvisgen serve` (docs/reference/serve.md).

The program runs as a process of its own and speaks over a pipe: a crash of one cannot take the other along, no
compiler is needed to install the package, and any version of Python will do. Large arrays come through memory that
both share.
"""

from __future__ import annotations

import json
import mmap
import os
import socket as sockets
import struct
import subprocess
from typing import IO, Any, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["Connection", "ServeError", "SharedMemory", "check_protocol"]

PROTOCOL = 1
_LENGTHS = struct.Struct("<II")


class ServeError(RuntimeError):
    """What the server says about a request, one sentence, or why there is no server any more."""


class SharedMemory:
    """Memory into which a program on this machine writes arrays. It is gone with this process, however that ends."""

    def __init__(self, n_bytes: int) -> None:
        self._file = os.memfd_create("phyvisgen")
        self.path = f"/proc/{os.getpid()}/fd/{self._file}"
        self.resize(n_bytes)

    def resize(self, n_bytes: int) -> None:
        """Views of before stay what they are, of the memory as it was mapped then."""
        os.ftruncate(self._file, n_bytes)
        self.bytes = mmap.mmap(self._file, n_bytes, access=mmap.ACCESS_READ)

    def close(self) -> None:
        """Views keep their memory."""
        os.close(self._file)


class Connection:
    """A process of the program with these words, or a socket where it serves."""

    def __init__(self, words: Sequence[str], socket: str | os.PathLike[str] | None = None) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._socket: sockets.socket | None = None
        self._is_open = True
        if socket is not None:
            self._socket = sockets.socket(sockets.AF_UNIX, sockets.SOCK_STREAM)
            try:
                self._socket.connect(os.fspath(socket))
            except OSError as error:
                self._socket.close()
                raise ServeError(
                    f"no server answers on the socket {os.fspath(socket)} ({error.strerror or error}); start one there: "
                    f"phyvisgen serve TASK --socket {os.fspath(socket)}"
                ) from error
            self._input: IO[bytes] = self._socket.makefile("wb")
            self._output: IO[bytes] = self._socket.makefile("rb")
        else:
            self._process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            assert self._process.stdin and self._process.stdout
            self._input, self._output = self._process.stdin, self._process.stdout

    @property
    def is_process(self) -> bool:
        """The program is a process of ours, which shares memory with us."""
        return self._process is not None

    def receive(self) -> tuple[dict[str, Any], bytes]:
        """Head and arrays of the next message."""
        try:
            n_head, n_bytes = _LENGTHS.unpack(self._read(_LENGTHS.size))
            head = json.loads(self._read(n_head))
            data = self._read(n_bytes)
        except (EOFError, ConnectionError) as error:
            code = self._process.wait() if self._process else None
            raise ServeError(f"the server ended (exit code {code}); its last words are on stderr") from error
        return head, data

    def _read(self, n: int) -> bytes:
        data = self._output.read(n)
        if len(data) < n:
            raise EOFError
        return data

    def request(self, head: Mapping[str, Any]) -> tuple[dict[str, Any], bytes]:
        """The answer, an error among them."""
        if not self._is_open:
            raise ServeError("this server was closed; start a new one")
        message = json.dumps(head).encode()
        try:
            self._input.write(_LENGTHS.pack(len(message), 0) + message)
            self._input.flush()
        except (BrokenPipeError, ConnectionError):
            pass  # why is seen at once, when there is no answer
        return self.receive()

    def close(self) -> None:
        self._is_open = False
        for stream in (self._input, self._output):
            try:
                stream.close()
            except (BrokenPipeError, ConnectionError):
                pass
        if self._process:
            self._process.wait()
        if self._socket:
            self._socket.close()


def check_protocol(head: Mapping[str, Any]) -> None:
    """Of a greeting: it is one, of this protocol."""
    if "error" in head:  # the file cannot be served
        raise ServeError(head["error"])
    if head.get("protocol") != PROTOCOL:
        raise ServeError(f"the program speaks protocol {head.get('protocol')}, this package {PROTOCOL}; update the older")


def read_array(array: Mapping[str, Any], data: bytes, memory: SharedMemory | None) -> NDArray[Any]:
    """One of the `arrays` of an answer, read-only: a view of the answer's bytes or of the memory."""
    count = int(np.prod(array["shape"], dtype=np.int64))
    if count == 0:
        flat = np.frombuffer(b"", dtype=array["type"])
    elif "memory_offset" in array:
        assert memory
        flat = np.frombuffer(memory.bytes, dtype=array["type"], count=count, offset=array["memory_offset"])
    else:
        flat = np.frombuffer(data, dtype=array["type"], count=count, offset=array["offset"])
    return flat.reshape(array["shape"])
