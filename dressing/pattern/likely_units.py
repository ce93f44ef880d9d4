"""Units of pattern files that do not say them."""

import math
from collections.abc import Mapping
from typing import Any

LARGEST_WITHOUT_UNITS = 300.0
"""Size of a panel in a file without units from which they are millimetres, not centimetres."""


def likely_units(body: Mapping[str, Any]) -> tuple[float, str]:
    """Return the units per metre of panels that do not say them, and their name: no panel exceeds 3 m."""
    raw = body.get("panels")
    panels = list(raw.values()) if isinstance(raw, Mapping) else []
    corners = [panel.get("vertices") for panel in panels if isinstance(panel, Mapping)]
    size = 0.0
    for points in corners:
        numbers = [
            [float(number) for number in point if isinstance(number, int | float)]
            for point in (points if isinstance(points, list) else [])
            if isinstance(point, list)
        ]
        pairs = [point for point in numbers if len(point) == 2]
        for axis in (0, 1):
            values = [point[axis] for point in pairs] or [0.0]
            size = max(size, max(values) - min(values))
    # NaN and infinities are named where the panel is read.
    return (1000.0, "millimetres") if LARGEST_WITHOUT_UNITS < size < math.inf else (100.0, "centimetres")
