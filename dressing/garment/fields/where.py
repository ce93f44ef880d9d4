"""Checks of where something lies on a garment: beside a run of edges, or within a polygon."""

from collections.abc import Sequence

from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real

LEAST_WIDTH, MOST_WIDTH = 0.001, 10.0
"""Limits of the width of a band [m]."""


def check_where(
    what: str, run: str | None, width: float | None, polygon: Sequence[tuple[float, float]]
) -> None:
    """Raise InputError, which begins with `what`, unless a band or a polygon says where something lies."""
    if (run is None) != (width is None):
        raise InputError(
            f"{what}: run and width belong together: a band of that width beside it", field="width"
        )
    if width is not None and not (is_real(width) and LEAST_WIDTH <= width <= MOST_WIDTH):
        raise InputError(
            f"{what}: width must lie between {LEAST_WIDTH:g} and {MOST_WIDTH:g} m, got {width!r}",
            field="width",
        )
    if polygon and (len(polygon) < 3 or not all(len(p) == 2 and all(map(is_real, p)) for p in polygon)):
        raise InputError(
            f"{what}: polygon must have three corners (x, y) at least, got {list(polygon)!r}",
            field="polygon",
        )
    if polygon and run is not None:
        raise InputError(f"{what}: give a run with a width or a polygon, not both", field="polygon")
