"""Pressure on the faces of cloth, towards the right side of the fabric where it is positive.

A follower load: a face with area vector a (its normal times its area) is pushed by p a, a third at each
corner. Within a step area vectors are those of its start, so that the load has a potential, -sum p a/3 . (x -
x0), linear in the positions; at rest the faces of the end are those of the start, and the load is exact.
"""

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.fields import Fields
from toile.engine.forces.force import NodalForce, StepState
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Float, Int
from toile.geometry.normals import area_normals

PRESSURE = "pressure"
"""Name of the field [Pa]."""


class SurfacePressure(NodalForce):
    """Pressure of a field on faces (t, 3) of nodes."""

    def __init__(self, faces: Int, fields: Fields) -> None:
        self._own = np.flatnonzero(fields.where(PRESSURE))
        self._faces = faces[self._own]
        self._fields = fields
        self._load = np.zeros((0, 3))
        self._start = np.zeros((0, 3))

    @classmethod
    def for_cloth(cls, cloth: Cloth) -> "SurfacePressure | None":
        """Return the pressure on a cloth whose seams are closed; None where there is none."""
        if cloth.fields is None or PRESSURE not in cloth.fields.names() or len(cloth.stitches):
            return None
        return cls(cloth.face_nodes, cloth.fields)

    def begin(self, step: StepState, x: Float) -> bool:
        """Take the pressure at the end of the step, and area vectors at x [m], shape (n, 3)."""
        fields = self._fields
        pressure = fields.over(PRESSURE, np.zeros(len(fields.region)), step.request.seconds)[self._own]
        share = (pressure / 6.0)[:, None] * area_normals(x[self._faces])
        self._load = np.stack(
            [np.bincount(self._faces.ravel(), np.repeat(share[:, k], 3), len(x)) for k in range(3)], axis=1
        )
        self._start = x.copy()
        return True

    def energy(self, x: Float) -> float:
        """Potential of the load, 0 at the start of the step [J]."""
        return -float((self._load * (x - self._start)).sum())

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add minus the load [N] to an array of shape (n, 3)."""
        gradient -= self._load

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the gradient; within a step the load has no second derivatives."""
        self.add_gradient(x, gradient)
