"""Straight segments that run through the avatar, found by FCL on slivers of triangles."""

import fcl
import numpy as np

from toile.collide.rigid_pieces import bvh_model
from toile.geometry.arrays import Bool, Float, Int

WIDTH = 1e-7
"""Width of the slivers that stand for segments [m]."""
MAX_CONTACTS = 60_000


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


class SegmentTest:
    """Tests bundles of segments against one avatar."""

    def __init__(self, avatar: tuple[Float, Int]) -> None:
        self._avatar = fcl.CollisionObject(bvh_model(*avatar), fcl.Transform())

    def crossing(self, start: Float, end: Float) -> Bool:
        """Whether each segment from start to end [m], shapes (s, 3), crosses the avatar, shape (s,)."""
        hit = np.zeros(len(start), bool)
        hit[self.hits(start, end)[:, 0]] = True
        return hit

    def hits(self, start: Float, end: Float) -> Int:
        """Segments from start to end [m], shapes (s, 3), and the faces that they cross, as pairs (k, 2)."""
        count = len(start)
        if count == 0:
            return np.empty((0, 2), np.int32)
        along = end - start
        # A sliver needs some width: across the axis that the segment follows least.
        across = np.cross(along, np.eye(3)[np.abs(along).argmin(axis=1)])
        across *= WIDTH / np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
        corners = np.ascontiguousarray(np.stack([start, end, end + across], axis=1).reshape(-1, 3))
        slivers = fcl.CollisionObject(
            bvh_model(corners, np.arange(3 * count, dtype=np.int32).reshape(-1, 3)), fcl.Transform()
        )
        return crossing_faces(slivers, self._avatar)
