"""What a teaching cloth is made of and how it is stepped."""

from dataclasses import dataclass
from typing import Any

from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError

MODELS = ("springs", "triangles", "adaptive")
METHODS = ("explicit", "symplectic", "implicit", "bdf2")
SPRINGS = ("structural", "shear", "all")
PINS = ("none", "corners", "one edge")
RANGES = {
    "cells": (2, 40), "stiffness": (5.0, 5000.0), "damping": (0.0, 1.0), "step": (1e-4, 0.1),
    "wind": (0.0, 15.0), "gusts": (0.0, 1.0), "gravity": (0.0, 20.0),
}  # fmt: skip
"""Least and largest numbers."""
DENSITY = 0.15
"""Mass of the teaching fabric per area [kg/m^2]."""
SHEAR, BENDING = 0.3, 2e-5
"""Its shear over its stretch stiffness, and its bending rigidity [N m]."""


@dataclass(frozen=True, kw_only=True)
class Setup:
    """A square of cloth of 1 m and how it is stepped.

    Attributes
    ----------
    model
        "springs": point masses and springs; "triangles": the engine's own; "adaptive": those, remeshed.
    method
        "explicit" or "symplectic" Euler, "implicit" Euler, linearised once (Baraff and Witkin 1998), "bdf2".
    springs
        Which springs there are: "structural", those and "shear", or "all".
    cells
        Along a side.
    stiffness
        k_s: of a structural spring, and of the fabric along its threads [N/m].
    damping
        k_d of a structural spring [N s/m].
    step
        Time step [s].
    wind, gusts, gravity
        [m/s], share of the wind, [m/s^2].
    pins
        "none", "corners" or "one edge".
    ball
        Whether it falls on a ball, with contact. Triangles and implicit steps only.
    fabric
        A fabric instead of the teaching fabric of stiffness k_s; triangles only.

    Raises InputError naming the field that is at fault.
    """

    model: str = "springs"
    method: str = "implicit"
    springs: str = "all"
    cells: int = 12
    stiffness: float = 100.0
    damping: float = 0.02
    step: float = 1.0 / 60.0
    wind: float = 0.0
    gusts: float = 0.0
    gravity: float = 9.81
    pins: str = "one edge"
    ball: bool = False
    fabric: Fabric | None = None

    def __post_init__(self) -> None:
        """Check every field."""
        for name, known in (("model", MODELS), ("method", METHODS), ("springs", SPRINGS), ("pins", PINS)):
            if getattr(self, name) not in known:
                raise InputError(
                    f"{name} must be one of {', '.join(known)}, got {getattr(self, name)!r}", field=name
                )
        for name, (low, high) in RANGES.items():
            value: Any = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
                raise InputError(f"{name} must lie between {low:g} and {high:g}, got {value!r}", field=name)
        if not isinstance(self.cells, int):
            raise InputError(f"cells must be a whole number, got {self.cells!r}", field="cells")
        if self.ball and (self.model == "springs" or self.method != "implicit"):
            raise InputError("a ball needs triangles and implicit steps", field="ball")
        if self.model == "adaptive" and self.method != "implicit":
            raise InputError("adaptive meshes need implicit steps", field="model")

    @property
    def made_of(self) -> Fabric:
        """The fabric."""
        if self.fabric is not None:
            return self.fabric
        bending = BENDING if self.springs == "all" else 0.0
        shear = 0.0 if self.springs == "structural" and self.model == "springs" else SHEAR * self.stiffness
        return Fabric(
            name="teaching", areal_density=DENSITY, thickness=5e-4, bending_warp=bending,
            bending_weft=bending, bending_bias=bending, stretch_warp=self.stiffness,
            stretch_weft=self.stiffness, shear=shear, compression=1.0, damping=self.lag,
        )  # fmt: skip

    @property
    def lag(self) -> float:
        """Time by which damping exceeds stiffness, number for number: k_d / k_s [s]."""
        return self.damping / self.stiffness
