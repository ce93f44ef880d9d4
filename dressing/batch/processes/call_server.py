"""A warm process that runs every call in a fork of itself.

It has loaded all kernels and has one thread, so a fork is safe. It starts calls as they come, kills those
that run out of time, and reports how they ended. It ends with the process that started it, and its calls
end with it.
"""

import ctypes
import faulthandler
import gc
import os
import pickle
import signal
import sys
import threading
import time
import traceback
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from typing import NoReturn

from toile.dressing.batch.processes.isolated_call import Ended, Limits

MOST_PRINTED = 1 << 20
"""How much is kept of what a call prints [bytes]."""
PIPE = 1 << 20
"""How much is read of it at once [bytes]; more than a pipe holds."""
PR_SET_PDEATHSIG = 1
"""Option of Linux's prctl: the signal that a process gets at the end of its parent."""
LOOKS = 1.0
"""Where there is none, how often a process looks whether its parent is still there [s]."""


class CallProcess:
    """A process that carries out one call, seen from the server.

    Attributes
    ----------
    number
        The call's.
    ends
        Where something may come: a connection for what the function returns, pickled, and a descriptor for
        what the process prints.
    over
        Whether the process has answered, or has ended.
    deadline
        When it must have ended, by the monotonic clock [s]; None if it need not.
    """

    def __init__(self, number: int, payload: bytes, limits: Limits, server: Sequence[Connection]) -> None:
        """Fork the process for a pickled call; it closes the connections of the server."""
        self.number, self._started = number, time.monotonic()
        self.deadline = None if limits.seconds is None else self._started + limits.seconds
        self.over = self._late = False
        self._value: bytes | None = None
        self._text = bytearray()
        self._answer, answer = Pipe(duplex=False)
        self._printed, printed = os.pipe()
        self.ends: set[Connection | int] = {self._answer, self._printed}
        parent = os.getpid()
        self._pid = os.fork()
        if not self._pid:
            try:
                _end_with(parent)
                for connection in (*server, self._answer):
                    connection.close()
                os.dup2(printed, 1)
                os.dup2(printed, 2)
                os.close(printed)
                _carry_out(payload, limits, answer)
            finally:
                os._exit(1)
        answer.close()
        os.close(printed)
        os.set_blocking(self._printed, False)

    def take(self, end: object) -> None:
        """Take what has come at one of the ends."""
        if end == self._printed:
            self._take_print()
            return
        self.over = True
        with suppress(EOFError, OSError):
            self._value = self._answer.recv_bytes()

    def _take_print(self) -> None:
        """Take what was printed by now, of which the end is kept."""
        with suppress(BlockingIOError):
            content = os.read(self._printed, PIPE)
            self._text += content
            del self._text[:-MOST_PRINTED]
            if not content:
                self.ends.discard(self._printed)

    def kill_if_late(self, now: float) -> None:
        """Kill it if it has run out of time."""
        if self.deadline is not None and now >= self.deadline and not self.over:
            self.deadline, self._late = None, True
            os.kill(self._pid, signal.SIGKILL)

    def end(self, *, kill: bool = False) -> Ended:
        """Wait until it has ended, and return how."""
        if kill:
            os.kill(self._pid, signal.SIGKILL)
        _, status, usage = os.wait4(self._pid, 0)
        self._take_print()
        self._answer.close()
        os.close(self._printed)
        returned = self._value is not None and status == 0
        return Ended(
            how="timeout" if self._late else "returned" if returned else "died",
            value=self._value if returned else None,
            exit_status=os.waitstatus_to_exitcode(status),
            wall_seconds=time.monotonic() - self._started,
            cpu_seconds=usage.ru_utime + usage.ru_stime,
            peak_memory=usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024),
            printed=bytes(self._text),
        )


def _end_with(parent: int) -> None:
    """Have this process killed when its parent ends for whatever reason: on Linux by the kernel."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)
    else:
        threading.Thread(target=_watch, args=(parent,), daemon=True).start()


def _watch(parent: int) -> None:
    """End this process once its parent is another one."""
    while os.getppid() == parent:
        time.sleep(LOOKS)
    os._exit(1)


def _carry_out(payload: bytes, limits: Limits, answer: Connection) -> NoReturn:
    """Carry out a call within its limits, send what it returned, and end this process."""
    if limits.memory is not None:
        import resource

        # Of the memory that may be written, which is what can run out, not of the address space.
        resource.setrlimit(resource.RLIMIT_DATA, (limits.memory, limits.memory))
    faulthandler.enable()
    try:
        function, argument = pickle.loads(payload)
        value = pickle.dumps(function(argument), protocol=5)
    except BaseException:
        traceback.print_exc()
        raise
    finally:
        sys.stdout.flush()
    answer.send_bytes(value)
    os._exit(0)


def serve(requests: Connection, answers: Connection) -> None:
    """Carry out calls as they come until nobody asks or listens any more; what still runs then is killed."""
    running: list[CallProcess] = []
    try:
        while True:
            ends: dict[object, CallProcess] = {end: run for run in running for end in run.ends}
            deadlines = [run.deadline for run in running if run.deadline is not None]
            left = max(min(deadlines) - time.monotonic(), 0.0) if deadlines else None
            for end in wait([requests, *(end for run in running for end in run.ends)], left):
                if end is requests:
                    number, payload, limits = requests.recv()
                    running.append(CallProcess(number, payload, limits, (requests, answers)))
                else:
                    ends[end].take(end)
            now = time.monotonic()
            for run in list(running):
                run.kill_if_late(now)
                if run.over:
                    running.remove(run)
                    answers.send((run.number, run.end()))
    except (EOFError, BrokenPipeError):
        pass
    finally:
        for run in running:
            run.end(kill=True)


def main(arguments: Sequence[str]) -> None:
    """Serve calls on two inherited descriptors after calling a function: `requests answers module:name`."""
    # Ctrl-C is for the process that started this one, which says what becomes of the calls.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    requests = Connection(int(arguments[0]), writable=False)
    answers = Connection(int(arguments[1]), readable=False)
    module, _, name = arguments[2].partition(":")
    getattr(import_module(module), name)()
    gc.collect()
    gc.freeze()
    serve(requests, answers)


if __name__ == "__main__":
    main(sys.argv[1:])
