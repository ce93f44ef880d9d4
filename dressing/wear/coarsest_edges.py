"""How long the edges of an adaptive mesh may become, by the size of garments and by what they lie on.

A mesh is refined where it bends. A sheet in a few triangles cannot bend: it lies on a ball like a board, and
nothing ever refines it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.sewn_pins import is_sewn_up
from toile.geometry.arrays import Float, Int
from toile.geometry.normals import area_normals
from toile.remesh.sizing.sizing import SizingOptions

ACROSS = 2.5
"""Longest edges across a square of the area of a garment, at least."""
PLANE = 0.05
"""Extent across its plane, over that along it, up to which a garment starts as a sheet."""


def fitting_sizing(
    sizing: SizingOptions | None, garments: Sequence[GarmentMesh], vertices: Float, faces: Int
) -> SizingOptions | None:
    """Return the sizing with its longest edges cut down to what garments and body ask for, or None.

    No edge is longer than two fifths of the side of a square of the smallest garment's area. Where a garment
    starts as a sheet, no edge turns by more than `refine_angle` on a ball that has as much volume per surface
    as the body, closed, vertices (v, 3) [m] and faces (f, 3).
    """
    if sizing is None:
        return None
    longest = min(sizing.size_max, *(np.sqrt(_rest_area(mesh)) / ACROSS for mesh in garments))
    if any(starts_as_sheet(mesh) for mesh in garments):
        longest = min(longest, sizing.refine_angle * _mean_radius(vertices, faces))
    return replace(sizing, size_max=max(float(longest), sizing.size_min))


def starts_as_sheet(mesh: GarmentMesh) -> bool:
    """Whether a garment starts in a plane and is not sewn: only the body will bend it."""
    if is_sewn_up(mesh):
        return False
    spread = np.linalg.svd(mesh.positions - mesh.positions.mean(axis=0), compute_uv=False)
    return bool(spread[2] <= PLANE * spread[1])


def _rest_area(mesh: GarmentMesh) -> float:
    """Area of the cloth of a garment [m^2]."""
    sides = mesh.rest_corners[:, 1:] - mesh.rest_corners[:, :1]
    return float(0.5 * np.abs(np.linalg.det(sides)).sum())


def _mean_radius(vertices: Float, faces: Int) -> float:
    """Radius of a ball with the volume per surface of a closed surface [m]."""
    corners = vertices[faces]
    normals = area_normals(corners)
    volume = abs(float(np.einsum("tc,tc->", corners.mean(axis=1), normals))) / 6.0
    return 3.0 * volume / (0.5 * float(np.linalg.norm(normals, axis=1).sum()))
