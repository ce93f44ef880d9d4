"""A process that is forked ahead, waits for one call, carries it out and ends."""

import faulthandler
import os
import pickle
import resource
import signal
import sys
import traceback
from collections.abc import Iterable
from contextlib import suppress

from toile.dressing.batch.processes.end_with_parent import end_with
from toile.dressing.batch.processes.isolated_call import FrameReader, Limits, framed, write_all


class CallProcess:
    """The process, seen from the one that has forked it.

    Attributes
    ----------
    pid
        Its number.
    answer
        Descriptor on which the value comes that the function returned, see `framed`; closed at the
        process's end.
    printed
        Descriptor on which its standard output and standard error come. Reading either does not wait.
    """

    def __init__(self, close: Iterable[int]) -> None:
        """Fork the process; `close` are descriptors that it must not hold."""
        call, self._call = os.pipe()
        self.answer, answer = os.pipe()
        self.printed, printed = os.pipe()
        parent = os.getpid()
        self.pid = os.fork()
        if not self.pid:
            try:
                end_with(parent)
                for descriptor in (self._call, self.answer, self.printed, *close):
                    os.close(descriptor)
                os.dup2(printed, 1)
                os.dup2(printed, 2)
                os.close(printed)
                _carry_out(call, answer)
            finally:
                os._exit(1)
        for descriptor in (call, answer, printed):
            os.close(descriptor)
        for descriptor in (self.answer, self.printed):
            os.set_blocking(descriptor, False)

    def hand(self, payload: bytes, limits: Limits) -> bool:
        """Hand it its call, a pickled pair of function and argument; False if it is no longer there."""
        try:
            write_all(self._call, framed((payload, limits)))
        except BrokenPipeError:
            return False
        finally:
            os.close(self._call)
        return True

    def kill(self) -> None:
        """Kill it, if it has not ended."""
        with suppress(ProcessLookupError):
            os.kill(self.pid, signal.SIGKILL)

    def reap(self) -> tuple[int, resource.struct_rusage]:
        """Wait until it has ended; return its status and what it has used."""
        os.close(self.answer)
        os.close(self.printed)
        _, status, usage = os.wait4(self.pid, 0)
        return status, usage


def _carry_out(call: int, answer: int) -> None:
    """Wait for a call, carry it out within its limits, write what it returned to a pipe, and end."""
    reader = FrameReader(call)
    while not (messages := reader.read()):
        if messages is None:
            os._exit(0)
    payload, limits = messages[0]
    if limits.memory is not None:
        # Of the memory that may be written, which is what can run out, not of the address space.
        resource.setrlimit(resource.RLIMIT_DATA, (limits.memory, limits.memory))
    faulthandler.enable()
    try:
        function, argument = pickle.loads(payload)
        value = framed(function(argument))
    except BaseException:
        traceback.print_exc()
        raise
    finally:
        sys.stdout.flush()
    write_all(answer, value)
    os._exit(0)
