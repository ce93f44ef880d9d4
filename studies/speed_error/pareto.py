"""The Pareto front of error and CPU time."""

import math
from collections.abc import Sequence

from toile.studies.speed_error.point import Point


def pareto_front(points: Sequence[Point]) -> list[Point]:
    """Return the points that no other beats in error and CPU time, the quickest first.

    Results with crossings, and those that broke down, are on no front: they are not what was asked for.
    """
    front: list[Point] = []
    sound = [point for point in points if not point.crossings and math.isfinite(point.error)]
    for point in sorted(sound, key=lambda point: (point.cpu, point.error)):
        if not front or point.error < front[-1].error:
            front.append(point)
    return front
