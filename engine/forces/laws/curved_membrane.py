"""Membrane of cloth of which some fabric has stretch curves or Poisson's ratio.

Shear, and the stretch of faces without such a law, are those of `Membrane`, by its own kernels; the stretch
of the others is added to it.
"""

import numpy as np

from toile.engine.forces.laws.stretch_laws import StretchLaws, add_stretch, add_stretch_energies
from toile.engine.forces.membrane import Membrane, fill_energies
from toile.geometry.arrays import Float, Int

_NO_BLOCKS = np.empty((0, 6, 3, 3))


class CurvedMembrane(Membrane):
    """Membrane energy of faces, some of which stretch by a law of their own; attributes as in `Membrane`."""

    def __init__(
        self,
        faces: Int,
        rest_corners: Float,
        stretch: tuple[Float, Float],
        shear: Float,
        compression: Float,
        laws: StretchLaws,
    ) -> None:
        """Build for faces (t, 3) of nodes, stiffness along warp and weft (t,) [N/m]: see `Membrane`."""
        super().__init__(faces, rest_corners, *stretch, shear, compression)
        self._laws = laws
        self._linear_shape = self.shape.copy()
        self.shape[laws.laws[:, 0], 1:3] = 0.0

    @property
    def damped_shape(self) -> Float:
        """Constants of `shape` with the stiffness that damping goes by: that of the fabrics."""
        return self._linear_shape

    def energy(self, x: Float) -> float:
        """Energy [J] at node positions x [m], shape (n, 3)."""
        fill_energies(self.faces, self.shape, x, self.element_energy)
        add_stretch_energies(*self._laws, self.shape, self.faces, x, self.element_energy)
        return float(self.element_energy.sum())

    def evaluate_gradient(self, x: Float) -> None:
        """Fill the gradients only, at node positions x [m], shape (n, 3)."""
        super().evaluate_gradient(x)
        unused = np.empty(len(self.faces))
        add_stretch(*self._laws, self.shape, self.faces, x, unused, self.element_gradient, _NO_BLOCKS)

    def evaluate(self, x: Float) -> None:
        """Fill the element arrays at node positions x [m], shape (n, 3)."""
        super().evaluate(x)
        add_stretch(
            *self._laws, self.shape, self.faces, x, self.element_energy, self.element_gradient,
            self.element_hessian,
        )  # fmt: skip
