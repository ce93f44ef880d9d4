"""Mechanical properties of a fabric, in SI units."""

from dataclasses import dataclass


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
        Membrane stiffness along the threads [N/m].
    shear
        Shear stiffness [N/m].
    compression
        Share of the stretch stiffness that acts in compression, 0 to 1: threads and fine wrinkles buckle.
    damping
        Time by which the damping of stretch and shear exceeds their stiffness, number for number [s].
    friction_body, friction_self
        Coulomb coefficients against the avatar and against cloth.
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
