"""Calls on this machine, a limited number at a time, through a warm server process."""

import pickle
import queue
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any

from toile.dressing.batch.processes.isolated_call import Ended, Limits, PoolFailed
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
Answers = queue.SimpleQueue[tuple[int, Ended] | None]


class LocalPool:
    """Up to `workers` calls at a time, each in a process of its own, forked from a server."""

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
        self._load, self._say, self._inherited = load, say, tuple(inherited)
        self._keys: dict[int, Any] = {}
        self._waiting: deque[tuple[int, bytes, Limits]] = deque()
        self._count = self._silent_starts = 0
        self._process: subprocess.Popen[bytes] | None = None
        self._requests: Connection
        self._answers: Answers = queue.SimpleQueue()

    @property
    def room(self) -> int:
        """Number of calls that it can take now: one waits, so that it starts as soon as another ends."""
        return self.workers + 1 - self.unfinished

    @property
    def unfinished(self) -> int:
        """Calls that have not ended yet."""
        return len(self._keys)

    @property
    def running(self) -> int:
        """Those of them that run; the others wait."""
        return len(self._keys) - len(self._waiting)

    def start(self, key: Any, function: Callable[[Any], Any], argument: Any, limits: Limits) -> None:
        """Have a function called that is importable by name; `wait` reports its end under `key`."""
        if self._process is None:
            self._start_server()
        self._count += 1
        self._keys[self._count] = key
        self._waiting.append((self._count, pickle.dumps((function, argument), protocol=5), limits))
        self._send_waiting()

    def wait(self, seconds: float) -> list[tuple[Any, Ended]]:
        """Return the calls that have ended, with their keys; after some time, perhaps none."""
        found: list[tuple[Any, Ended]] = []
        while True:
            try:
                answer = self._answers.get(block=not found, timeout=seconds)
            except queue.Empty:
                return found
            if answer is None:
                waiting = {number for number, _, _ in self._waiting}
                lost = [number for number in self._keys if number not in waiting]
                found += [(self._keys.pop(number), Ended(how="lost")) for number in lost]
                self._restart()
                return found
            self._silent_starts = 0
            found.append((self._keys.pop(answer[0]), answer[1]))
            self._send_waiting()

    def withdraw(self) -> list[Any]:
        """Take back the calls that wait, and return their keys."""
        waiting = [self._keys.pop(number) for number, _, _ in self._waiting]
        self._waiting.clear()
        return waiting

    def kill(self) -> None:
        """End the server and every call that runs; the calls count as lost."""
        if self._process is not None:
            self._process.kill()

    def close(self) -> None:
        """End the server and every call that still runs."""
        self._keys.clear()
        self._waiting.clear()
        self._end_server()

    def _send_waiting(self) -> None:
        """Send calls to the server, as many as may run."""
        while self._waiting and self.running < self.workers:
            # If the server is gone, its reader says so.
            with suppress(BrokenPipeError):
                self._requests.send(self._waiting.popleft())

    def _restart(self) -> None:
        """Start another server in place of one that has ended."""
        self._silent_starts += 1
        code = self._end_server()
        if self._silent_starts >= STARTS_WITHOUT_AN_ANSWER:
            raise PoolFailed(
                f"the process that starts the jobs ended {self._silent_starts} times (exit code {code}); "
                "see its message above; is there enough memory?"
            )
        self._start_server()
        self._send_waiting()

    def _end_server(self) -> int:
        """Let go of the server, which ends it if it has not ended; return its exit code."""
        if self._process is None:
            return 0
        self._requests.close()
        code = self._process.wait()
        self._process = None
        return code

    def _start_server(self) -> None:
        """Start a server, and a thread that reads its answers so that it never has to wait."""
        if self._say is not None:
            self._say("loading kernels (the first time they are compiled, which takes about a minute)")
        theirs, self._requests = Pipe(duplex=False)
        reading, answers = Pipe(duplex=False)
        self._answers = queue.SimpleQueue()
        ends = theirs.fileno(), answers.fileno()
        command = [sys.executable, "-P", "-m", "toile.dressing.batch.processes.call_server", *map(str, ends)]
        self._process = subprocess.Popen(
            [*command, f"{self._load.__module__}:{self._load.__qualname__}"],
            env=module_path_environment() | ONE_THREAD,
            stdin=subprocess.DEVNULL,
            pass_fds=(*ends, *self._inherited),
            # Ctrl-C in a terminal goes to a whole group; the coordinator decides what to do about it.
            start_new_session=True,
        )
        theirs.close()
        answers.close()
        threading.Thread(target=_read_answers, args=(reading, self._answers), daemon=True).start()


def _read_answers(reading: Connection, answers: Answers) -> None:
    """Pass a server's answers on until it ends; None says that it has."""
    with reading:
        while True:
            try:
                number, ended = reading.recv()
            except (EOFError, OSError):
                break
            value = None if ended.value is None else pickle.loads(ended.value)
            answers.put((number, replace(ended, value=value)))
    answers.put(None)
