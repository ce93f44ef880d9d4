"""Proposed changes that move the surface, which the caller may refuse."""

from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Bool, Float, Int


class Proposals(NamedTuple):
    """Changes to a mesh that do not touch each other: no face belongs to two of them.

    Attributes
    ----------
    triangles
        New triangles as node triples, shape (q, 3).
    owner
        The proposal that each new triangle belongs to, shape (q,).
    removed
        Faces that they replace, shape (r,).
    removed_owner
        The proposal that each replaced face belongs to, shape (r,).
    rest_corners, removed_rest_corners
        Rest shapes of new triangles and of the faces they replace, (warp, weft) [m], shapes (q, 3, 2) and
        (r, 3, 2).
    origin, removed_origin
        Face, at the start of the pass, that each of them comes from, shapes (q,) and (r,).
    face_nodes
        All faces before the changes, as node triples, shape (t, 3).
    proposal_count
        Number of proposals.
    """

    triangles: Int
    owner: Int
    removed: Int
    removed_owner: Int
    rest_corners: Float
    removed_rest_corners: Float
    origin: Int
    removed_origin: Int
    face_nodes: Int
    proposal_count: int


class Accept(Protocol):
    """Decides which proposals are carried out."""

    def __call__(self, positions: Float, proposals: Proposals) -> Bool:
        """Tell which proposals are accepted, shape (p,), given the node positions [m], shape (n, 3)."""
        ...


class Gate:
    """Asks for acceptance and remembers refusals, so that nothing is asked twice in one pass.

    Attributes
    ----------
    refused
        Keys of what has been refused, sorted.
    """

    def __init__(self, accept: Accept | None) -> None:
        self._accept = accept
        self.refused = np.empty(0, np.int64)

    def passed(self, positions: Float, proposals: Proposals, keys: npt.NDArray[np.int64]) -> Bool:
        """Tell which proposals are accepted, shape (p,); remembers the keys of the others."""
        if self._accept is None or not proposals.proposal_count:
            return np.ones(proposals.proposal_count, bool)
        accepted = np.asarray(self._accept(positions, proposals), bool)
        if not accepted.all():
            self.refused = np.sort(np.concatenate([self.refused, keys[~accepted]]))
        return accepted
