"""Goals as a force: springs per area towards places that may move (see `engine.cloth.goals`)."""

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.force import StepState
from toile.engine.forces.hold import NodeSprings
from toile.geometry.arrays import Float


class GoalPull(NodeSprings):
    """Springs that always act, each axis with its own stiffness [N/m], towards where the request has pins."""

    @classmethod
    def for_cloth(cls, cloth: Cloth) -> "GoalPull | None":
        """Return the pull of a cloth's goals; None if none acts on a node that is free."""
        goals = cloth.goals
        if goals is None:
            return None
        held = np.flatnonzero((goals.stiffness > 0.0) & ~cloth.pinned).astype(np.int32)
        if not len(held):
            return None
        stiffness = (cloth.node_area * goals.stiffness)[held]
        return cls(held, goals.places[held], np.repeat(stiffness[:, None], 3, axis=1))

    def begin(self, step: StepState, x: Float) -> bool:
        """Take the places from the request, where it has any."""
        self._stiffness = 1.0
        if step.request.pin_target is not None:
            self.targets = step.request.pin_target[self.held]
        return True
