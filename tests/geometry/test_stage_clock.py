"""The clock of stages: CPU and wall time side by side, and sums per stage."""

from time import process_time, sleep

import pytest

from toile.geometry.stage_clock import Spent, StageClock, now, together


def test_a_stage_that_waits_takes_wall_time_and_one_that_computes_takes_both() -> None:
    clock, started = StageClock(), now()
    waited = clock.add("wait", started)
    until = process_time() + 0.05
    while process_time() < until:
        pass
    clock.add("compute", waited)
    # A second booking of the same stage adds to the first.
    since = clock.now()
    sleep(0.05)
    clock.add("wait", since)
    whole = now().less(started)
    assert clock.spent["wait"].wall >= 0.05 and clock.spent["wait"].cpu < 0.03
    assert clock.cpu("compute") >= 0.05 and clock.spent["compute"].wall >= clock.cpu("compute") - 0.01
    assert clock.cpu("never") == 0.0
    summed = clock.spent["wait"].plus(clock.spent["compute"])
    assert whole.cpu == pytest.approx(summed.cpu, abs=0.02)
    assert whole.wall == pytest.approx(summed.wall, abs=0.05)


def test_times_of_parts_are_added_stage_by_stage() -> None:
    sums = together({"solve": Spent(1.0, 2.0)}, {"solve": Spent(0.5, 0.5), "io": Spent(0.25, 3.0)})
    assert sums == {"solve": Spent(1.5, 2.5), "io": Spent(0.25, 3.0)}
    assert together() == {}
