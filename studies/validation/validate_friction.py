"""Friction: cloth slides on a slope as Coulomb's law says, a belt on a drum as Euler's does."""

from collections.abc import Iterator

import numpy as np

from toile.studies.scenes.scenes import GRAVITY
from toile.studies.validation.friction_scenes import acceleration, band_brake, incline, pulley
from toile.studies.validation.validation_row import ValidationRow, absolute_row, relative_row

BAR = 3.0
CREEP_BAR = 0.1
"""Speed of cloth that sticks [mm/s]."""
BELOW, ABOVE = 0.97, 1.03
"""Loads over the limit, at which it must stick and slide."""


def validate_friction() -> Iterator[ValidationRow]:
    """Run the incline, the band brake and the pulley."""
    for friction in (0.2, 0.4):
        times, distances, _ = incline(friction, BELOW, 1.5)
        creep = np.abs(distances[-1] - distances[-9]).max() / (times[-1] - times[-9])
        yield absolute_row(
            "friction", f"incline, mu {friction}, slope {BELOW} mu", "creep, mm/s", 1e3 * float(creep), 0.0,
            CREEP_BAR,
        )  # fmt: skip
    for friction, steepness in ((0.2, ABOVE), (0.4, ABOVE), (0.8, ABOVE), (0.4, 2.0)):
        times, distances, exact = incline(friction, steepness, 0.5)
        yield relative_row(
            "friction", f"incline, mu {friction}, slope {steepness} mu", "acceleration, m/s^2",
            acceleration(times, distances.mean(axis=1)), exact, BAR,
        )  # fmt: skip
    for degrees, towards in ((90, "weight"), (90, "pins"), (180, "pins")):
        pull, exact = band_brake(degrees, towards, 0.3)
        yield relative_row(
            "friction", f"band brake, {degrees} deg to the {towards}", "pull, N", pull, exact, BAR
        )
    for friction, share, seconds in ((0.3, ABOVE, 0.5), (0.2, 1.2, 0.3)):
        times, distances, ratio = pulley(friction, share, seconds)
        a = acceleration(times, distances)
        yield relative_row(
            "friction", f"pulley, mu {friction}, load {share} of the limit", "T2/T1",
            ratio * (GRAVITY - a) / (GRAVITY + a), float(np.exp(friction * np.pi)), BAR,
        )  # fmt: skip
