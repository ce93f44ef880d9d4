"""Garments that are already worn, as obstacles to the next one."""

from dataclasses import replace

import numpy as np
from scipy.sparse import block_diag, csr_array
from scipy.spatial import cKDTree

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.creases import Creases
from toile.engine.cloth.fields.fields import Fields
from toile.engine.cloth.folds import Folds
from toile.engine.cloth.goals import Goals
from toile.engine.cloth.origin import Origin
from toile.geometry.arrays import Float, Int

FOLLOWS = 4
"""Vertices of the body that a node of a garment moves with."""


class Worn:
    """A body in its true shape, vertices (v, 3) [m] and faces (f, 3), and the garments on it.

    Attributes
    ----------
    faces
        Faces of body and garments, shape (f', 3).
    """

    def __init__(self, vertices: Float, faces: Int, garments: list[Cloth]) -> None:
        self._body = vertices
        parts, count = [faces], len(vertices)
        for garment in garments:
            parts.append(garment.face_nodes + np.int32(count))
            count += len(garment.positions)
        self.faces: Int = np.concatenate(parts).astype(np.int32)
        self._nodes = np.concatenate([np.empty((0, 3)), *(garment.positions for garment in garments)])

    def on(self, body: Float) -> Float:
        """Vertices of a body of another shape [m], (v, 3), and of the garments, which move along with it."""
        if not len(self._nodes):
            return body
        distance, nearest = cKDTree(self._body).query(self._nodes, k=FOLLOWS)
        weights = 1.0 / np.maximum(np.asarray(distance), 1e-9) ** 2
        weights /= weights.sum(axis=1, keepdims=True)
        moved = np.einsum("vq,vqi->vi", weights, (body - self._body)[np.asarray(nearest)])
        return np.concatenate([body, self._nodes + moved])


def worn_together(garments: list[Cloth]) -> Cloth:
    """Return garments as one cloth, faces numbered by garment in their order."""
    nodes = np.cumsum([0] + [len(cloth.positions) for cloth in garments])
    vertices = np.cumsum([0] + [len(cloth.node) for cloth in garments])
    fabrics = tuple(dict.fromkeys(fabric for cloth in garments for fabric in cloth.fabrics))
    seams = np.cumsum([0] + [int(cloth.seam.max(initial=-1)) + 1 for cloth in garments])

    def joined(name: str, first: Int | None = None) -> Int:
        """Concatenate an attribute, indices raised by `first`."""
        parts = [getattr(cloth, name) for cloth in garments]
        if first is not None:
            parts = [part + number for part, number in zip(parts, first, strict=False)]
        return np.ascontiguousarray(np.concatenate(parts), np.int32)

    fabric = [
        np.array([fabrics.index(entry) for entry in cloth.fabrics], np.int32)[cloth.fabric]
        for cloth in garments
    ]
    return replace(
        garments[0],
        positions=np.concatenate([cloth.positions for cloth in garments]),
        velocities=np.concatenate([cloth.velocities for cloth in garments]),
        node=joined("node", nodes), faces=joined("faces", vertices),
        rest_corners=np.concatenate([cloth.rest_corners for cloth in garments]),
        fabrics=fabrics, fabric=np.concatenate(fabric),
        garment=np.repeat(np.arange(len(garments), dtype=np.int32), [len(cloth.faces) for cloth in garments]),
        panel=joined("panel"), uv=np.concatenate([cloth.uv for cloth in garments]),
        stitches=joined("stitches", nodes), seam=joined("seam", seams),
        stitch_length=np.concatenate([cloth.stitch_length for cloth in garments]),
        held=joined("held", nodes), waist=joined("waist", nodes),
        pinned=np.concatenate([cloth.pinned for cloth in garments]),
        goals=Goals.together([cloth.goals for cloth in garments], [cloth.positions for cloth in garments]),
        rest_curved=np.concatenate([cloth.rest_curved for cloth in garments]),
        start_positions=np.concatenate([cloth.start_positions for cloth in garments]),
        origin=Origin.together(
            [cloth.origin for cloth in garments], [(len(cloth.node), len(cloth.faces)) for cloth in garments]
        ),
        handles=_handles(garments),
        folds=Folds.together([cloth.folds for cloth in garments], [len(cloth.faces) for cloth in garments]),
        creases=Creases.together([cloth.creases for cloth in garments], [len(c.faces) for c in garments]),
        fields=Fields.together([cloth.fields for cloth in garments], [len(c.faces) for c in garments]),
        elastic=tuple(replace(run, garment=k) for k, cloth in enumerate(garments) for run in cloth.elastic),
        holds=tuple(replace(hold, garment=k) for k, cloth in enumerate(garments) for hold in cloth.holds),
        gas=tuple(replace(gas, garment=k) for k, cloth in enumerate(garments) for gas in cloth.gas),
        fastenings=tuple(
            row.of_garment(k) for k, cloth in enumerate(garments) for row in cloth.fastenings
        ),
    )  # fmt: skip


def _handles(garments: list[Cloth]) -> csr_array | None:
    """Return the handles of garments together, or None if they have none."""
    if all(cloth.handles is None for cloth in garments):
        return None
    parts = []
    for cloth in garments:
        corners = 0 if cloth.origin is None else int(cloth.origin.first[-1])
        parts.append(csr_array((len(cloth.positions), corners)) if cloth.handles is None else cloth.handles)
    return csr_array(block_diag(parts, format="csr"))
