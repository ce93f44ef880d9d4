"""Creases: curvature that cloth keeps when it is let go."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from toile.engine.cloth.fabric import Fabric
from toile.geometry.arrays import Float, Int


@dataclass(frozen=True, kw_only=True)
class Creases:
    """What faces have been creased by; forces change these arrays in place as cloth yields.

    Attributes
    ----------
    curvature
        Curvature (uu, vv, uv) that every face keeps [1/m], shape (t, 3).
    worked
        Sum of all changes of it, by which cloth hardens [1/m], shape (t,).
    """

    curvature: Float
    worked: Float

    @staticmethod
    def of(fabrics: Sequence[Fabric], faces: int) -> "Creases | None":
        """Return creases of a cloth of so many faces that has none yet; None if no fabric can have any."""
        if not any(fabric.crease_curvature > 0.0 for fabric in fabrics):
            return None
        return Creases(curvature=np.zeros((faces, 3)), worked=np.zeros(faces))

    @staticmethod
    def together(parts: "Sequence[Creases | None]", faces: Sequence[int]) -> "Creases | None":
        """Return the creases of cloths that become one, of so many faces each; None if none has any."""
        if all(part is None for part in parts):
            return None
        whole = [
            part or Creases(curvature=np.zeros((count, 3)), worked=np.zeros(count))
            for part, count in zip(parts, faces, strict=True)
        ]
        return Creases(
            curvature=np.concatenate([part.curvature for part in whole]),
            worked=np.concatenate([part.worked for part in whole]),
        )

    def carried(self, faces: Int) -> "Creases":
        """Return the creases on another mesh, whose faces come from `faces` of this one, shape (t',)."""
        return Creases(curvature=self.curvature[faces], worked=self.worked[faces])
