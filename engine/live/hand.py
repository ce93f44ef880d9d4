"""A hand that pulls a patch of cloth: a spring to a goal, bounded in force and speed, so that it cannot tear.

The goal goes to where the hand wants it no faster than `SPEED`, and never farther ahead of the patch than the
bounded force stretches the spring. The hand eases off where cloth stretches, so cloth that is caught holds
the goal back instead of being torn.
"""

import numpy as np

from toile.engine.forces.force import StepState
from toile.engine.forces.hold import NodeSprings
from toile.geometry.arrays import Float, Int

SPEED = 1.5
"""Fastest motion of a goal [m/s]."""
LEAD = 0.02
"""How far the goal is ahead of the patch where the pull is as strong as it may be [m]."""
BEARABLE = 0.04
"""Largest stretch of cloth up to which a hand pulls as hard as it may."""
EASED, FIRMER, WEAKEST = 0.4, 1.15, 0.02
"""Factors on the lead from one step to the next, at least and at most; least share of LEAD."""


class Hand(NodeSprings):
    """Springs that draw a patch of nodes along; none while nothing is held.

    Attributes
    ----------
    force
        Largest force of the hand on the cloth [N].
    wanted
        How far from where it was gripped the patch shall be [m], shape (3,).
    """

    def __init__(self) -> None:
        super().__init__(np.empty(0, np.int32), np.empty((0, 3)), np.empty((0, 3)))
        self.force = 0.0
        self.wanted = np.zeros(3)
        self._gripped_at = np.empty((0, 3))
        self._share = np.empty(0)
        self._goal = np.zeros(3)
        self._lead = LEAD
        self._bearable = BEARABLE

    @property
    def holds(self) -> bool:
        """Whether it holds cloth."""
        return len(self.held) > 0

    def grip(self, nodes: Int, x: Float, area: Float, force: float) -> None:
        """Grip nodes, shape (k,), where they are, x [m], shape (n, 3), to pull with `force` [N] at most.

        Springs are shared out by the rest area of the nodes, shape (n,).
        """
        self.held, self.force, self._bearable = nodes, force, BEARABLE
        self._gripped_at = x[nodes].copy()
        self._share = area[nodes] / area[nodes].sum()
        self.axes = np.repeat(self._share[:, None], 3, axis=1)
        self.wanted, self._goal = np.zeros(3), np.zeros(3)

    def release(self) -> None:
        """Let go."""
        self.held = np.empty(0, np.int32)

    def bear(self, stretch: float) -> None:
        """Pull as hard as it may up to this stretch, where that is more than usual, until the next grip."""
        self._bearable = max(BEARABLE, stretch)

    def feel(self, stretch: float) -> None:
        """Ease off where the largest stretch of the cloth is more than bearable, else pull harder."""
        factor = min(max(self._bearable / max(stretch, 1e-300), EASED), FIRMER)
        self._lead = min(max(self._lead * factor, WEAKEST * LEAD), LEAD)

    def begin(self, step: StepState, x: Float) -> bool:
        """Lead the goal on by a step, and tell whether anything is held."""
        if not self.holds:
            return False
        self._stiffness = self.force / LEAD
        patch = self._share @ (x[self.held] - self._gripped_at)
        way = self.wanted - self._goal
        self._goal = self._goal + way * min(1.0, SPEED * step.request.h / max(_length(way), 1e-300))
        lead = self._goal - patch
        self._goal = patch + lead * min(1.0, self._lead / max(_length(lead), 1e-300))
        self.targets = self._gripped_at + self._goal
        return True


def _length(vector: Float) -> float:
    """Length of a vector."""
    return float(np.linalg.norm(vector))
