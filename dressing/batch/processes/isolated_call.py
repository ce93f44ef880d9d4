"""A function call in a process of its own: what is asked, what comes back, and how it goes over a pipe."""

import os
import pickle
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

HEADER = struct.Struct("<Q")
CHUNK = 1 << 20


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What one call may use: wall time [s] and memory [bytes]; None is no limit."""

    seconds: float | None = None
    memory: int | None = None


@dataclass(frozen=True, kw_only=True)
class Call:
    """A call to carry out: `payload` is a pickled pair of function and argument."""

    number: int
    payload: bytes
    limits: Limits


@dataclass(frozen=True, kw_only=True)
class Ended:
    """How a call ended.

    Attributes
    ----------
    number
        The call's.
    how
        "returned": the function gave `value`; "died": its process ended without an answer; "timeout": it was
        killed after its time; "lost": the process that was to start it is gone, and so is the call.
    value
        What the function returned.
    exit_status
        Of the process, negative for a signal.
    wall_seconds, cpu_seconds
        Time from start to end, and processor time [s].
    peak_memory
        Largest resident memory [bytes].
    printed
        What its process wrote to standard output and standard error, the end of it if it was much.
    """

    number: int
    how: Literal["returned", "died", "timeout", "lost"]
    value: Any = None
    exit_status: int = 0
    wall_seconds: float = 0.0
    cpu_seconds: float = 0.0
    peak_memory: int = 0
    printed: bytes = b""


def pickled_call(function: Callable[[Any], Any], argument: Any) -> bytes:
    """Return the payload of a call; the function must be importable by name."""
    return pickle.dumps((function, argument), protocol=5)


def framed(message: object) -> bytes:
    """Return a message as bytes that say their own length."""
    content = pickle.dumps(message, protocol=5)
    return HEADER.pack(len(content)) + content


def end_of_message(buffer: bytearray) -> int | None:
    """Return where the first message in a buffer ends, see `framed`; None if it is not whole yet."""
    if len(buffer) < HEADER.size:
        return None
    end: int = HEADER.size + HEADER.unpack_from(buffer)[0]
    return end if len(buffer) >= end else None


def content_of(buffer: bytearray, end: int) -> bytes:
    """Return what the first message in a buffer holds, pickled."""
    return bytes(buffer[HEADER.size : end])


def write_all(descriptor: int, content: bytes) -> None:
    """Write everything to a blocking descriptor."""
    view = memoryview(content)
    while view:
        view = view[os.write(descriptor, view) :]


class FrameReader:
    """Cuts what arrives on a descriptor into messages."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._buffer = bytearray()

    def read(self) -> list[Any] | None:
        """Read once, and return the messages that are complete; None at the end of the stream."""
        content = os.read(self._descriptor, CHUNK)
        if not content:
            return None
        self._buffer += content
        found = []
        while (end := end_of_message(self._buffer)) is not None:
            found.append(pickle.loads(content_of(self._buffer, end)))
            del self._buffer[:end]
        return found
