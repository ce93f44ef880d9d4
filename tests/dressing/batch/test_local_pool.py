"""Calls in processes of their own: what they return and print, and what a death takes with it."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from tests.dressing.batch.processes import children_of, server_of
from tests.dressing.batch.stand_in_jobs import nothing
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


SEEN: list[int] = []


def remember(number: int) -> list[int]:
    """Change what is global, also for libraries."""
    SEEN.append(number)
    os.environ["TOILE_TEST"] = str(number)
    os.chdir("/")
    sys.setrecursionlimit(500 + number)
    return list(SEEN)


def spin(_: object) -> None:
    """Compute for ever, deaf to what can be ignored."""
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    while True:
        sum(range(10_000_000))


def echo(content: bytes) -> bytes:
    """Print and return what is given."""
    sys.stdout.write("x" * len(content))
    return content


def chatter(_: object) -> None:
    """Print for ever."""
    while True:
        os.write(1, b"and another thing " * 1000)


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


def test_one_that_prints_for_ever_ends_in_time_and_holds_up_no_other() -> None:
    with closing(LocalPool(2, nothing)) as pool:
        ended(pool, double, 1)
        pool.start("long", chatter, None, Limits(seconds=1.0))
        pool.start("short", double, 2, Limits())
        found: list[tuple[Any, Ended]] = []
        while len(found) < 2:
            found += pool.wait(5.0)
    assert [(key, end.how) for key, end in found] == [("short", "returned"), ("long", "timeout")]
    assert found[1][1].wall_seconds < 3.0


def test_large_values_and_arguments(pool: LocalPool) -> None:
    (end,) = ended(pool, large, 5_000_000)
    assert len(end.value) == 5_000_000
    (end,) = ended(pool, len, bytes(5_000_000))
    assert end.value == 5_000_000


def test_an_error_that_is_not_caught_is_printed(pool: LocalPool) -> None:
    (end,) = ended(pool, broken, None)
    assert (end.how, end.exit_status) == ("died", 1)
    assert b"no thread on the bobbin" in end.printed


def test_a_call_that_had_not_started_is_not_lost(pool: LocalPool) -> None:
    """It runs in the server that takes the place of the one that was killed."""
    pool.start("runs", sleep, 60.0, Limits())
    pool.start("waits", double, 4, Limits())
    until = time.monotonic() + 30.0
    while not (below := children_of(server_of(pool))) and time.monotonic() < until:
        time.sleep(0.05)
    pool.kill()
    found = dict(pool.wait(10.0))
    assert {key: end.how for key, end in found.items()} == {"runs": "lost"}
    assert [(key, end.value) for key, end in pool.wait(10.0)] == [("waits", 8)]
    assert len(below) == 1 and not any(alive(pid) for pid in below)


def test_what_a_call_changes_is_gone_with_it(pool: LocalPool) -> None:
    assert [end.value for end in ended(pool, remember, 1, 2, 3)] == [[1], [2], [3]]
    assert not SEEN


def test_much_at_once_in_both_directions_does_not_jam() -> None:
    with closing(LocalPool(2, nothing)) as pool:
        content = bytes(3_000_000)
        ends = ended(pool, echo, *(content + bytes([k]) for k in range(6)))
    assert sorted(end.value[-1] for end in ends) == list(range(6))
    assert all(len(end.printed) == 1 << 20 for end in ends)


COORDINATOR = """
import sys
from tests.dressing.batch.stand_in_jobs import nothing
from tests.dressing.batch.test_local_pool import spin
from tests.dressing.batch.processes import server_of
from toile.dressing.batch.processes.isolated_call import Limits
from toile.dressing.batch.processes.local_pool import LocalPool
pool = LocalPool(2, nothing)
for key in range(2):
    pool.start(key, spin, key, Limits())
print(server_of(pool), flush=True)
pool.wait(600.0)
"""


@pytest.mark.parametrize("victims", ["coordinator", "both"])
def test_no_process_outlives_a_killed_coordinator(victims: str) -> None:
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).resolve().parents[3])}
    process = subprocess.Popen(
        [sys.executable, "-c", COORDINATOR], env=environment, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    server = int(process.stdout.readline())
    until = time.monotonic() + 30.0
    while len(calls := children_of(server)) < 2 and time.monotonic() < until:
        time.sleep(0.05)
    assert len(calls) == 2
    process.kill()
    if victims == "both":
        os.kill(server, signal.SIGKILL)
    process.wait()
    until = time.monotonic() + 10.0
    while any(alive(pid) for pid in (server, *calls)) and time.monotonic() < until:
        time.sleep(0.05)
    assert not [pid for pid in (server, *calls) if alive(pid)]
