"""Mechanical properties of a fabric, in SI units."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, SupportsFloat

from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, shown


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
    crease_curvature
        Curvature beyond which cloth in motion keeps a crease [1/m]: one over the radius; 0: it keeps none.
    crease_hardening
        How much that grows, per curvature kept.

    Raises InputError naming a field that is no finite number.
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
    crease_curvature: float = 0.0
    crease_hardening: float = 0.0

    if TYPE_CHECKING:

        def __init__(
            self, *, name: str, areal_density: SupportsFloat, thickness: SupportsFloat,
            bending_warp: SupportsFloat, bending_weft: SupportsFloat, bending_bias: SupportsFloat,
            stretch_warp: SupportsFloat, stretch_weft: SupportsFloat, shear: SupportsFloat,
            compression: SupportsFloat = 0.02, damping: SupportsFloat = 0.0,
            friction_body: SupportsFloat = 0.35, friction_self: SupportsFloat = 0.3,
            stretch_curve_warp: Sequence[Sequence[SupportsFloat]] = (),
            stretch_curve_weft: Sequence[Sequence[SupportsFloat]] = (), strain_limit: SupportsFloat = 0.0,
            poisson: SupportsFloat = 0.0, bending_damping: SupportsFloat = 0.0,
            crease_curvature: SupportsFloat = 0.0, crease_hardening: SupportsFloat = 0.0,
        ) -> None: ...  # fmt: skip

    def __post_init__(self) -> None:
        """Accept numbers of any real type, and curves as lists of points."""
        for entry in fields(self):
            value = getattr(self, entry.name)
            if entry.name == "name":
                continue
            if entry.name.startswith("stretch_curve"):
                object.__setattr__(self, entry.name, _points(value))
                continue
            if not is_real(value):
                raise InputError(
                    f"fabric '{self.name}': {entry.name} must be a finite number, got {shown(value)}",
                    field=f"fabric.{entry.name}",
                )
            object.__setattr__(self, entry.name, float(value))


def _points(value: Any) -> Any:
    """Return points of a curve as tuples of numbers, so that fabrics are told apart by their values."""
    if isinstance(value, str):
        return value
    if hasattr(value, "__len__"):
        return tuple(_points(entry) for entry in value)
    return float(value) if is_real(value) else value
