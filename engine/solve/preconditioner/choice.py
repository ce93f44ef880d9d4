"""Choice of the preconditioner of a system."""

from toile.engine.solve.linear_system import LinearSystem
from toile.engine.solve.preconditioner.base import Preconditioner
from toile.engine.solve.preconditioner.block_jacobi import BlockJacobi
from toile.engine.solve.preconditioner.two_level import TwoLevel

SMALL = 150
"""Below this many nodes block Jacobi is about as fast and needs no groups."""
LARGE = 20_000
"""From this many nodes on, larger groups keep the coarse factor cheap."""


def make_preconditioner(system: LinearSystem) -> Preconditioner:
    """Return the fastest one for this topology, measured over steps of 5 to 100 ms on woven cloth."""
    count = system.pattern.node_count
    if count < SMALL:
        return BlockJacobi()
    return TwoLevel(system, group_size=60 if count < LARGE else 120)
