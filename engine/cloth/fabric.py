"""Mechanical properties of a fabric, in SI units."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Fabric:
    """Mechanical properties of one fabric; warp and weft are its two thread directions.

    Attributes
    ----------
    name
        Name of the fabric.
    areal_density
        Mass per area [kg/m^2].
    thickness
        Fabric thickness [m]; layers keep at least about this distance.
    bending_warp, bending_weft, bending_bias
        Bending rigidity [N m] when bent along warp, along weft and along the 45 degree diagonal.
    stretch_warp, stretch_weft
        Membrane stiffness along the threads [N/m]: where a direction has a curve, its damping only.
    shear
        Shear stiffness [N/m].
    compression
        Share of the stretch stiffness that acts in compression, 0 to 1: threads and fine wrinkles buckle.
    damping
        Time by which the damping of stretch and shear exceeds their stiffness, number for number [s].
    friction_body, friction_self
        Coulomb coefficients against the avatar and against cloth.
    stretch_curve_warp, stretch_curve_weft
        Measured tension along the threads of a strip that is free to contract: points (strain, tension
        [N/m]), from zero upwards; none where it goes with the strain.
    strain_limit
        Strain at which threads lock that have no curve: from half of it on they stiffen, to 20 times their
        stiffness; 0: they never do.
    poisson
        Contraction across, per stretch along the threads, 0 to 0.99: the geometric mean of that of the weft
        when the warp is pulled and of the warp when the weft is.
    bending_damping
        Time by which the damping of bending exceeds the rigidity, number for number [s].
    """

    name: str
    areal_density: float
    thickness: float
    bending_warp: float
    bending_weft: float
    bending_bias: float
    stretch_warp: float
    stretch_weft: float
    shear: float
    compression: float = 0.02
    damping: float = 0.0
    friction_body: float = 0.35
    friction_self: float = 0.3
    stretch_curve_warp: tuple[tuple[float, float], ...] = ()
    stretch_curve_weft: tuple[tuple[float, float], ...] = ()
    strain_limit: float = 0.0
    poisson: float = 0.0
    bending_damping: float = 0.0

    def __post_init__(self) -> None:
        """Take lists of points as well, as files have them: fabrics are told apart by their values."""
        for name in ("stretch_curve_warp", "stretch_curve_weft"):
            object.__setattr__(self, name, _frozen(getattr(self, name)))


def _frozen(value: Any) -> Any:
    return tuple(_frozen(entry) for entry in value) if isinstance(value, list | tuple) else value
