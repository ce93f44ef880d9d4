"""Stick and slip: a strip clamped upright at its top bends aside as its tip is pushed up, until it slips.

The tip holds as long as the friction coefficient is above the share of the push that points sideways.
"""

from collections.abc import Iterator

import numpy as np

from toile.geometry.arrays import Float
from toile.studies.scenes.flat_meshes import KINDS
from toile.studies.validation.heavy_strip import ElasticStrip, clamped_strip
from toile.studies.validation.validation_row import ValidationRow, relative_row

CRITICAL: dict[float, dict[float, float]] = {
    0.0: {0.05: 0.10354, 0.1: 0.15279, 0.2: 0.23777, 0.3: 0.32649},
    5.0: {0.05: 0.11154, 0.1: 0.16428, 0.2: 0.25472, 0.3: 0.34851},
    10.0: {0.05: 0.11849, 0.1: 0.17433, 0.2: 0.26967, 0.3: 0.36812},
}
"""Friction coefficient below which the tip slips, by Gamma = weight per area L^3 / D and by the push over L.

From the boundary value problem theta'' = (Gamma (1 - s) - R_y) sin theta - R_x cos theta, theta(0) = 0,
theta'(1) = 0, of the angle from straight down over the arc length s; the integral of sin theta is 0, that of
cos theta 1 less the push. R_x and R_y are the forces on the tip, the coefficient is |R_x| / R_y.
"""
WIDTH, EDGES_PER_LENGTH = 0.1, 40
BULGE = 0.83
"""Of the shape to start from, in roots of the push."""
BAR = 3.0


def critical_friction(kind: str, gamma: float, push: float) -> float:
    """Return |R_x| / R_y at the tip of a strip of the given kind of mesh in equilibrium."""
    strip = clamped_strip(kind, WIDTH, 1.0 / EDGES_PER_LENGTH)
    elastic = ElasticStrip(strip)
    along = np.maximum(strip.points[:, 0], 0.0)
    behind = strip.points[:, 0] - along
    x: Float = np.column_stack(
        (
            BULGE * np.sqrt(push) * along * np.sin(np.pi * along),
            -along * (1.0 - push) - behind,
            strip.points[:, 1],
        )
    )
    x = elastic.settled(x, gamma, strip.held | elastic.tip)
    force = elastic.gradient(x, gamma)[elastic.tip].sum(axis=0)
    return float(abs(force[0]) / force[1])


def validate_stick_slip() -> Iterator[ValidationRow]:
    """Push strips of three kinds of mesh up, without weight and under two."""
    for kind in KINDS:
        for gamma, curve in CRITICAL.items():
            for push, exact in curve.items():
                yield relative_row(
                    "stick_slip", f"{kind}, Gamma {gamma:g}", f"critical mu, pushed by {push:g} L",
                    critical_friction(kind, gamma, push), exact, BAR,
                )  # fmt: skip
