"""Pins with times as a force (see `engine.cloth.fields.timed_pins`)."""

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.timed_pins import TimedPins
from toile.engine.forces.force import StepState
from toile.engine.forces.hold import NodeSprings
from toile.geometry.arrays import Float


class TimedPull(NodeSprings):
    """Springs towards where pins are at the end of a step; they act while their share is not zero."""

    def __init__(self, pins: TimedPins, cloth: Cloth) -> None:
        held = np.flatnonzero((pins.stiffness > 0.0) & ~cloth.pinned).astype(np.int32)
        stiffness = (cloth.node_area * pins.stiffness)[held]
        super().__init__(held, pins.places[held], np.repeat(stiffness[:, None], 3, axis=1))
        self._pins = pins

    def begin(self, step: StepState, x: Float) -> bool:
        """Take strength and places at the end of the step."""
        self._stiffness = self._pins.share.at(step.request.seconds)
        if self._stiffness <= 0.0:
            return False
        self.targets: Float = self._pins.at(step.request.seconds)[self.held]
        return True
