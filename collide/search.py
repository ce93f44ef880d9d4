"""Contact search of one cloth topology against one avatar, with candidates carried over between steps."""

import numpy as np

from toile.collide import bvh
from toile.collide.avatar_surface import AvatarSurface, moving_boxes
from toile.collide.candidates import Hierarchy, Vertices, find_candidates
from toile.collide.cover import Cover
from toile.collide.merged_pairs import Measured, replaced, unmeasured, with_marked, with_pairs_of
from toile.collide.surface import Surface, surface_of
from toile.geometry.arrays import Bool, Float, Int

NO_PAIRS = np.empty((0, 4), np.int32)


class ContactSearch:
    """Candidate pairs that stay complete while no node has used up its allowed motion.

    Attributes
    ----------
    positions
        Cloth nodes followed by avatar vertices [m]: the array that all pairs index.
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
        self._self_contact = self_contact
        self._radius_self = radius_self
        self.radius_body = radius_body
        self._count = len(weld)
        self._own_weld = weld
        self._boxes = np.empty((len(face_nodes), 12))
        self.rebuilds = 0
        self.meet(avatar)

    def meet(self, avatar: AvatarSurface | None, roam: Cover | None = None) -> None:
        """Search against another avatar, or none, from here on, as if nothing had been searched before.

        `roam` says where nodes meet no more than this avatar, if it is part of a larger one; None: anywhere.
        """
        count = self._count
        others = 0 if avatar is None else len(avatar.vertices)
        self._avatar, self._roam = avatar, roam
        self.positions = np.empty((count + others, 3))
        own = np.arange(others, dtype=np.int32) + np.int32(count)
        self.weld = np.concatenate([self._own_weld, own]).astype(np.int32)
        self._ghost = np.zeros(count + others, bool)
        self._reach = np.zeros(count + others)
        self._avatar_surface: Surface | None = None
        if avatar is not None:
            self.positions[count:] = avatar.vertices
            shifted = avatar.surface.faces + np.int32(count)
            self._avatar_surface = Surface(shifted, avatar.surface.owned)
        self._tree: bvh.Bvh | None = None
        self._among_cloth = self._with_body = Cover(np.full((count, 3), np.nan), np.zeros(count), None)
        self._avatar_origin = np.empty((0, 3))
        self._of_body = self._of_cloth = unmeasured((NO_PAIRS, NO_PAIRS))

    def place(self, x: Float) -> None:
        """Set the current positions of cloth nodes and avatar vertices, without searching."""
        self.positions[: self._count] = x
        if self._avatar is not None:
            self.positions[self._count :] = self._avatar.vertices

    @property
    def body(self) -> tuple[Int, Int]:
        """(vertex-face, edge-edge) candidates against the avatar, shapes (n, 4) and (m, 4)."""
        return self._of_body.pairs

    @property
    def cloth(self) -> tuple[Int, Int]:
        """(vertex-face, edge-edge) candidates within the cloth, shapes (n, 4) and (m, 4)."""
        return self._of_cloth.pairs

    def measured(self, body: tuple[Float, Float], cloth: tuple[Float, Float]) -> None:
        """Take note of the distances of all candidates as things are [m]."""
        self._of_body, self._of_cloth = Measured(self.body, body), Measured(self.cloth, cloth)

    @property
    def distances(self) -> tuple[Float, Float]:
        """Distances of all pairs as they were measured last [m]; not a number where they were not."""
        body, cloth = self._of_body.distances, self._of_cloth.distances
        return np.concatenate([body[0], cloth[0]]), np.concatenate([body[1], cloth[1]])

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
        """Make all allowances void, because what may touch has changed."""
        self._among_cloth.origin[:] = np.nan
        self._with_body.origin[:] = np.nan

    def forget(self) -> None:
        """Let go of all candidates; the next search finds them anew."""
        self._of_body = self._of_cloth = unmeasured((NO_PAIRS, NO_PAIRS))
        self.expire()

    def expire_body(self) -> None:
        """Make allowances against the avatar void: it has moved."""
        self._with_body.origin[:] = np.nan

    def allowance(self, x: Float, avatar: Float | None = None) -> Float:
        """How far each node may still move from x before the candidates are incomplete [m], shape (n,).

        Negative where a node has moved too far already; not a number before the first search. With the places
        of the avatar's vertices, shape (v, 3), theirs follow, shape (n + v,).
        """
        if self._avatar is None:
            return self._among_cloth.allowance(x)
        left = self.left_with_body(x, avatar)
        if self._self_contact:
            count = self._count
            left[:count] = np.minimum(left[:count], self._among_cloth.allowance(x))
        return left

    def left_in_cloth(self, x: Float) -> Float:
        """How far each node may still move from x before candidates within the cloth are incomplete [m]."""
        return self._among_cloth.allowance(x) if self._self_contact else np.full(len(x), np.inf)

    def left_with_body(self, x: Float, avatar: Float | None = None) -> Float:
        """How far each node, and vertex, may still move before candidates against the avatar are [m]."""
        if self._avatar is None:
            return np.full(len(x), np.inf)
        if avatar is None:
            return self._within_roam(x, self._with_body.allowance(x))
        surface, cover = self._avatar, self._with_body
        still = np.zeros_like(x) if cover.drift is None else cover.drift
        moving = np.zeros_like(avatar) if surface.drift is None else surface.drift
        both = Cover(
            np.concatenate([cover.origin, self._avatar_origin]),
            np.concatenate([cover.allowed, surface.motion]),
            np.concatenate([still, moving]),
            0 if surface.drift is None else self._count,
        )
        return self._within_roam(x, both.allowance(np.concatenate([x, avatar])))

    def _within_roam(self, x: Float, left: Float) -> Float:
        """Take back what nodes at x [m], shape (n, 3), may move beyond where they may be; shape of `left`."""
        if self._roam is not None:
            left[: self._count] = np.minimum(left[: self._count], self._roam.allowance(x))
        return left

    def covers(self, x: Float, avatar: Float | None = None) -> bool:
        """Whether the candidates are complete for nodes at x and on the straight way there.

        `avatar` are the places of its vertices then [m], shape (v, 3); without it they have not moved.
        """
        return bool((self.allowance(x, avatar) >= 0.0).all())

    def covers_cloth(self, x: Float) -> bool:
        """Whether the candidates within the cloth are complete for nodes at x and on the way there."""
        return bool((self.left_in_cloth(x) >= 0.0).all())

    def covers_body(self, x: Float) -> bool:
        """Whether the candidates against a still avatar are complete for nodes at x and on the way there."""
        return bool((self.left_with_body(x) >= 0.0).all())

    def search(self, x: Float, motion: Float, *, drift: Float | None = None) -> None:
        """Find all pairs that can touch while every node moves at most `motion` [m], shape (n,), from x.

        With a `drift` [m], shape (n, 3), nodes may move as far from places that drift along, from x to x +
        drift all at the same pace: pairs that drift together are not listed.
        """
        self.search_cloth(x, motion, drift=drift)
        self.search_body(x, motion, drift=drift)

    def search_cloth(self, x: Float, motion: Float, *, drift: Float | None = None) -> None:
        """Find all pairs within the cloth, as `search` does."""
        self.rebuilds += 1
        if not self._self_contact:
            return
        self._begin(x, motion)
        self._among_cloth = Cover(x.copy(), motion.copy(), None if drift is None else drift.copy())
        ends = self._ends(drift)
        self._of_cloth = unmeasured(find_candidates(self._vertices(ends), self._own(ends), None))

    def search_body(self, x: Float, motion: Float, *, drift: Float | None = None) -> None:
        """Find all pairs of cloth and avatar, as `search` does."""
        if self._avatar is None or self._avatar_surface is None:
            return
        self._begin(x, motion)
        self._with_body = Cover(x.copy(), motion.copy(), None if drift is None else drift.copy())
        self._avatar_origin = self._avatar.vertices
        ends = self._ends(drift, self._avatar.drift)
        own = self._own(ends)
        self._reach[self._count :] = self._body_reach()
        tree = self._avatar.tree(
            self._reach[self._count :], None if self._avatar.drift is None else ends[self._count :]
        )
        body = Hierarchy(self._avatar_surface, self._avatar.boxes, tree)
        self._of_body = unmeasured(find_candidates(self._vertices(ends), own, body))

    def widen_cloth(self, x: Float, room: float, few: int) -> bool:
        """Complete the candidates within the cloth for nodes at x, if few are beyond; whether they are now.

        Only what those nodes can touch is searched, with `room` [m] to spare.
        """
        if not self._self_contact:
            return True
        beyond = self._beyond(self._among_cloth, self._among_cloth.allowance(x), room, few)
        if beyond is None or not beyond.any():
            return beyond is not None
        marked = np.pad(beyond, (0, len(self.weld) - self._count))
        self._begin(self._among_cloth.origin, self._among_cloth.allowed)
        ends = self._ends(self._among_cloth.drift)
        part = self._part(self._surface, marked, ends)
        found = find_candidates(self._vertices(ends), part, self._own(ends))
        self._of_cloth = with_pairs_of(marked, self._of_cloth, found)
        return True

    def widen_body(self, x: Float, avatar: Float | None, room: float, few: int) -> bool:
        """Do the same against the avatar, whose vertices, at (v, 3) [m] then, may be beyond, too."""
        if self._avatar is None or self._avatar_surface is None:
            return True
        left = self.left_with_body(x, avatar)
        beyond = self._beyond(self._with_body, left[: self._count], room, few)
        if beyond is None:
            return False
        if avatar is None:
            marked = np.pad(beyond, (0, len(self.weld) - self._count))
        else:
            strayed = ~(left[self._count :] >= 0.0)
            if np.count_nonzero(strayed) > few:
                return False
            self._avatar.motion[strayed] += room - left[self._count :][strayed]
            marked = np.concatenate([beyond, strayed])
        if not marked.any():
            return True
        self._begin(self._with_body.origin, self._with_body.allowed)
        self.positions[self._count :] = self._avatar_origin
        ends = self._ends(self._with_body.drift, self._avatar.drift)
        if marked[self._count :].any():
            self._reach[self._count :] = self._body_reach()
            self._avatar.tree(self._reach[self._count :], ends[self._count :])
        body = Hierarchy(self._avatar_surface, self._avatar.boxes, self._avatar.known_tree)
        own = np.pad(beyond, (0, len(marked) - self._count))
        if own.any():
            part = self._part(self._surface, own, ends)
            found = find_candidates(self._vertices(ends), part, body)
            self._of_body = replaced(own, self._of_body, found)
        if marked[self._count :].any():
            marked[: self._count] = False
            part = self._part(self._avatar_surface, marked, ends)
            found = find_candidates(self._vertices(ends), self._own(ends), part)
            self._of_body = replaced(marked, self._of_body, found)
        return True

    def _body_reach(self) -> Float:
        """Reach of the avatar's vertices [m], shape (v,)."""
        assert self._avatar is not None
        return np.asarray(self.radius_body - 0.5 * self._radius_self + self._avatar.motion)

    def _beyond(self, cover: Cover, left: Float, room: float, few: int) -> Bool | None:
        """Mark nodes without allowance left, shape (n,), and allow them more; None if they are many."""
        beyond = ~(left >= 0.0)
        if np.count_nonzero(beyond) > few:
            return None
        cover.allowed[beyond] += room - left[beyond]
        return np.asarray(beyond)

    def _part(self, surface: Surface, marked: Bool, ends: Float) -> Hierarchy:
        """Return the faces of marked vertices, shape (n + v,), on their way to `ends`, to be searched."""
        having = with_marked(marked, surface.faces)
        # What has a marked vertex is owned by a face that has one.
        part = Surface(surface.faces[having], surface.owned[having])
        boxes = np.empty((len(part.faces), 12))
        moving_boxes(self.positions, ends, part.faces, self._reach, boxes)
        return Hierarchy(part, boxes, None)

    def _vertices(self, ends: Float) -> Vertices:
        """All vertices as a search sees them, on their way to `ends` [m], shape (n, 3)."""
        return Vertices(self.positions, self.weld, self._ghost, self._reach, ends)

    def _begin(self, x: Float, motion: Float) -> None:
        """Place the nodes and give them their reach for a search."""
        self.place(x)
        self._reach[: self._count] = 0.5 * self._radius_self + motion

    def _ends(self, drift: Float | None, avatar_drift: Float | None = None) -> Float:
        """Return the places that all vertices drift to [m], shape (n, 3)."""
        if drift is None and avatar_drift is None:
            return self.positions
        ends = self.positions.copy()
        if drift is not None:
            ends[: self._count] += drift
        if avatar_drift is not None:
            ends[self._count :] += avatar_drift
        return ends

    def _own(self, ends: Float) -> Hierarchy:
        """Hierarchy over the cloth's faces, moving to their ends and grown by their reach."""
        moving_boxes(self.positions, ends, self._surface.faces, self._reach, self._boxes)
        if self._tree is None:
            self._tree = bvh.build(self._boxes)
        else:
            bvh.refit(self._tree, self._boxes)
        return Hierarchy(self._surface, self._boxes, self._tree)
