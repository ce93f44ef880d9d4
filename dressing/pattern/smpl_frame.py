"""Patterns placed in the frame of SMPL, whose origin lies in the chest of the body, moved up."""

import numpy as np

from toile.dressing.pattern.pattern import Pattern
from toile.dressing.pattern.pattern_outline import default_segments, outline, to_world
from toile.geometry.arrays import Float

BELOW_FEET = 0.15
"""A pattern that reaches so far below the feet of a body is not placed about it [m]."""
ORIGIN_HEIGHT = 0.67
"""Height of SMPL's origin above the feet of its template, as a share of the body's height."""


def on_the_floor(pattern: Pattern, body: Float) -> Pattern:
    """Return the pattern moved up to a body, shape (n, 3), if it is placed for an origin at the chest.

    That is the case if it reaches far below the feet, and lies within the body's height once it is moved. The
    templates of GarmentPatternGenerator, NeuralTailor and Sewformer are placed so.
    """
    feet, crown = float(body[:, 1].min()), float(body[:, 1].max())
    heights = np.concatenate(
        [to_world(panel, outline(panel, default_segments(panel))[0])[:, 1] for panel in pattern.panels]
    )
    up = ORIGIN_HEIGHT * (crown - feet) + feet
    fits = heights.min() + up > feet - BELOW_FEET and heights.max() + up < crown + BELOW_FEET
    if heights.min() > feet - BELOW_FEET or not fits:
        return pattern
    note = (
        f"The pattern is placed for a body with its origin at the chest (SMPL) and starts {up:.2f} m higher."
    )
    return pattern.moved((0.0, up, 0.0), note)
