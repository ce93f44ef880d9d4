"""Calls in processes that are forked ahead: what they return and print, and what a death takes with it."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from typing import Any

import pytest

from tests.dressing.batch.processes import children_of, server_of
from tests.dressing.batch.stand_in_jobs import nothing
from toile.dressing.batch.processes.huge_pages import _allocated
from toile.dressing.batch.processes.isolated_call import Ended, Limits
from toile.dressing.batch.processes.local_pool import LocalPool


def double(number: int) -> int:
    """Return twice a number."""
    return 2 * number


def talk(lines: int) -> int:
    """Print much, let go of the standard output, and go on for a while."""
    for line in range(lines):
        print(f"line {line} " + "x" * 90)
    sys.stdout.flush()
    os.close(1)
    os.close(2)
    time.sleep(0.5)
    return lines


def large(size: int) -> bytes:
    """Return many bytes."""
    return bytes(size)


def sleep(seconds: float) -> float:
    """Take time."""
    time.sleep(seconds)
    return seconds


def broken(_: object) -> None:
    """Fail."""
    raise RuntimeError("no thread on the bobbin")


@pytest.fixture
def pool() -> Iterator[LocalPool]:
    """A pool of one worker."""
    with closing(LocalPool(1, nothing)) as opened:
        yield opened


def ended(pool: LocalPool, function: Callable[[Any], Any], *arguments: object) -> list[Ended]:
    """Call a function with each argument, and return how that ended."""
    for argument in arguments:
        pool.start(argument, function, argument, Limits())
    found: list[Ended] = []
    while pool.unfinished:
        found += [end for _, end in pool.wait(1.0)]
    return found


def alive(pid: int) -> bool:
    """Whether a process runs; one that is dead may wait for the system to take note."""
    done = subprocess.run(["ps", "-o", "stat=", "-p", str(pid)], capture_output=True, text=True)
    return bool(done.stdout.strip()) and not done.stdout.startswith("Z")


def test_calls_return_in_order(pool: LocalPool) -> None:
    assert [end.value for end in ended(pool, double, *range(20))] == [2 * k for k in range(20)]


def test_much_that_is_printed_ends_no_call(pool: LocalPool) -> None:
    (end,) = ended(pool, talk, 30_000)
    assert end.value == 30_000
    lines = end.printed.decode().splitlines()
    assert lines[-1].startswith("line 29999 ") and len(end.printed) <= 1 << 20
    assert end.cpu_seconds < 0.5


def test_large_values_and_arguments(pool: LocalPool) -> None:
    (end,) = ended(pool, large, 5_000_000)
    assert len(end.value) == 5_000_000
    (end,) = ended(pool, len, bytes(5_000_000))
    assert end.value == 5_000_000


def test_an_error_that_is_not_caught_is_printed(pool: LocalPool) -> None:
    (end,) = ended(pool, broken, None)
    assert (end.how, end.exit_status) == ("died", 1)
    assert b"no thread on the bobbin" in end.printed


def test_a_waiting_process_may_be_killed(pool: LocalPool) -> None:
    """It costs no call: another is forked."""
    ended(pool, double, 1)
    (spare,) = children_of(server_of(pool))
    os.kill(spare, signal.SIGKILL)
    time.sleep(0.2)
    assert [end.value for end in ended(pool, double, 2, 3)] == [4, 6]


def test_a_call_that_had_not_started_is_not_lost(pool: LocalPool) -> None:
    """The one at hand in the server that was killed runs in the next."""
    pool.start("runs", sleep, 60.0, Limits())
    pool.start("waits", double, 4, Limits())
    until = time.monotonic() + 30.0
    while len(below := children_of(server_of(pool))) < 2 and time.monotonic() < until:
        time.sleep(0.05)
    pool.kill()
    found = dict(pool.wait(10.0))
    assert {key: end.how for key, end in found.items()} == {"runs": "lost"}
    assert [(key, end.value) for key, end in pool.wait(10.0)] == [("waits", 8)]
    assert len(below) == 2 and not any(alive(pid) for pid in below)


@pytest.mark.skipif(sys.platform != "linux", reason="huge pages are Linux's")
def test_areas_that_are_allocated() -> None:
    maps = (
        "5566000-5586000 rw-p 00000000 00:00 0                          [heap]\n"
        "7f0000-7f4000 rw-p 00000000 00:00 0 \n"
        "7f4000-7f8000 r--p 00000000 00:00 0 \n"
        "7f8000-7fa000 rw-p 00001000 fe:00 31  /usr/lib/a name.so\n"
        "7fffd000-7ffff000 rw-p 00000000 00:00 0                          [stack]\n"
    )
    assert _allocated(maps) == [(0x5566000, 0x5586000), (0x7F0000, 0x7F4000)]
