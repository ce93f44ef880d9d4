"""Outlines that cross or touch themselves."""

import numpy as np
import pytest

from toile.dressing.pattern.pattern_outline import crossing_sides


@pytest.mark.parametrize(
    ("height", "sides"),
    [
        (0.1, None),
        (1e-5, None),
        (1e-7, (0, 2)),
        (1e-320, (0, 2)),
        (0.0, (0, 2)),
        (-1e-7, (0, 2)),
        (-0.1, (0, 2)),
    ],
)
def test_a_corner_on_another_side_touches_it_but_for_rounding(
    height: float, sides: tuple[int, int] | None
) -> None:
    """Between sides a micrometre apart no triangle fits: meshing such a panel would never end."""
    house = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, height), (0.0, 1.0)])
    assert crossing_sides(house) == sides


def test_sides_in_one_line_are_apart() -> None:
    square = np.array([(0.0, 0.0), (0.3, 0.0), (0.6, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 1.0), (0.0, 1.0)])
    assert crossing_sides(square) is None
    turned = square @ np.array([(0.8, 0.6), (-0.6, 0.8)])
    assert crossing_sides(turned) is None
