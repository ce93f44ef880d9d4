"""Tests by FCL whether shifted rigid pieces cross each other or the avatar."""

import fcl
import numpy as np

from toile.geometry.arrays import Float, Int


def bvh_model(positions: Float, faces: Int) -> fcl.BVHModel:
    """FCL hierarchy of a triangle surface."""
    model = fcl.BVHModel()
    model.beginModel(len(faces), len(positions))
    # Its loop over triangles reads numbers of Python in half the time that it takes for those of numpy.
    model.addSubModel(positions, faces.tolist())
    model.endModel()
    return model


class RigidPieces:
    """Pieces of a surface that move as rigid bodies, and an avatar that does not.

    Attributes
    ----------
    shift
        Current translation of every piece [m], shape (p, 3).
    """

    def __init__(self, positions: Float, faces: Int, piece: Int, avatar: tuple[Float, Int] | None) -> None:
        count = int(piece.max(initial=-1)) + 1
        self.shift = np.zeros((count, 3))
        self._objects = []
        for index in range(count):
            own = faces[piece == index]
            used, local = np.unique(own, return_inverse=True)
            model = bvh_model(positions[used], local.reshape(-1, 3).astype(np.int32))
            self._objects.append(fcl.CollisionObject(model, fcl.Transform()))
        self._avatar = None if avatar is None else fcl.CollisionObject(bvh_model(*avatar), fcl.Transform())

    def _moved(self, index: int, shift: Float) -> fcl.CollisionObject:
        thing = self._objects[index]
        thing.setTransform(fcl.Transform(np.eye(3), self.shift[index] + shift))
        return thing

    def crosses_avatar(self, index: int, shift: Float) -> bool:
        """Whether piece `index`, shifted further by `shift` [m], crosses the avatar."""
        if self._avatar is None:
            return False
        result = fcl.CollisionResult()
        return bool(fcl.collide(self._moved(index, shift), self._avatar, fcl.CollisionRequest(), result))

    def surface_crosses_avatar(self, positions: Float, faces: Int) -> bool:
        """Whether another surface, vertices (n, 3) [m] and faces (t, 3), crosses the avatar."""
        if self._avatar is None:
            return False
        used, local = np.unique(faces, return_inverse=True)
        surface = fcl.CollisionObject(
            bvh_model(positions[used], local.reshape(-1, 3).astype(np.int32)), fcl.Transform()
        )
        return bool(fcl.collide(surface, self._avatar, fcl.CollisionRequest(), fcl.CollisionResult()))

    def crosses_pieces(self, index: int, shift: Float) -> list[int]:
        """Return the other pieces that piece `index`, shifted further by `shift` [m], crosses."""
        moved = self._moved(index, shift)
        found = []
        for other in range(len(self._objects)):
            if other == index:
                continue
            result = fcl.CollisionResult()
            if fcl.collide(moved, self._moved(other, np.zeros(3)), fcl.CollisionRequest(), result):
                found.append(other)
        return found
