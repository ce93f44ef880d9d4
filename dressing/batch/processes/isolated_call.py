"""Limits and outcome of a function call in a process of its own."""

from dataclasses import dataclass
from typing import Any, Literal


class PoolFailed(Exception):
    """No more calls can be carried out; the message is one line."""


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits of one call: wall time [s] and memory [bytes]; None is no limit."""

    seconds: float | None = None
    memory: int | None = None


@dataclass(frozen=True, kw_only=True)
class Ended:
    """Outcome of a call.

    Attributes
    ----------
    how
        "returned": the function gave `value`; "died": its process ended without an answer; "timeout": it was
        killed after its time; "lost": the process that had started it is gone, and so is the call.
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

    how: Literal["returned", "died", "timeout", "lost"]
    value: Any = None
    exit_status: int = 0
    wall_seconds: float = 0.0
    cpu_seconds: float = 0.0
    peak_memory: int = 0
    printed: bytes = b""
