"""Calls carried out on this machine, so many at a time, by a warm server process."""

import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from toile.dressing.batch.batch_stopped import BatchStopped
from toile.dressing.batch.processes.isolated_call import (
    Call,
    Ended,
    FrameReader,
    Limits,
    framed,
    pickled_call,
    write_all,
)
from toile.dressing.run.kernels import module_path_environment

ONE_THREAD = {
    name: "1"
    for name in (
        "NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS", "BLIS_NUM_THREADS",
    )
}  # fmt: skip
"""Environment in which every library computes with one thread."""
STARTS_WITHOUT_AN_ANSWER = 3
"""A server that ends so often before it has answered anything will not do better."""


class LocalPool:
    """Up to `workers` calls at a time; each in a process of its own, forked from a server.

    The server has one more call at hand, so that none has to wait for this process. It starts them in the
    order in which it got them.
    """

    def __init__(
        self,
        workers: int,
        load: Callable[[], None],
        *,
        say: Callable[[str], None] | None = None,
        inherited: Sequence[int] = (),
    ) -> None:
        """Nothing is started before the first call.

        Parameters
        ----------
        workers
            Calls that run at the same time.
        load
            Called in the server before it forks: loads what all calls need. Importable by name.
        say
            Called with a sentence for people when that begins.
        inherited
            Descriptors that the server and all calls hold open.
        """
        self.workers = workers
        self._load = load
        self._say = say
        self._inherited = tuple(inherited)
        self._given: dict[int, tuple[Any, Call]] = {}
        self._count = 0
        self._silent_starts = 0
        self._answers: queue.SimpleQueue[tuple[int, Ended | None]] = queue.SimpleQueue()
        self._generation = 0
        self._process: subprocess.Popen[bytes] | None = None
        self._requests = -1

    @property
    def room(self) -> int:
        """How many more calls can be given."""
        return self.workers + 1 - self.unfinished

    @property
    def unfinished(self) -> int:
        """Calls that have not ended yet."""
        return len(self._given)

    @property
    def running(self) -> int:
        """Those of them that run; the others wait."""
        return min(len(self._given), self.workers)

    def start(self, key: Any, function: Callable[[Any], Any], argument: Any, limits: Limits) -> None:
        """Have a function called with an argument; `wait` reports its end under `key`."""
        self.start_pickled(key, pickled_call(function, argument), limits)

    def start_pickled(self, key: Any, payload: bytes, limits: Limits) -> None:
        """Have a pickled call carried out, see `pickled_call`."""
        if self._process is None:
            self._start_server()
        self._count += 1
        call = Call(number=self._count, payload=payload, limits=limits)
        self._given[call.number] = key, call
        self._send(call)

    def wait(self, seconds: float) -> list[tuple[Any, Ended]]:
        """Return the calls that have ended, with their keys; after some time, perhaps none."""
        found: list[tuple[Any, Ended]] = []
        while True:
            try:
                generation, ended = self._answers.get(block=not found, timeout=seconds)
            except queue.Empty:
                return found
            if generation != self._generation:
                continue
            if ended is None:
                # Calls after the first `workers` had not been started.
                lost = list(self._given)[: self.workers]
                found += [(self._given.pop(number)[0], Ended(number=number, how="lost")) for number in lost]
                self._restart()
                return found
            self._silent_starts = 0
            found.append((self._given.pop(ended.number)[0], ended))

    def kill(self) -> None:
        """Kill the server and every call that runs; the calls count as lost."""
        if self._process is not None:
            self._process.kill()

    def close(self) -> None:
        """End the server and every call that still runs."""
        self._generation += 1
        self._given.clear()
        self._end_server()

    def _send(self, call: Call) -> None:
        """Send a call to the server."""
        # If the server is gone, its reader says so.
        with suppress(BrokenPipeError):
            write_all(self._requests, framed(call))

    def _restart(self) -> None:
        """Start another server in place of one that has ended."""
        self._silent_starts += 1
        code = self._end_server()
        if self._silent_starts >= STARTS_WITHOUT_AN_ANSWER:
            raise BatchStopped(
                f"the process that starts the jobs ended {self._silent_starts} times (exit code {code}); "
                "see its message above; is there enough memory?"
            )
        self._start_server()
        for _, call in self._given.values():
            self._send(call)

    def _end_server(self) -> int:
        """Let go of the server, which ends it if it has not ended; return its exit code."""
        if self._process is None:
            return 0
        os.close(self._requests)
        code = self._process.wait()
        self._process = None
        return code

    def _start_server(self) -> None:
        """Start a server, and a thread that reads its answers so that it never has to wait."""
        self._generation += 1
        if self._say is not None:
            self._say("loading kernels (the first time they are compiled, which takes about a minute)")
        theirs, self._requests = os.pipe()
        reading, answers = os.pipe()
        command = [sys.executable, "-P", "-m", "toile.dressing.batch.processes.call_server"]
        numbers = (str(number) for number in (self.workers, theirs, answers))
        self._process = subprocess.Popen(
            [*command, *numbers, f"{self._load.__module__}:{self._load.__qualname__}"],
            env=module_path_environment() | ONE_THREAD,
            stdin=subprocess.DEVNULL,
            pass_fds=(theirs, answers, *self._inherited),
            # Ctrl-C in a terminal goes to a whole group; the coordinator decides what to do about it.
            start_new_session=True,
        )
        os.close(theirs)
        os.close(answers)
        threading.Thread(
            target=_read_answers,
            args=(reading, self._generation, self._answers),
            daemon=True,
        ).start()


def _read_answers(
    reading: int,
    generation: int,
    answers: "queue.SimpleQueue[tuple[int, Ended | None]]",
) -> None:
    """Pass a server's answers on until it ends; None says that it has."""
    reader = FrameReader(reading)
    while (messages := reader.read()) is not None:
        for message in messages:
            value = None if message.value is None else pickle.loads(message.value)
            answers.put((generation, replace(message, value=value)))
    os.close(reading)
    answers.put((generation, None))
