"""Threads that share out the work of kernels, in parts that do not depend on how many threads there are.

Kernels run without Python's lock, so parts of one list run side by side. Rows of a list do not depend on each
other, and what the parts give is put together in their order: any number of threads, also one, gives the same
bytes.
"""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import count
from queue import SimpleQueue
from threading import Lock, Thread, local
from typing import Generic, TypeVar

import numpy as np

from toile.geometry.arrays import Int

Result = TypeVar("Result")

ALONE = 16
"""How many times longer parts are where one thread works alone."""
MOST_THREADS = 64
"""Threads at most; lists are cut in fewer parts than that."""


def threads_for_one() -> int:
    """Return with how many threads one garment is done soonest: two, where there are two cores."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(2, cores)


class _Job(Generic[Result]):
    """Parts of one piece of work; whichever thread is free takes the next."""

    def __init__(self, work: Callable[[int, int], Result], rows: int, part: int) -> None:
        self._work, self._rows, self._part = work, rows, part
        self._parts = -(-rows // part)
        # Each `next` is one operation of the interpreter: no two threads get the same number.
        self._taken, self._done = count(), count(1)
        self._over = Lock()
        self._over.acquire()
        self._results: list[Result | None] = [None] * self._parts
        self._errors: dict[int, BaseException] = {}

    def take_part(self) -> None:
        """Carry out parts while there are any."""
        for number in self._taken:
            if number >= self._parts:
                return
            first = number * self._part
            try:
                self._results[number] = self._work(first, min(first + self._part, self._rows))
            except BaseException as error:
                self._errors[number] = error
            if next(self._done) == self._parts:
                self._over.release()

    def results(self) -> list[Result]:
        """Wait until all parts are done; return what they gave, in order. Raises what the first raised."""
        self._over.acquire()
        if self._errors:
            raise self._errors[min(self._errors)]
        return self._results  # type: ignore[return-value]


class _Crew:
    """Threads beside the one that gives them work."""

    def __init__(self, helpers: int) -> None:
        self._calls: SimpleQueue[_Job[object] | None] = SimpleQueue()
        self._helpers = [Thread(target=self._serve, daemon=True) for _ in range(helpers)]
        for helper in self._helpers:
            helper.start()

    def _serve(self) -> None:
        while (job := self._calls.get()) is not None:
            job.take_part()
            # What it gave must not live on until the next job comes.
            del job

    def carry_out(self, job: _Job[Result], parts: int) -> None:
        """Work on a job of some parts together."""
        for _ in range(min(len(self._helpers), parts - 1)):
            self._calls.put(job)  # type: ignore[arg-type]
        job.take_part()

    def end(self) -> None:
        """Let the threads end, and wait for them."""
        for _ in self._helpers:
            self._calls.put(None)
        for helper in self._helpers:
            helper.join()


_own = local()
"""Of each thread that runs a scene the crew that helps it: two may run at once."""


def _crew() -> _Crew | None:
    return getattr(_own, "crew", None)


@contextmanager
def crew_of(threads: int) -> Iterator[None]:
    """Share out the work of kernels among so many threads, this one included, for the time being."""
    if threads < 2 or _crew() is not None:
        yield
        return
    crew = _Crew(threads - 1)
    _own.crew = crew
    try:
        yield
    finally:
        _leave()
        crew.end()


def _leave() -> None:
    _own.crew = None


# Threads do not live on in a forked process.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_leave)


def in_parts(work: Callable[[int, int], Result], rows: int, part: int) -> list[Result]:
    """Return what `work(first, last)` gives for rows in parts of `part`, in order; nothing for no rows.

    Rows must not depend on each other: a thread that is alone takes longer parts. Parts run at the same time,
    so they must not write what others read or write. One should take a tenth of a millisecond at least:
    handing it to another thread takes a twentieth.
    """
    crew = _crew()
    if rows <= part or crew is None:
        part *= 1 if crew is not None else ALONE
        return [work(first, min(first + part, rows)) for first in range(0, rows, part)]
    job = _Job(work, rows, part)
    crew.carry_out(job, -(-rows // part))
    return job.results()


def together(parts: Sequence[Int], *width: int) -> Int:
    """Return the rows of parts as one array, shape (n, *width)."""
    if len(parts) == 1:
        return parts[0]
    return np.concatenate(parts) if parts else np.empty((0, *width), np.int32)
