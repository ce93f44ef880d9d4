"""Which straight segments run through the avatar, by FCL on slivers of triangles."""

import fcl
import numpy as np

from toile.collide.audit import bvh_model, crossing_faces
from toile.geometry.arrays import Bool, Float, Int


class SegmentTest:
    """Tests bundles of segments against one avatar."""

    def __init__(self, avatar: tuple[Float, Int]) -> None:
        self._avatar = fcl.CollisionObject(bvh_model(*avatar), fcl.Transform())

    def crossing(self, start: Float, end: Float) -> Bool:
        """Whether each segment from start to end [m], shapes (s, 3), crosses the avatar, shape (s,)."""
        count = len(start)
        if count == 0:
            return np.zeros(0, bool)
        corners = np.ascontiguousarray(np.stack([start, end, end + 1e-7], axis=1).reshape(-1, 3))
        slivers = fcl.CollisionObject(
            bvh_model(corners, np.arange(3 * count, dtype=np.int32).reshape(-1, 3)), fcl.Transform()
        )
        hit = np.zeros(count, bool)
        hit[crossing_faces(slivers, self._avatar)[:, 0]] = True
        return hit
