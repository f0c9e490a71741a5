"""Messages to and from `phyvisgen serve` (docs/reference/serve.md).

The program runs as a process of its own and speaks over a pipe: a crash of one cannot take the other along, no
compiler is needed to install the package, and any version of Python will do. Large arrays come through memory that
both share.
"""

from __future__ import annotations

import io
import json
import mmap
import os
import signal
import socket as sockets
import struct
import subprocess
import threading
from typing import IO, Any, Callable, Mapping, NoReturn, Sequence, TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["Connection", "RefusedError", "ServeError", "SharedMemory", "check_protocol"]

PROTOCOL = 1
LARGEST_REQUEST = 1 << 24  # that the server reads [bytes]
CLOSED = "this server was closed; start a new one"
_LENGTHS = struct.Struct("<II")
_Facts = TypeVar("_Facts")


class ServeError(RuntimeError):
    """What the server says about a request, one sentence, or why there is no server any more."""


class RefusedError(ServeError):
    """What the program does not serve; a process of it says so on its stderr, too."""


class _OfThisProcess:
    def __reduce__(self) -> NoReturn:
        raise TypeError(
            "a running server can be neither pickled nor copied; make it, or the environment that holds it, in the "
            "process that uses it"
        )


class SharedMemory(_OfThisProcess):
    """Memory into which a program on this machine writes arrays. It is gone with this process, however that ends."""

    def __init__(self, n_bytes: int) -> None:
        self._file = io.FileIO(os.memfd_create("phyvisgen"), "r+")
        self.path = f"/proc/{os.getpid()}/fd/{self._file.fileno()}"
        self.resize(n_bytes)

    def resize(self, n_bytes: int) -> None:
        """Views of before stay what they are, of the memory as it was mapped then."""
        self._file.truncate(n_bytes)
        self.bytes = mmap.mmap(self._file.fileno(), n_bytes, access=mmap.ACCESS_READ)

    def close(self) -> None:
        """Views keep their memory."""
        self._file.close()


class Connection(_OfThisProcess):
    """A process of the program with these words, or a socket where it serves. It is of the process that made it, whose
    threads take turns."""

    def __init__(self, words: Sequence[str], socket: str | os.PathLike[str] | None = None) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._socket: sockets.socket | None = None
        self._owner = os.getpid()
        self._turn = threading.Lock()
        self._why_ended = ""  # a sentence; empty: it goes on
        self._name = words[0] if socket is None else os.fspath(socket)
        if socket is not None:
            self._socket = sockets.socket(sockets.AF_UNIX, sockets.SOCK_STREAM)
            try:
                self._socket.connect(os.fspath(socket))
            except OSError as error:
                self._socket.close()
                raise ServeError(
                    f"no server answers on the socket {self._name} ({error.strerror or error}); start one there: "
                    f"phyvisgen serve TASK --socket {self._name}"
                ) from error
            self._input: IO[bytes] = self._socket.makefile("wb")
            self._output: IO[bytes] = self._socket.makefile("rb")
        else:
            try:
                self._process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            except OSError as error:
                raise ServeError(
                    f"{words[0]} cannot be started ({error.strerror}); set PHYVISGEN_PROGRAM to the program's path"
                ) from error
            assert self._process.stdin and self._process.stdout
            self._input, self._output = self._process.stdin, self._process.stdout
            # a process that is dropped while it runs is kept by Python; its pipes, at whose end it ends, are not
            self._process.stdin = self._process.stdout = None

    @property
    def is_process(self) -> bool:
        """The program is a process of ours, which shares memory with us."""
        return self._process is not None

    def greeting(self, read: Callable[[Mapping[str, Any]], _Facts]) -> _Facts:
        """What the server says first, as `read` takes it. Closes where that fails."""
        head: Mapping[str, Any] = {}
        try:
            head, _ = self._exchange(b"")
            check_protocol(head)
            return read(head)
        except BaseException as error:
            self._end(CLOSED)
            if isinstance(error, KeyError):
                raise ServeError(
                    f"the program, {head.get('program')}, does not say {error} of what it serves; update it or this "
                    "package, whichever is older"
                ) from error
            raise

    def request(self, head: Mapping[str, Any]) -> tuple[dict[str, Any], bytes]:
        """The answer, an error among them."""
        message = _encoded(head)
        if os.getpid() != self._owner:  # two processes would read each other's answers
            raise ServeError("this server was started by another process; start one in each process that steps")
        with self._turn:
            if self._why_ended:
                raise ServeError(self._why_ended)
            return self._exchange(_LENGTHS.pack(len(message), 0) + message)

    def _exchange(self, message: bytes) -> tuple[dict[str, Any], bytes]:
        """Sends, and returns head and arrays of what is answered. Whatever breaks this off ends the connection: the rest
        of an answer would be taken for the next one."""
        try:
            try:
                self._input.write(message)
                self._input.flush()
            except ConnectionError:
                pass  # why is seen at once, when there is no answer
            n_head, n_bytes = _LENGTHS.unpack(self._read(_LENGTHS.size))
            head = json.loads(self._read(n_head))
            return head, self._read(n_bytes)
        except (EOFError, ConnectionError) as error:
            self._end(self._last_words())
            raise ServeError(self._why_ended) from error
        except ValueError as error:
            self._kill(f"{self._name} does not answer as `phyvisgen serve` does; set PHYVISGEN_PROGRAM to its path")
            raise ServeError(self._why_ended) from error
        except BaseException:
            self._kill("a request was interrupted before it was answered, which ended the connection; start a new one")
            raise

    def _read(self, n: int) -> bytes:
        data = self._output.read(n)
        if len(data) < n:
            raise EOFError
        return data

    def _last_words(self) -> str:
        if not self._process:
            return f"the server at {self._name} ended the connection; its last words are on its stderr"
        code = self._process.wait()
        how = f"exit code {code}" if code >= 0 else f"signal {signal.Signals(-code).name}"
        return f"the server ended ({how}); its last words are on stderr"

    def _kill(self, why: str) -> None:
        """At once, whatever the program does."""
        if self._process:
            self._process.kill()
        self._end(why)

    def _end(self, why: str) -> None:
        self._why_ended = self._why_ended or why
        for stream in (self._input, self._output):
            try:
                stream.close()
            except ConnectionError:
                pass
        if self._process:
            self._process.wait()
        if self._socket:
            self._socket.close()

    def close(self) -> None:
        """Ends the program; in a process that was forked from its owner only what that process has of it."""
        try:
            self.request({"do": "close"})  # a fork may still hold the pipe, whose end would then not come
        except ServeError:
            pass  # it has ended, or is not ours
        self._end(CLOSED)


def _encoded(head: Mapping[str, Any]) -> bytes:
    """A request as JSON; of arrays their numbers."""
    name = f"`{head.get('do')}`"
    try:
        message = json.dumps(head, default=lambda value: value.tolist(), allow_nan=False).encode()
    except ValueError:
        raise ValueError(f"the request {name} holds what is not a finite number") from None
    except AttributeError as error:
        raise TypeError(f"the request {name} holds what is neither a number, a text nor an array") from error
    if len(message) > LARGEST_REQUEST:
        raise ValueError(
            f"the request {name} takes {len(message)} bytes, it may take {LARGEST_REQUEST}; ask for fewer steps at once"
        )
    return message


def check_protocol(head: Mapping[str, Any]) -> None:
    """Of a greeting: it is one, of this protocol."""
    if "error" in head:  # the file cannot be served
        raise RefusedError(head["error"])
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
