"""Work in parts: the same answer from any number of threads, errors in order, forks."""

import os
import sys
import threading

import numpy as np
import pytest

from toile.geometry.threads.crew import ALONE, crew_of, in_parts, together


def rows(first: int, last: int) -> list[int]:
    return list(range(first, last))


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_parts_come_in_order(threads: int) -> None:
    alone = [list(range(10))]
    with crew_of(threads):
        for _ in range(50):
            found = in_parts(rows, 10, 4)
            assert found == (alone if threads == 1 else [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9]])
        assert in_parts(rows, 4, 4) == [[0, 1, 2, 3]]
        assert in_parts(rows, 0, 4) == []
    # A thread that is alone takes longer parts.
    assert in_parts(rows, 2 * ALONE + 1, 2) == [list(range(2 * ALONE)), [2 * ALONE]]


def test_threads_work_at_the_same_time_and_are_gone_afterwards() -> None:
    before = threading.active_count()
    meet = threading.Barrier(3, timeout=10.0)
    with crew_of(3):
        assert threading.active_count() == before + 2
        # No part goes on before three have begun.
        in_parts(lambda first, last: meet.wait(), 3, 1)
    assert threading.active_count() == before


def test_the_error_of_the_first_part_that_fails_is_raised_and_work_goes_on() -> None:
    def fail(first: int, last: int) -> None:
        if first >= 20:
            raise ValueError(str(first))

    with crew_of(3):
        for _ in range(20):
            with pytest.raises(ValueError, match=r"^20$"):
                in_parts(fail, 100, 10)
        assert in_parts(rows, 2, 1) == [[0], [1]]
    assert in_parts(rows, 2, 1) == [[0, 1]]


def test_parts_may_be_cut_in_parts() -> None:
    with crew_of(3):
        for _ in range(20):
            found = in_parts(
                lambda first, last: [row for part in in_parts(rows, last, 2) for row in part], 9, 3
            )
            assert found == [list(range(last)) for last in (3, 6, 9)]


@pytest.mark.skipif(not hasattr(os, "fork") or sys.platform == "darwin", reason="needs fork")
def test_a_forked_process_works_alone() -> None:
    with crew_of(2):
        child = os.fork()
        if child == 0:
            os._exit(0 if in_parts(rows, 4, 2) == [[0, 1, 2, 3]] else 1)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_rows_are_put_together() -> None:
    assert together([], 2).shape == (0, 2) and together([]).dtype == np.int32
    one = np.arange(4, dtype=np.int32).reshape(2, 2)
    assert together([one], 2) is one
    assert together([one, one[:1]], 2).tolist() == [[0, 1], [2, 3], [0, 1]]
