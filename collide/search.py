"""The contact search of one cloth topology against one avatar: candidates carried over between steps."""

import numpy as np
from numba import types

from toile.collide import bvh
from toile.collide.candidates import find_candidates
from toile.collide.surface import Surface, surface_of
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import F64_1, F64_2, I32_2, OUT_F64_2, kernel

NO_PAIRS = np.empty((0, 4), np.int32)


@kernel(types.void(F64_2, I32_2, F64_1, OUT_F64_2))
def _grown_boxes(p, faces, reach, boxes):  # type: ignore[no-untyped-def]
    """Boxes of faces [m], shape (t, 6), each grown by the largest reach of its vertices."""
    for t in range(faces.shape[0]):
        a = faces[t, 0]
        b = faces[t, 1]
        c = faces[t, 2]
        grow = max(reach[a], reach[b], reach[c])
        for axis in range(3):
            boxes[t, axis] = min(p[a, axis], p[b, axis], p[c, axis]) - grow
            boxes[t, axis + 3] = max(p[a, axis], p[b, axis], p[c, axis]) + grow


class AvatarSurface:
    """An avatar, ready to be searched: shared by all topologies of a run.

    Attributes
    ----------
    vertices
        Current positions [m], shape (v, 3); change them through `move_to`.
    motion
        How far each vertex may move before the next search [m], shape (v,).
    """

    def __init__(self, vertices: Float, faces: Int) -> None:
        self.vertices = vertices.copy()
        self.faces = faces
        self.surface = surface_of(faces)
        self.motion = np.zeros(len(vertices))
        self.boxes = np.empty((len(faces), 6))
        self._tree: bvh.Bvh | None = None
        self._reach = np.full(len(vertices), -1.0)

    def move_to(self, vertices: Float) -> None:
        """Put the vertices elsewhere; the next search refits the hierarchy."""
        self.vertices = vertices
        self._reach[:] = -1.0

    def tree(self, reach: Float) -> bvh.Bvh:
        """Hierarchy over the faces, each grown by the largest reach of its vertices [m], shape (v,)."""
        if self._tree is None or not np.array_equal(reach, self._reach):
            _grown_boxes(self.vertices, self.faces, reach, self.boxes)
            self._reach = reach.copy()
            if self._tree is None:
                self._tree = bvh.build(self.boxes)
            else:
                bvh.refit(self._tree, self.boxes)
        return self._tree

    @property
    def vertex_area(self) -> Float:
        """A third of the area of the faces around each vertex [m^2], shape (v,)."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        shares = np.repeat(area / 3.0, 3)
        count = len(self.vertices)
        return np.asarray(np.bincount(self.faces.ravel(), weights=shares, minlength=count), np.float64)


class ContactSearch:
    """Candidate pairs that stay complete while no node has used up its allowed motion.

    Attributes
    ----------
    positions
        Cloth nodes followed by avatar vertices [m]: the array that all pairs index.
    body, cloth
        (vertex-face, edge-edge) candidates against the avatar and within the cloth.
    weld
        Future node of every row of `positions`, shape (n,): sewn vertices share it.
    radius_body
        Contact radius against the avatar that the next search covers [m].
    rebuilds
        How many times candidates were searched anew.
    """

    def __init__(
        self,
        face_nodes: Int,
        weld: Int,
        avatar: AvatarSurface | None,
        *,
        self_contact: bool,
        radius_self: float,
        radius_body: float,
    ) -> None:
        self._surface = surface_of(face_nodes)
        self._avatar = avatar
        self._self_contact = self_contact
        self._radius_self = radius_self
        self.radius_body = radius_body
        count = len(weld)
        others = 0 if avatar is None else len(avatar.vertices)
        self._count = count
        self.positions = np.empty((count + others, 3))
        self.weld = np.concatenate([weld, np.arange(others, dtype=np.int32) + count]).astype(np.int32)
        self._ghost = np.zeros(count + others, bool)
        self._reach = np.zeros(count + others)
        self._avatar_surface: Surface | None = None
        if avatar is not None:
            self.positions[count:] = avatar.vertices
            shifted = avatar.surface.faces + np.int32(count)
            self._avatar_surface = Surface(shifted, avatar.surface.owns_vertex, avatar.surface.owns_edge)
        self._boxes = np.empty((len(face_nodes), 6))
        self._tree: bvh.Bvh | None = None
        self._origin = np.full((count, 3), np.nan)
        self._allowed = np.zeros(count)
        self._drift: Float | None = None
        self.body: tuple[Int, Int] = (NO_PAIRS, NO_PAIRS)
        self.cloth: tuple[Int, Int] = (NO_PAIRS, NO_PAIRS)
        self.rebuilds = 0

    def place(self, x: Float) -> None:
        """Set the current positions of cloth nodes and avatar vertices, without searching."""
        self.positions[: self._count] = x
        if self._avatar is not None:
            self.positions[self._count :] = self._avatar.vertices

    @property
    def pairs(self) -> tuple[Int, Int]:
        """All candidates, against the avatar and within the cloth: vertex-face, edge-edge, each (k, 4)."""
        return np.concatenate([self.body[0], self.cloth[0]]), np.concatenate([self.body[1], self.cloth[1]])

    @property
    def all_faces(self) -> Int:
        """Faces of the cloth, then of the avatar, as triples of rows of `positions`, shape (t, 3)."""
        if self._avatar_surface is None:
            return self._surface.faces
        return np.concatenate([self._surface.faces, self._avatar_surface.faces])

    def let_pass(self, ghost: Bool) -> None:
        """Let marked cloth nodes and avatar vertices, shape (n,), pass through each other but no other."""
        self._ghost[:] = ghost
        self.expire()

    def expire(self) -> None:
        """Make all allowances void: the avatar has moved."""
        self._origin[:] = np.nan

    def allowance(self, x: Float) -> Float:
        """How far each node may still move from x before the candidates are incomplete [m], shape (n,).

        Negative where a node has moved too far already; not a number before the first search.
        """
        away = x - self._origin
        if self._drift is not None:
            away -= _pace(away, self._drift) * self._drift
        used = np.sqrt(np.einsum("ij,ij->i", away, away))
        return np.asarray(self._allowed - used)

    def covers(self, x: Float) -> bool:
        """Whether the candidates are complete for nodes at x and on the straight way there."""
        return bool((self.allowance(x) >= 0.0).all())

    def search(self, x: Float, motion: Float, *, drift: Float | None = None, body_only: bool = False) -> None:
        """Find all pairs that can touch while every node moves at most `motion` [m], shape (n,), from x.

        With a `drift` [m], shape (n, 3), nodes may move as far from places that drift along, from x to x +
        drift all at the same pace: pairs that drift together are not listed. `body_only` leaves the pairs
        within the cloth as they were: enough to move the avatar alone.
        """
        self.place(x)
        self._origin = x.copy()
        self._allowed = motion.copy()
        self._drift = None if drift is None else drift.copy()
        self._reach[: self._count] = 0.5 * self._radius_self + motion
        self.rebuilds += 1
        if self._self_contact and not body_only:
            # Common motion does not matter among the cloth itself.
            ends = self._ends(None if drift is None else drift - drift.mean(axis=0))
            tree = self._own_tree(ends)
            self.cloth = find_candidates(
                self.positions, self.weld, self._ghost, self._surface, self._boxes, tree, None, self._boxes,
                tree, self._reach, ends,
            )  # fmt: skip
        if self._avatar is not None and self._avatar_surface is not None:
            ends = self._ends(drift)
            own = self._own_tree(ends)
            self._reach[self._count :] = self.radius_body - 0.5 * self._radius_self + self._avatar.motion
            tree = self._avatar.tree(self._reach[self._count :])
            self.body = find_candidates(
                self.positions, self.weld, self._ghost, self._surface, self._boxes, own, self._avatar_surface,
                self._avatar.boxes, tree, self._reach, ends,
            )  # fmt: skip

    def _ends(self, drift: Float | None) -> Float:
        """Return the places that all vertices drift to [m], shape (n, 3)."""
        if drift is None:
            return self.positions
        ends = self.positions.copy()
        ends[: self._count] += drift
        return ends

    def _own_tree(self, ends: Float) -> bvh.Bvh:
        """Hierarchy over the cloth's faces, swept to their ends and grown by their reach."""
        _grown_boxes(self.positions, self._surface.faces, self._reach, self._boxes)
        if ends is not self.positions:
            swept = np.empty_like(self._boxes)
            _grown_boxes(ends, self._surface.faces, self._reach, swept)
            np.minimum(self._boxes[:, :3], swept[:, :3], out=self._boxes[:, :3])
            np.maximum(self._boxes[:, 3:], swept[:, 3:], out=self._boxes[:, 3:])
        if self._tree is None:
            self._tree = bvh.build(self._boxes)
        else:
            bvh.refit(self._tree, self._boxes)
        return self._tree


def _pace(away: Float, drift: Float) -> float:
    """How much of their drift nodes have done, 0 to 1: the median of those that drift farthest.

    Any common share is valid; that of most nodes leaves the least to the others' allowance.
    """
    square = np.einsum("ij,ij->i", drift, drift)
    far = square >= 0.25 * square.max()
    if not square.max() > 0.0:
        return 0.0
    done = np.einsum("ij,ij->i", away[far], drift[far]) / square[far]
    return float(np.clip(np.median(done), 0.0, 1.0))
