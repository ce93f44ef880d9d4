"""Constant curvature: a rolled sheet shows its rigidity about any axis, a twist its Poisson ratio."""

from collections.abc import Iterator

import numpy as np

from toile.engine.forces.bend import Bending, bending_tensor
from toile.geometry.arrays import Float, Int
from toile.studies.scenes.flat_meshes import KINDS, mesh
from toile.studies.validation.validation_row import ValidationRow, absolute_row, relative_row

EDGE = 0.06
RADIUS = 1.0
"""Of the roll [m]: edges turn by 0.06."""
POISSON = 0.3
WARP, WEFT, BIAS = 12e-6, 5e-6, 7e-6
"""Rigidities of an orthotropic sheet [N m]."""
DIRECTIONS = range(0, 180, 15)
BAR, POISSON_BAR = 2.0, 0.05
"""Percent of D; Poisson's ratio."""


def bending_of(
    points: Float, faces: Int, rigidity: tuple[float, float, float], poisson: float = 0.0
) -> Bending:
    """Return the bending of a flat sheet of rigidities (warp, weft, bias) [N m]; points (n, 2) [m]."""
    ones = np.ones(len(faces))
    tensor = bending_tensor(rigidity[0] * ones, rigidity[1] * ones, rigidity[2] * ones, poisson)
    return Bending(faces, np.ascontiguousarray(points[faces]), tensor, len(points))


def rolled(points: Float, angle: float, radius: float = RADIUS) -> Float:
    """Return a sheet rolled, without stretch, around an axis; it bends along `angle` from warp."""
    along = points @ (np.cos(angle), np.sin(angle))
    across = points @ (-np.sin(angle), np.cos(angle))
    return np.column_stack((radius * np.sin(along / radius), radius * np.cos(along / radius), across))


def rigidity_when_rolled(bending: Bending, points: Float, degrees: float) -> float:
    """Return D [N m] that the energy of a rolled square of 1 m shows: D / (2 R^2) per area."""
    return 2.0 * RADIUS**2 * bending.energy(rolled(points, np.radians(degrees)))


def validate_curvature() -> Iterator[ValidationRow]:
    """Roll and twist a square of 1 m, borders included, on three kinds of mesh."""
    for kind in KINDS:
        points, faces = mesh(kind, 1.0, 1.0, EDGE)
        bending = bending_of(points, faces, (1.0, 1.0, 1.0), POISSON)
        found = {degrees: rigidity_when_rolled(bending, points, degrees) for degrees in DIRECTIONS}
        worst = max(found, key=lambda degrees: abs(found[degrees] - 1.0))
        yield relative_row("curvature", kind, f"D_eff/D, worst: {worst} deg", found[worst], 1.0, BAR)
        twist = np.column_stack((points, points[:, 0] * points[:, 1]))
        poisson = 1.0 - bending.energy(twist)
        yield absolute_row("curvature", kind, "nu_eff of a twist", poisson, POISSON, POISSON_BAR)
        saddle = np.column_stack((points, 0.5 * (points[:, 0] ** 2 - points[:, 1] ** 2)))
        poisson = 1.0 - bending.energy(saddle)
        yield absolute_row("curvature", kind, "nu_eff of a saddle", poisson, POISSON, POISSON_BAR)
        woven = bending_of(points, faces, (WARP, WEFT, BIAS))
        for name, degrees, rigidity in (("warp", 0, WARP), ("weft", 90, WEFT), ("bias", 45, BIAS)):
            measured = rigidity_when_rolled(woven, points, degrees)
            yield relative_row(
                "curvature", f"{kind}, woven", f"D {name}, uN m", 1e6 * measured, 1e6 * rigidity, BAR
            )
