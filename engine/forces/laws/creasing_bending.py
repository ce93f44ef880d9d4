"""Bending of cloth that keeps creases: plastic curvature with a yield and linear hardening.

With kappa the curvature (uu, vv, uv) of a face along its normal and kappa_p what it keeps, the elastic energy
is that of `Bending` with kappa_p for a rest shape. Where kappa_e = kappa - kappa_p grows beyond the yield,

    |kappa_e| > kappa_y + H w,     |k|^2 = k . D k / ((D11 + D22)/2),

kappa_p grows along kappa_e, and w by as much, until both sides are equal: by (|kappa_e| - kappa_y - H w)/(1 +
H) (radial return; Simo and Hughes 1998). Cloth bent once to kappa keeps (kappa - kappa_y)/(1 + H).

It yields at the start of steps in motion, by where the nodes have come to, so that a step that is tried again
yields to nothing else. Steps to equilibrium, in which cloth is sewn and settles, crease nothing.
"""

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.creases import Creases
from toile.engine.forces.bend import Bending
from toile.engine.forces.force import StepState
from toile.geometry.arrays import Float


class CreasingBending(Bending):
    """Bending of a cloth with `creases`, which it changes as the cloth yields."""

    _creases: Creases
    _yield: Float
    _hardening: Float
    _shape: Float

    @classmethod
    def for_cloth(cls, cloth: Cloth) -> "CreasingBending":
        """Return the bending of a cloth, with its creases so far."""
        bending = super().for_cloth(cloth)
        assert isinstance(bending, cls) and cloth.creases is not None
        yields = cloth.per_face("crease_curvature")
        bending._creases = cloth.creases
        bending._yield = np.where(yields > 0.0, yields, np.inf)
        bending._hardening = cloth.per_face("crease_hardening")
        shape = np.zeros((len(cloth.faces), 3, 3)) if bending._rest is None else bending._rest
        bending._shape, bending._rest = shape, shape.copy()
        bending._crease()
        return bending

    def begin(self, step: StepState, x: Float) -> bool:
        """Yield to the shape in which a step in motion starts."""
        if not step.request.at_rest:
            self._yield_to(step.start)
        return super().begin(step, x)

    def _crease(self) -> None:
        """Take the creases for the rest shape."""
        assert self._rest is not None
        self._rest[:, :, 2] = self._shape[:, :, 2] + self._creases.curvature

    def _yield_to(self, x: Float) -> None:
        """Let kept curvature follow where faces at x [m], shape (n, 3), are bent too far."""
        creases = self._creases
        excess = self.curvature(x) - self._shape[:, :, 2] - creases.curvature
        mean = 0.5 * (self.rigidity[:, 0, 0] + self.rigidity[:, 1, 1])
        squared = np.einsum("ta,tab,tb->t", excess, self.rigidity, excess)
        size = np.sqrt(squared / np.maximum(mean, 1e-300))
        beyond = size - self._yield - self._hardening * creases.worked
        flows = beyond > 0.0
        if not flows.any():
            return
        grown = beyond[flows] / (1.0 + self._hardening[flows])
        creases.curvature[flows] += (grown / size[flows])[:, None] * excess[flows]
        creases.worked[flows] += grown
        self._crease()
