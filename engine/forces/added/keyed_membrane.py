"""A membrane whose stiffness or rest shape is keyed over a film."""

import numpy as np

from toile.engine.cloth.cloth import RESTS, Cloth
from toile.engine.forces.force import StepState
from toile.engine.forces.membrane import Membrane, fill_rest_shapes
from toile.geometry.arrays import Float

KEYED = ("stretch_warp", "stretch_weft", "shear", "compression", *RESTS)
"""Quantities that may be keyed, beside pressure."""
COLUMNS = {"stretch_warp": 1, "stretch_weft": 2, "shear": 3, "compression": 10}
"""Column of `Membrane.shape` that holds a quantity."""


class KeyedMembrane(Membrane):
    """The membrane of a cloth, with its fields as they are at the end of every step."""

    def __init__(self, cloth: Cloth) -> None:
        super().__init__(cloth.face_nodes, cloth.natural_corners, *(cloth.per_face(name) for name in COLUMNS))
        assert cloth.fields is not None
        self._cloth, self._now = cloth, cloth.now

    def begin(self, step: StepState, x: Float) -> bool:
        """Take the fields at the end of the step."""
        seconds = step.request.seconds
        if seconds == self._now:
            return True
        cloth, self._now = self._cloth, seconds
        assert cloth.fields is not None
        scale = cloth.rest_scale(seconds)
        if scale is not None:
            fill_rest_shapes(np.ascontiguousarray(cloth.rest_corners * scale[:, None]), self.shape)
        for name, column in COLUMNS.items():
            values: Float = cloth.fields.over(name, self.shape[:, column], seconds)
            self.shape[:, column] = values
        return True
