"""Step sizes: which steps are kept, which are undone, how long the next one is."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from toile.engine.film.advance import StepCounts, Way, advance
from toile.engine.film.integrators.integrator import Ask
from toile.engine.film.step_sizes import CAUTION, GROW, GROWTH, HELD, SHRINK, StepLimits, StepSizes
from toile.engine.step.options import StepOutcome
from toile.engine.step.step import ClothStepper
from toile.studies.scenes.motion import EXACT
from toile.studies.validation.oscillators import oscillator

LIMITS = StepLimits(longest=0.1, shortest=0.01)


def done(converged: bool = True, error: float | None = None) -> StepOutcome:
    return StepOutcome(moved=np.zeros(1), converged=converged, error=error)


def test_what_is_left_is_parted_equally() -> None:
    sizes = StepSizes(LIMITS, 0.1)
    assert sizes.next(0.3, 0.0) == pytest.approx(0.1)
    assert sizes.next(0.31, 0.0) == pytest.approx(0.31 / 4.0)
    assert sizes.next(0.05, 0.0) == 0.05
    # Three times 0.1 is more than 0.3 by rounding only.
    assert sizes.next(0.1 + 0.1 + 0.1, 0.0) == pytest.approx(0.1)


def test_fast_cloth_takes_shorter_steps() -> None:
    sizes = StepSizes(replace(LIMITS, motion_max=0.02), 0.1)
    assert sizes.next(1.0, 0.2) == pytest.approx(0.1)
    assert sizes.next(1.0, 2.0) == pytest.approx(0.01)
    assert sizes.next(1.0, 0.9) == pytest.approx(1.0 / 45.0)
    assert sizes.h == 0.1


def test_a_step_that_stretches_too_much_is_undone_and_halved() -> None:
    sizes = StepSizes(replace(LIMITS, stretch_rise=0.02), 0.1)
    assert not sizes.keeps(0.08, done(), 0.021)
    assert sizes.h == pytest.approx(0.04)


@pytest.mark.parametrize(
    ("again", "kept", "size"),
    [(0.02, True, 0.04), (0.041, False, 0.02), (0.043, True, 0.08), (0.061, False, 0.02)],
)
def test_a_step_whose_half_stretches_as_much_is_kept(again: float, kept: bool, size: float) -> None:
    sizes = StepSizes(replace(LIMITS, shortest=1e-3, stretch_rise=0.02), 0.1)
    assert not sizes.keeps(0.08, done(), 0.06)
    assert sizes.keeps(0.04, done(), again) is kept
    assert sizes.h == pytest.approx(size)


def test_a_step_after_one_that_was_kept_is_judged_by_itself() -> None:
    sizes = StepSizes(replace(LIMITS, shortest=1e-3, stretch_rise=0.02), 0.1)
    assert not sizes.keeps(0.08, done(), 0.05)
    assert sizes.keeps(0.04, done(), 0.05)
    assert not sizes.keeps(0.08, done(), 0.05)


def test_a_step_that_is_not_solved_is_undone_and_halved() -> None:
    sizes = StepSizes(LIMITS, 0.1)
    assert not sizes.keeps(0.1, done(converged=False), 0.0)
    assert sizes.h == pytest.approx(0.05)


@pytest.mark.parametrize(("rise", "factor"), [(-0.5, GROWTH), (0.01, GROWTH), (0.011, 1.0), (0.02, 1.0)])
def test_sizes_grow_after_steps_that_stretch_little(rise: float, factor: float) -> None:
    sizes = StepSizes(replace(LIMITS, stretch_rise=0.02), 0.05)
    assert sizes.keeps(0.05, done(), rise)
    assert sizes.h == pytest.approx(0.05 * factor)


def test_sizes_grow_up_to_the_longest() -> None:
    sizes = StepSizes(LIMITS, 0.09)
    assert sizes.keeps(0.09, done(), 0.0) and sizes.h == 0.1


def test_the_shortest_step_is_kept_and_counted_as_forced() -> None:
    sizes = StepSizes(replace(LIMITS, stretch_rise=0.02, error_rate=1e-3), 0.01)
    for outcome, rise, forced in (
        (done(converged=False), 0.0, True), (done(), 0.03, True), (done(error=1.0), 0.0, False)
    ):  # fmt: skip
        assert sizes.keeps(0.01, outcome, rise)
        assert sizes.h == 0.01
        assert sizes.forced(outcome, rise) is forced
    assert not sizes.forced(done(), 0.02)


@pytest.mark.parametrize("share", [0.05, 0.3, 0.57, 0.8, 0.82, 1.0, 1.9])
def test_sizes_follow_the_error(share: float) -> None:
    """An error of `share` times what the step may add: it grows with the third power of the size."""
    sizes = StepSizes(replace(LIMITS, longest=1.0, error_rate=1e-3), 0.2)
    assert sizes.keeps(0.1, done(error=share * 1e-4), 0.0)
    factor = CAUTION / share**0.5
    held = 1.0 <= factor <= HELD
    assert sizes.h == pytest.approx(0.1 * (1.0 if held else min(GROW, factor)))
    assert sizes.h <= 0.2


def test_sizes_that_follow_the_error_stop_at_the_longest() -> None:
    sizes = StepSizes(replace(LIMITS, error_rate=1e-3), 0.1)
    assert sizes.keeps(0.08, done(error=1e-9), 0.0) and sizes.h == 0.1


@pytest.mark.parametrize(("share", "factor"), [(2.1, 0.5), (5.0, CAUTION / 5.0**0.5), (1e4, SHRINK)])
def test_a_step_of_more_than_twice_the_allowed_error_is_undone(share: float, factor: float) -> None:
    sizes = StepSizes(replace(LIMITS, error_rate=1e-3), 0.1)
    assert not sizes.keeps(0.1, done(error=share * 1e-4), 0.0)
    assert sizes.h == pytest.approx(0.1 * factor)


def test_a_step_without_an_estimate_is_kept() -> None:
    """The first one has none: the next may be as long as two of it."""
    sizes = StepSizes(replace(LIMITS, longest=1.0, error_rate=1e-3), 0.1)
    assert sizes.keeps(0.1, done(), 0.0) and sizes.h == pytest.approx(0.1 * GROW)


def creeping(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
    """Move by 1 m/s; steps of more than 0.03 s are not solved."""
    x = stepper.x.copy()
    x[1, 0] += h
    stepper.put(x, stepper.v)
    return StepOutcome(moved=np.array([0.0, h]), converged=h < 0.03, newton_iterations=2, cg_iterations=5)


def carried(limits: StepLimits, way: Way, first: float) -> tuple[ClothStepper, StepCounts, list[StepOutcome]]:
    stepper, counts = oscillator(), StepCounts()
    kept = list(advance(stepper, way, StepSizes(limits, first), (0.0, 0.1), counts))
    return stepper, counts, kept


def test_undone_steps_leave_nothing_but_their_iterations() -> None:
    way = Way(integrator=creeping, ask=EXACT.request)
    stepper, counts, kept = carried(replace(LIMITS, longest=0.025), way, 0.1)
    assert stepper.x[1, 0] == pytest.approx(1.1, abs=1e-12)
    assert (counts.steps, counts.retries, counts.forced) == (4, 2, 0)
    assert counts.newton_iterations == 12 and counts.cg_iterations == 30
    assert counts.simulated_seconds == pytest.approx(0.1, abs=1e-12)
    assert len(kept) == 4 and all(outcome.converged for outcome in kept)


def test_steps_that_cannot_be_shorter_are_forced() -> None:
    way = Way(integrator=creeping, ask=EXACT.request)
    stepper, counts, _ = carried(StepLimits(longest=0.05, shortest=0.05), way, 0.05)
    assert (counts.steps, counts.retries, counts.forced) == (2, 0, 2)
    assert stepper.x[1, 0] == pytest.approx(1.1, abs=1e-12)


def test_stretch_is_what_a_step_adds_to_it() -> None:
    """It rises by 0.1 per second: a step of 0.025 s by 0.0025."""
    stepper, counts = oscillator(), StepCounts()
    way = Way(integrator=creeping, ask=EXACT.request, stretch=lambda: 5.0 + 0.1 * float(stepper.x[1, 0]))
    limits = StepLimits(longest=0.025, stretch_rise=0.002)
    taken = list(advance(stepper, way, StepSizes(limits, 0.025), (0.0, 0.1), counts))
    assert counts.retries == 1 and counts.steps == len(taken) == 8
    assert max(float(outcome.moved[1]) for outcome in taken) <= 0.02


def test_what_drives_cloth_shortens_steps_before_it_moves() -> None:
    limits = StepLimits(longest=inf, shortest=0.01, motion_max=0.02)
    for speed, steps in ((0.0, 4), (2.0, 10)):
        way = Way(integrator=creeping, ask=EXACT.request, driven_speed=speed)
        assert carried(limits, way, 0.025)[1].steps == steps


def test_stages_are_asked_for_at_their_own_times() -> None:
    asked: list[float] = []

    def noted(stepper: ClothStepper, h: float, ask: Ask) -> StepOutcome:
        asked.extend((ask(0.25 * h, 0.25).seconds, ask(0.75 * h, 1.0).seconds))
        assert ask(0.25 * h, 0.25).h == pytest.approx(0.25 * h)
        return done()

    stepper, way = oscillator(), Way(integrator=noted, ask=EXACT.request)
    list(advance(stepper, way, StepSizes(StepLimits(longest=0.05), 0.05), (3.0, 0.1), StepCounts()))
    assert asked == pytest.approx([3.0125, 3.05, 3.0625, 3.1])


@pytest.mark.parametrize("seconds", [1.0 / 30.0, 1.0 / 24.0, 0.1, 1.0])
@pytest.mark.parametrize("longest", [1.0 / 120.0, 1.0 / 60.0, 0.01, 0.05])
def test_steps_that_never_go_well_come_to_their_end(seconds: float, longest: float) -> None:
    """By rounding, equal parts of the time left may be a little longer than the shortest size."""
    for divisor in (3.0, 4.0, 7.0, 8.0, 16.0, 30.0):
        sizes = StepSizes(StepLimits(longest=longest, shortest=longest / divisor), longest)
        left, tried = seconds, 0
        while left > 1e-9 * seconds:
            h = sizes.next(left, 0.0)
            tried += 1
            assert tried < 10_000
            if sizes.keeps(h, done(converged=False), 0.0):
                left -= h
