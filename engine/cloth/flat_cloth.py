"""A cloth of one flat panel, made from a mesh in one call."""

import numpy as np
import numpy.typing as npt

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.creases import Creases
from toile.engine.cloth.fabric import Fabric
from toile.geometry.arrays import as_faces, as_positions
from toile.geometry.errors import InputError


def flat_cloth(
    points: npt.ArrayLike, faces: npt.ArrayLike, positions: npt.ArrayLike, fabric: Fabric,
    pinned: npt.ArrayLike | None = None,
) -> Cloth:  # fmt: skip
    """Return a cloth of one flat panel at rest, without stitches; every vertex is a node.

    Parameters
    ----------
    points
        Rest shape: place of every node along (warp, weft) [m], shape (n, 2).
    faces
        Triangles, counter-clockwise in `points`, shape (t, 3).
    positions
        Where the nodes start [m], shape (n, 3): stretched or bent, if they are not as far apart as `points`.
    fabric
        What the panel is made of.
    pinned
        Marks nodes that no force moves, shape (n,), bool; None: all move.

    Raises
    ------
    InputError
        If an array has another shape or is not finite, or if a face refers to a node that is not there, runs
        clockwise or has no area.
    """
    try:
        start = as_positions(positions).copy()
        triangles = as_faces(faces, len(start))
    except ValueError as error:
        raise InputError(f"flat_cloth: {error}") from None
    count = len(start)
    flat = np.array(points, np.float64)
    if flat.shape != (count, 2) or not np.isfinite(flat).all():
        raise InputError(
            f"flat_cloth: points must be finite, of shape ({count}, 2) like positions, got {flat.shape}"
        )
    free = np.zeros(count, bool) if pinned is None else np.array(pinned)
    if free.shape != (count,) or free.dtype != bool:
        raise InputError(
            f"flat_cloth: pinned marks nodes, a bool for each of the {count}; got {free.dtype} {free.shape}"
        )
    none, zeros = np.empty(0, np.int32), np.zeros(len(triangles), np.int32)
    cloth = Cloth(
        positions=start, velocities=np.zeros_like(start), node=np.arange(count, dtype=np.int32),
        faces=triangles, rest_corners=np.ascontiguousarray(flat[triangles]), fabrics=(fabric,), fabric=zeros,
        garment=zeros, panel=zeros, uv=flat, stitches=np.empty((0, 2), np.int32), seam=none,
        stitch_length=np.empty(0), held=none, waist=none, pinned=free,
        rest_curved=np.zeros(len(triangles), bool), start_positions=start.copy(),
        creases=Creases.of((fabric,), len(triangles)),
    )  # fmt: skip
    turned = np.flatnonzero(cloth.rest_area <= 0.0)
    if len(turned):
        raise InputError(
            f"flat_cloth: {len(turned)} faces run clockwise or have no area in points (first: face "
            f"{turned[0]}); swap two of their corners",
            faces=turned.tolist(),
        )
    return cloth
