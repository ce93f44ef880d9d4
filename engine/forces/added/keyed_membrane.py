"""A membrane whose stiffness or rest shape is keyed over a film."""

import numpy as np

from toile.engine.cloth.cloth import RESTS, Cloth
from toile.engine.forces.force import StepState
from toile.engine.forces.laws.curved_membrane import CurvedMembrane
from toile.engine.forces.laws.stretch_laws import StretchLaws, stretch_laws
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
        self._cloth, self._now = cloth, cloth.now

    def begin(self, step: StepState, x: Float) -> bool:
        """Take the fields at the end of the step."""
        if step.request.seconds != self._now:
            self._now = step.request.seconds
            _fill_at(self._cloth, self._now, self.shape)
        return True


class KeyedCurvedMembrane(CurvedMembrane):
    """The same of a cloth of which some fabric has stretch curves or Poisson's ratio."""

    def __init__(self, cloth: Cloth, laws: StretchLaws) -> None:
        warp, weft, shear, compression = (cloth.per_face(name) for name in COLUMNS)
        super().__init__(cloth.face_nodes, cloth.natural_corners, (warp, weft), shear, compression, laws)
        self._cloth, self._now = cloth, cloth.now

    def begin(self, step: StepState, x: Float) -> bool:
        """Take the fields at the end of the step; curves are scaled as the stiffness is."""
        if step.request.seconds != self._now:
            self._now, cloth, linear = step.request.seconds, self._cloth, self.damped_shape
            _fill_at(cloth, self._now, linear)
            laws = stretch_laws(cloth.fabrics, cloth.fabric, linear[:, 1], linear[:, 2], linear[:, 10])
            assert laws is not None
            self._laws = laws
            self.shape[:] = linear
            self.shape[laws.laws[:, 0], 1:3] = 0.0
        return True


def _fill_at(cloth: Cloth, seconds: float, shape: Float) -> None:
    """Set the constants of a membrane, shape (t, 11), to what the fields of a cloth are at a time [s]."""
    assert cloth.fields is not None
    scale = cloth.rest_scale(seconds)
    if scale is not None:
        fill_rest_shapes(np.ascontiguousarray(cloth.rest_corners * scale[:, None]), shape)
    for name, column in COLUMNS.items():
        shape[:, column] = cloth.fields.over(name, shape[:, column], seconds)
