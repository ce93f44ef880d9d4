"""A warm process that carries out every call in a process of its own, by forking itself.

It has loaded all kernels and has one thread, so a fork is safe. It starts calls, watches their time, and
reports how they ended. One process more than is needed is always forked: the next call need not wait for it.
Forked processes end with this one, and it ends with the process that started it, whose pipe is closed then.
"""

import gc
import os
import selectors
import signal
import sys
import time
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module

from toile.dressing.batch.processes.call_process import CallProcess
from toile.dressing.batch.processes.huge_pages import collapse_memory
from toile.dressing.batch.processes.isolated_call import (
    Call,
    Ended,
    FrameReader,
    content_of,
    end_of_message,
    framed,
    write_all,
)

MOST_PRINTED = 1 << 20
"""How much is kept of what a call prints [bytes]."""


def main(arguments: Sequence[str]) -> None:
    """Serve calls, so many at a time, on two inherited descriptors, after calling a function.

    The arguments are `workers requests answers module:name`.
    """
    workers, requests, answers = (int(number) for number in arguments[:3])
    # Ctrl-C is for the process that started this one, which says what becomes of the calls.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    module, _, name = arguments[3].partition(":")
    getattr(import_module(module), name)()
    gc.collect()
    gc.freeze()
    collapse_memory()
    _Server(workers, requests, answers).serve()


@dataclass
class _Running:
    """A call under way: its process, what came back so far, and when it started and must end [s].

    `content` is what the function returned, `printed` the end of what was printed.
    """

    number: int
    process: CallProcess
    started: float
    deadline: float | None
    content: bytearray = field(default_factory=bytearray)
    printed: bytearray = field(default_factory=bytearray)
    late: bool = False

    def take_answer(self) -> bool:
        """Take what came back by now; return whether the process has ended."""
        return _read(self.process.answer, self.content)

    @property
    def answered(self) -> bool:
        """Whether all has come back, so that the process has only to end."""
        return end_of_message(self.content) is not None

    def take_print(self) -> bool:
        """Take what was printed by now, of which the end is kept; return whether no more can come."""
        ended = _read(self.process.printed, self.printed)
        del self.printed[:-MOST_PRINTED]
        return ended


class _Server:
    """The loop that starts calls and collects what they return."""

    def __init__(self, workers: int, requests: int, answers: int) -> None:
        self._workers, self._requests, self._answers = workers, requests, answers
        self._reader = FrameReader(requests)
        self._waiting: deque[Call] = deque()
        self._running: dict[int, _Running] = {}
        self._selector = selectors.DefaultSelector()
        self._selector.register(requests, selectors.EVENT_READ)
        self._spare = self._fork()

    def serve(self) -> None:
        """Serve until nobody asks or listens any more; what still runs then is killed."""
        with suppress(BrokenPipeError):
            self._serve()
        for process in (self._spare, *(run.process for run in self._running.values())):
            process.kill()
            process.reap()

    def _serve(self) -> None:
        """Start calls and collect what they return, until nobody asks any more."""
        while True:
            for key, _ in self._selector.select(self._until_next_deadline()):
                if key.data is not None:
                    key.data()
                    continue
                calls = self._reader.read()
                if calls is None:
                    return
                self._waiting += calls
            while self._waiting and self._busy < self._workers:
                self._start(self._waiting.popleft())
            self._kill_late()

    @property
    def _busy(self) -> int:
        """How many calls are being carried out; the end of a process takes milliseconds."""
        return sum(not run.answered for run in self._running.values())

    def _until_next_deadline(self) -> float | None:
        """Return the time until a call must end [s], None if none must."""
        deadlines = [run.deadline for run in self._running.values() if run.deadline and not run.late]
        return max(min(deadlines) - time.monotonic(), 0.0) if deadlines else None

    def _fork(self) -> CallProcess:
        """Fork a process, which lets go of what belongs to the server."""
        held = [end for run in self._running.values() for end in (run.process.answer, run.process.printed)]
        return CallProcess((self._requests, self._answers, *held))

    def _start(self, call: Call) -> None:
        """Hand a call to the process at hand, and fork another one for the next."""
        process = self._spare
        if not process.hand(call.payload, call.limits):
            # Somebody has killed it; should this one be killed too, then as a process of the call.
            process.reap()
            process = self._fork()
            process.hand(call.payload, call.limits)
        started, seconds = time.monotonic(), call.limits.seconds
        run = _Running(call.number, process, started, None if seconds is None else started + seconds)
        self._running[call.number] = run
        self._selector.register(process.answer, selectors.EVENT_READ, partial(self._collect, run))
        self._selector.register(process.printed, selectors.EVENT_READ, partial(self._listen, run))
        self._spare = self._fork()

    def _listen(self, run: _Running) -> None:
        """Take what a call prints."""
        if run.number in self._running and run.take_print():
            self._selector.unregister(run.process.printed)

    def _collect(self, run: _Running) -> None:
        """Take what a call has returned; at its end report it, after those that were answered before."""
        if run.number not in self._running or not run.take_answer():
            return
        before = [other for other in self._running.values() if other.answered and other.number < run.number]
        for one in (*before, run):
            self._report(one)

    def _report(self, run: _Running) -> None:
        """Report a call whose process has ended or is about to."""
        run.take_print()
        self._selector.unregister(run.process.answer)
        with suppress(KeyError):
            self._selector.unregister(run.process.printed)
        del self._running[run.number]
        status, usage = run.process.reap()
        returned = run.answered and status == 0
        ended = Ended(
            number=run.number,
            how="timeout" if run.late else "returned" if returned else "died",
            value=content_of(run.content, len(run.content)) if returned else None,
            exit_status=os.waitstatus_to_exitcode(status),
            wall_seconds=time.monotonic() - run.started,
            cpu_seconds=usage.ru_utime + usage.ru_stime,
            peak_memory=usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024),
            printed=bytes(run.printed),
        )
        write_all(self._answers, framed(ended))

    def _kill_late(self) -> None:
        """Kill calls that have run out of time; their pipes close, and they are collected."""
        now = time.monotonic()
        for run in self._running.values():
            if run.deadline is not None and now >= run.deadline and not run.late:
                run.late = True
                run.process.kill()


def _read(end: int, into: bytearray) -> bool:
    """Append what can be read now from a descriptor; return whether that was the end of it."""
    try:
        content = os.read(end, 1 << 16)
    except BlockingIOError:
        return False
    into += content
    return not content


if __name__ == "__main__":
    main(sys.argv[1:])
