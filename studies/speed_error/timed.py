"""CPU time of repeated runs: median and spread."""

from collections.abc import Callable
from statistics import median
from time import process_time
from typing import NamedTuple, TypeVar

Result = TypeVar("Result")
LONG = 15.0
"""CPU time of all runs of a point after which none is repeated [s]."""


class Timing(NamedTuple):
    """Median and spread (longest less shortest) of CPU times [s], and of how many runs."""

    cpu: float
    spread: float
    repeats: int


def timed(run: Callable[[], Result], repeats: int) -> tuple[Result, Timing]:
    """Run up to `repeats` times, fewer where that takes long; return the first result and the times."""

    def clocked() -> tuple[Result, float]:
        started = process_time()
        result = run()
        return result, process_time() - started

    return repeated(clocked, repeats)


def repeated(run: Callable[[], tuple[Result, float]], repeats: int) -> tuple[Result, Timing]:
    """As `timed`, for what takes its own time: `run` returns a result and its CPU time [s]."""
    runs = [run()]
    while len(runs) < repeats and sum(cpu for _, cpu in runs) < LONG:
        runs.append(run())
    times = [cpu for _, cpu in runs]
    return runs[0][0], Timing(median(times), max(times) - min(times), len(times))
