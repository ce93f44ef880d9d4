"""The protocol of a pool that runs a batch's jobs."""

from collections.abc import Callable
from typing import Any, Protocol

from toile.dressing.batch.processes.isolated_call import Ended, Limits


class Pool(Protocol):
    """Runs calls, a number at a time, each in a process of its own."""

    @property
    def room(self) -> int:
        """Number of calls that it can take now."""

    @property
    def unfinished(self) -> int:
        """Calls that have not ended yet."""

    @property
    def running(self) -> int:
        """Those of them that run; the others wait."""

    def start(self, key: Any, function: Callable[[Any], Any], argument: Any, limits: Limits) -> None:
        """Have a function called with an argument; `wait` reports its end under `key`."""

    def wait(self, seconds: float) -> list[tuple[Any, Ended]]:
        """Return the calls that have ended, with their keys; after some time, perhaps none."""

    def withdraw(self) -> list[Any]:
        """Take back calls that wait and have not begun, as far as that is known; return their keys."""

    def close(self) -> None:
        """End everything that still runs."""
