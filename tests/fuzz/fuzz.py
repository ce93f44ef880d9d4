"""Reads mutated inputs and finds what is neither read nor refused as it should be."""

import random
import signal
import sys
import time
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from tests.fuzz.mutate import mutated
from tests.fuzz.readers import READERS, valid_files
from toile.geometry.errors import InputError

LIMIT_SECONDS = 10.0
"""CPU seconds, so that other programs on the machine make no findings."""
LIMIT_WAITING = 300
"""Seconds after which what uses no CPU time is ended."""
LIMIT_BYTES = 1 << 30


class TooSlow(BaseException):
    """Not an Exception, so that no reader takes it for a broken file."""


@dataclass(frozen=True)
class Finding:
    """An input that broke a reader, and how."""

    reader: str
    number: int
    what: str


def fuzz(name: str, count: int, folder: Path, first: int = 0) -> Iterator[Finding]:
    """Read `count` mutations of a reader's inputs, numbered from `first`; yield those that break it.

    The input that is being read lies in the folder, as `input` with its ending.
    """
    for number in range(first, first + count):
        random_ = random.Random(f"{name} {number}")
        suffix, data = random_.choice(valid_files(name))
        path = folder / f"input{suffix}"
        path.write_bytes(mutated(data, suffix, random_))
        for read in READERS[name].reads:
            begin = time.process_time()
            try:
                with limits(), warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    read(path)
            except InputError as error:
                if "\n" in str(error):
                    yield Finding(name, number, f"more than a line: {error!s}")
            except KeyboardInterrupt:
                raise
            except BaseException:
                yield Finding(name, number, traceback.format_exc(limit=-6))
            seconds = time.process_time() - begin
            if seconds > LIMIT_SECONDS:
                yield Finding(name, number, f"took {seconds:.1f} CPU s")


@contextmanager
def limits() -> Iterator[None]:
    """End what takes too long or too much memory, where the system can."""
    if sys.platform == "win32":
        yield
        return
    import resource

    def end(number: int, frame: FrameType | None) -> None:
        raise TooSlow

    numbers = (signal.SIGALRM, signal.SIGPROF)
    before = [signal.signal(number, end) for number in numbers]
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    if sys.platform == "linux":
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + LIMIT_BYTES, hard))
    signal.alarm(LIMIT_WAITING)
    signal.setitimer(signal.ITIMER_PROF, LIMIT_SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        for number, handler in zip(numbers, before, strict=True):
            signal.signal(number, handler)
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
