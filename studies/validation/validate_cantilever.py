"""Cantilever: a strip clamped level sags under its weight as the heavy elastica does."""

from collections.abc import Iterator

from toile.studies.scenes.flat_meshes import KINDS
from toile.studies.validation.heavy_strip import clamped_strip, equilibrium
from toile.studies.validation.validation_row import ValidationRow, relative_row

ELASTICA = {
    0.01: 0.00125000, 0.1: 0.0124996, 1.0: 0.124562, 3.16228: 0.383305, 10.0: 1.06680, 31.6228: 2.65047,
    100.0: 5.88810, 316.228: 11.5128, 1000.0: 21.3354,
}  # fmt: skip
"""Gamma = weight per area L^3 / D to H/W, drop of the tip over its reach.

From the boundary value problem theta'' = Gamma (1 - s) cos theta, theta(0) = 0, theta'(1) = 0, of the angle
below the horizontal over the arc length s; H and W are the integrals of sin theta and cos theta.
"""
WIDTH, EDGES_PER_LENGTH = 0.1, 80
STIFFNESS = 1e6
"""Of the membrane, times L^2 / D: at Gamma 1000 the strip stretches by 0.1 % where it hangs."""
BAR = 2.0


def validate_cantilever() -> Iterator[ValidationRow]:
    """Let strips of three kinds of mesh sag, under more and more weight."""
    for kind in KINDS:
        states = equilibrium(clamped_strip(kind, WIDTH, 1.0 / EDGES_PER_LENGTH), list(ELASTICA), STIFFNESS)
        for (gamma, exact), (drop, reach) in zip(ELASTICA.items(), states, strict=True):
            yield relative_row("cantilever", kind, f"H/W at Gamma {gamma:g}", drop / reach, exact, BAR)
