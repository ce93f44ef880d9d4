"""Goals: places to which springs draw cloth; pins that give way."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from toile.geometry.arrays import Float, Int
from toile.remesh.adapt.transfer import TransferMap


@dataclass(frozen=True, kw_only=True)
class Goals:
    """Springs per area: E = 1/2 integral of k |x - goal|^2 over the rest area, lumped at the nodes.

    The energy of a patch does not depend on how it is meshed.

    Attributes
    ----------
    stiffness
        k at every node [N/m^3], shape (n,); 0 where nothing draws.
    places
        Where nodes are drawn to [m], shape (n, 3), unless handles lead them.
    """

    stiffness: Float
    places: Float

    @staticmethod
    def together(parts: "Sequence[Goals | None]", positions: Sequence[Float]) -> "Goals | None":
        """Return the goals of garments that become one cloth; None if none has any.

        `positions` are their nodes [m], shape (n, 3) each.
        """
        if all(part is None for part in parts):
            return None
        whole = [
            part or Goals(stiffness=np.zeros(len(x)), places=x)
            for part, x in zip(parts, positions, strict=True)
        ]
        return Goals(
            stiffness=np.concatenate([part.stiffness for part in whole]),
            places=np.concatenate([part.places for part in whole]),
        )

    def carried(self, transfer: TransferMap) -> "Goals":
        """Return the goals of the same cloth on another mesh."""
        return Goals(stiffness=transfer.at_nodes(self.stiffness), places=transfer.at_nodes(self.places))

    def mean(self, label: Int, area: Float) -> csr_array:
        """Weight of every old node in the goals of the nodes they merge into, sparse (n', n): rows sum to 1.

        `label` is the new node and `area` the rest area [m^2] of every old one, shape (n,). Nodes count as
        their springs do.
        """
        count = int(label.max(initial=-1)) + 1
        pull = area * self.stiffness
        drawn = np.bincount(label, weights=pull, minlength=count) > 0.0
        share = np.where(drawn[label], pull, area)
        share /= np.bincount(label, weights=share, minlength=count)[label]
        return csr_array((share, (label, np.arange(len(label)))), shape=(count, len(label)))

    def merged(self, label: Int, area: Float) -> "Goals":
        """Return them after nodes have merged: see `mean`. The energy stays what it is, up to a constant."""
        total = np.bincount(label, weights=area)
        return Goals(
            stiffness=np.bincount(label, weights=area * self.stiffness) / total,
            places=np.asarray(self.mean(label, area) @ self.places),
        )
