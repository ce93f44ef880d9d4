"""A warm process that carries out every call in a process of its own, by forking itself.

It has loaded all kernels and has one thread, so a fork is cheap and safe. It starts calls, watches their
time, and reports how they ended. Forked processes end with it, and it ends with the process that started it:
each holds the reading end of a pipe of the one above, which is closed at that one's end, however it comes.
"""

import gc
import os
import pickle
import resource
import selectors
import signal
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from importlib import import_module

from toile.dress.batch.isolated_call import Call, Ended, FrameReader, Limits, framed, write_all


def main(arguments: Sequence[str]) -> None:
    """Serve calls on two inherited descriptors, after calling a function: `requests answers module:name`."""
    requests, answers = int(arguments[0]), int(arguments[1])
    # Ctrl-C is for the process that started this one, which says what becomes of the calls.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    module, _, name = arguments[2].partition(":")
    getattr(import_module(module), name)()
    gc.collect()
    gc.freeze()
    _Server(requests, answers).serve()


@dataclass
class _Running:
    """A call under way: its process, what came back so far, and when it started and must end [s]."""

    number: int
    pid: int
    started: float
    deadline: float | None
    content: bytearray = field(default_factory=bytearray)
    late: bool = False


class _Server:
    """The loop that starts calls and collects what they return."""

    def __init__(self, requests: int, answers: int) -> None:
        self._requests, self._answers = requests, answers
        self._reader = FrameReader(requests)
        self._lifeline = os.pipe()
        self._running: dict[int, _Running] = {}
        self._selector = selectors.DefaultSelector()
        self._selector.register(requests, selectors.EVENT_READ)

    def serve(self) -> None:
        """Serve until nobody asks or listens any more; what still runs then is killed."""
        with suppress(BrokenPipeError):
            self._serve()
        self._kill_all()

    def _serve(self) -> None:
        """Start calls and collect what they return, until nobody asks any more."""
        while True:
            for key, _ in self._selector.select(self._until_next_deadline()):
                if key.fd != self._requests:
                    self._collect(key.fd)
                    continue
                calls = self._reader.read()
                if calls is None:
                    return
                for call in calls:
                    self._start(call)
            self._kill_late()

    def _until_next_deadline(self) -> float | None:
        """Return the time until a call must end [s], None if none must."""
        deadlines = [run.deadline for run in self._running.values() if run.deadline and not run.late]
        return max(min(deadlines) - time.monotonic(), 0.0) if deadlines else None

    def _start(self, call: Call) -> None:
        """Fork a process that carries out a call."""
        reading, writing = os.pipe()
        started = time.monotonic()
        pid = os.fork()
        if not pid:
            try:
                self._leave_behind(reading)
                carry_out(call.payload, call.limits, writing)
            finally:
                os._exit(1)
        os.close(writing)
        seconds = call.limits.seconds
        self._running[reading] = _Running(
            call.number, pid, started, None if seconds is None else started + seconds
        )
        self._selector.register(reading, selectors.EVENT_READ)

    def _leave_behind(self, reading: int) -> None:
        """In a forked process, let go of what belongs to the server, and end with it."""
        os.close(self._lifeline[1])
        for descriptor in (self._requests, self._answers, reading, *self._running):
            os.close(descriptor)
        threading.Thread(target=_end_with_parent, args=(self._lifeline[0],), daemon=True).start()

    def _collect(self, reading: int) -> None:
        """Take what a call has returned; at its end report it."""
        run = self._running[reading]
        content = os.read(reading, 1 << 16)
        if content:
            run.content += content
            return
        self._selector.unregister(reading)
        os.close(reading)
        del self._running[reading]
        _, status, usage = os.wait4(run.pid, 0)
        ended = Ended(
            number=run.number,
            how="timeout" if run.late else "returned" if run.content and status == 0 else "died",
            value=bytes(run.content) if status == 0 else None,
            exit_status=os.waitstatus_to_exitcode(status),
            wall_seconds=time.monotonic() - run.started,
            cpu_seconds=usage.ru_utime + usage.ru_stime,
            peak_memory=usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024),
        )
        write_all(self._answers, framed(ended))

    def _kill_late(self) -> None:
        """Kill calls that have run out of time; their pipes close, and they are collected."""
        now = time.monotonic()
        for run in self._running.values():
            if run.deadline is not None and now >= run.deadline and not run.late:
                run.late = True
                os.kill(run.pid, signal.SIGKILL)

    def _kill_all(self) -> None:
        """Kill what still runs."""
        for run in self._running.values():
            os.kill(run.pid, signal.SIGKILL)
        for run in self._running.values():
            os.waitpid(run.pid, 0)


def carry_out(payload: bytes, limits: Limits, writing: int) -> None:
    """Call a function under limits, write what it returned to a pipe, and end the process."""
    if limits.memory is not None:
        # Of the memory that may be written, which is what can run out, not of the address space.
        resource.setrlimit(resource.RLIMIT_DATA, (limits.memory, limits.memory))
    function, argument = pickle.loads(payload)
    answer = pickle.dumps(function(argument), protocol=5)
    write_all(writing, answer)
    os._exit(0)


def _end_with_parent(lifeline: int) -> None:
    """Wait until the other end of a pipe is closed, then end this process at once."""
    os.read(lifeline, 1)
    os._exit(1)


if __name__ == "__main__":
    main(sys.argv[1:])
