"""Pins with times: springs towards places, whose strength is keyed over a film."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from toile.engine.cloth.fields.keyed import Keyed
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float
from toile.remesh.adapt.transfer import TransferMap


@dataclass(frozen=True, kw_only=True)
class RunHold:
    """Where a film holds a garment: what pins with times are made from at its start.

    Attributes
    ----------
    garment, panel
        The panel.
    lines
        Straight pieces of the edges that are held, in rest space [m], shape (k, 2, 3); None: the whole panel.
    share
        How much of the stiffness acts over the film.
    stiffness
        Per area [N/m^3].
    follow
        Whether places go along with the avatar.
    """

    garment: int
    panel: int
    lines: Float | None
    share: Keyed
    stiffness: float
    follow: bool


@dataclass(frozen=True, kw_only=True)
class TimedPins:
    """Springs per area, E = s(t)/2 integral of k |x - place|^2 over the rest area, lumped at the nodes.

    Attributes
    ----------
    stiffness
        k at every node [N/m^3], shape (n,); 0 where nothing is pinned.
    places
        Where nodes are pinned [m], shape (n, 3), before `motion` takes them along.
    share
        s: how much of the stiffness acts, over time.
    weights
        Weight of every point of `motion` in every node, sparse (n, p), or None: places stay.
    motion
        Points that take places along, by how far they are from where they are at `since`.
    since
        Time at which nodes are where `places` says [s].
    """

    stiffness: Float
    places: Float
    share: Keyed
    weights: csr_array | None = None
    motion: VertexMotion | None = None
    since: float = 0.0

    def carried(self, transfer: TransferMap) -> "TimedPins":
        """Return the pins of the same cloth on another mesh."""
        marked = transfer.marked_nodes(self.stiffness > 0.0)
        return TimedPins(
            stiffness=np.where(marked, transfer.at_nodes(self.stiffness), 0.0),
            places=transfer.at_nodes(self.places),
            share=self.share,
            weights=None if self.weights is None else csr_array(transfer.nodes @ self.weights),
            motion=self.motion, since=self.since,
        )  # fmt: skip

    def at(self, seconds: float) -> Float:
        """Return the places at a time [s], shape (n, 3)."""
        if self.motion is None or self.weights is None:
            return self.places
        gone = self.motion.at(seconds) - self.motion.at(self.since)
        return np.asarray(self.places + self.weights @ gone)
