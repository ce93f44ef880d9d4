"""Independent audit of every frame: exact triangle-triangle intersection by FCL.

It shares no code with the contact search: broad phase, hierarchy and triangle test are FCL's.
"""

from dataclasses import dataclass

import fcl
import numpy as np

from toile.geometry.arrays import Float, Int
from toile.geometry.cells import Cells

MAX_CONTACTS = 60_000
SHRINK = 1e-5
ASIDE = 1e-11 * np.array([0.61, 0.53, 0.59])
"""Shift of a surface that is tested against itself [m], so that no triangle meets itself."""


@dataclass(frozen=True)
class Crossings:
    """Crossing face pairs: (cloth face, avatar face) and within the cloth, shape (k, 2)."""

    avatar: Int
    cloth: Int


def bvh_model(positions: Float, faces: Int) -> fcl.BVHModel:
    """FCL hierarchy of a triangle surface."""
    model = fcl.BVHModel()
    model.beginModel(len(faces), len(positions))
    # Its loop over triangles reads numbers of Python in half the time that it takes for those of numpy.
    model.addSubModel(positions, faces.tolist())
    model.endModel()
    return model


def crossing_faces(a: fcl.CollisionObject, b: fcl.CollisionObject) -> Int:
    """All crossing face pairs of two triangle surfaces, each once, shape (k, 2)."""
    limit = MAX_CONTACTS
    while True:
        result = fcl.CollisionResult()
        fcl.collide(a, b, fcl.CollisionRequest(num_max_contacts=limit), result)
        if len(result.contacts) < limit:
            break
        limit *= 8
    pairs = np.array([(c.b1, c.b2) for c in result.contacts], np.int32).reshape(-1, 2)
    return np.unique(pairs, axis=0)


def shrunk_surface(positions: Float, faces: Int) -> fcl.BVHModel:
    """FCL hierarchy of a surface, every triangle shrunk by SHRINK about its centroid.

    Neighbours touch by construction; what still meets crosses, also where two triangles share a corner.
    """
    corners = positions[faces]
    centroid = corners.mean(axis=1, keepdims=True)
    apart = np.ascontiguousarray((centroid + (1.0 - SHRINK) * (corners - centroid)).reshape(-1, 3))
    return bvh_model(apart, np.arange(len(apart), dtype=np.int32).reshape(-1, 3))


def crossings_within(positions: Float, faces: Int, weld: Int) -> Int:
    """Face pairs of a surface that cross each other, each once, shape (k, 2).

    Parameters
    ----------
    positions, faces
        The surface [m], shapes (n, 3) and (t, 3).
    weld
        Vertices with the same number are being sewn together; face pairs that share such a number but
        not the vertex itself lie on the two sides of an open seam and are not counted, shape (n,).

    Faces of the very same plane that overlap in it touch, and do not count.
    """
    return _crossings_of(shrunk_surface(positions, faces), faces, weld)


def _crossings_of(surface: fcl.BVHModel, faces: Int, weld: Int) -> Int:
    """Face pairs of a shrunk surface that cross each other: see crossings_within."""
    # The shift keeps triangles from meeting themselves, reporting which took as long as all the rest. Every
    # pair is tested twice, each side shifted once, so a pair that crosses by more than the shift is found.
    here, aside = (fcl.CollisionObject(surface, fcl.Transform(shift)) for shift in (np.zeros(3), ASIDE))
    pairs = np.unique(np.sort(crossing_faces(here, aside), axis=1), axis=0)
    pairs = pairs[pairs[:, 0] < pairs[:, 1]]
    a, b = faces[pairs[:, 0]], faces[pairs[:, 1]]
    other_vertex = a[:, :, None] != b[:, None, :]
    across_open_seam = (other_vertex & (weld[a][:, :, None] == weld[b][:, None, :])).any(axis=(1, 2))
    return np.asarray(pairs[~across_open_seam], np.int32)


class Auditor:
    """Counts crossing triangle pairs of cloth against one avatar and itself."""

    def __init__(self, avatar_vertices: Float | None, avatar_faces: Int | None) -> None:
        self._body: tuple[Float, Int] | None = None
        if avatar_vertices is not None and avatar_faces is not None:
            self._body = avatar_vertices, avatar_faces
        self._near: Int = np.empty(0, np.int32)
        self._model: fcl.CollisionObject | None = None
        self._cells: Cells | None = None

    def audit(self, positions: Float, faces: Int, weld: Int) -> Crossings:
        """Crossings of the cloth surface.

        Parameters
        ----------
        positions, faces
            Cloth surface [m], shapes (n, 3) and (t, 3).
        weld
            As for `crossings_within`.
        """
        cloth = shrunk_surface(positions, faces)
        against = np.empty((0, 2), np.int32)
        if self._body is not None and len(positions):
            self._look_around(positions, faces, *self._body)
        if self._model is not None:
            against = crossing_faces(fcl.CollisionObject(cloth, fcl.Transform()), self._model)
            against[:, 1] = self._near[against[:, 1]]
        return Crossings(against, _crossings_of(cloth, faces, weld))

    def _look_around(self, positions: Float, cloth: Int, vertices: Float, faces: Int) -> None:
        """Make the avatar ready around cloth at these positions [m], shape (n, 3), of faces (t, 3).

        Heads, hands and feet have most of its faces. One that lies in no cell of a grid that cloth comes near
        crosses none of it.
        """
        near = Cells.around(positions, cloth)
        if self._cells is not None and self._cells.include(near):
            return
        self._cells = near.grown()
        self._near = self._cells.faces_within(vertices, faces)
        used, local = np.unique(faces[self._near], return_inverse=True)
        self._model = None
        if len(used):
            model = bvh_model(np.ascontiguousarray(vertices[used]), local.reshape(-1, 3).astype(np.int32))
            self._model = fcl.CollisionObject(model, fcl.Transform())
