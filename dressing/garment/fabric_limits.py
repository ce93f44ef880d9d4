"""What numbers of a fabric can be, and in which unit one that cannot be was probably meant."""

from typing import NamedTuple

from toile.geometry.given_numbers import is_real, shown


class Limits(NamedTuple):
    """Limits of one number of a fabric.

    Attributes
    ----------
    low, high
        No cloth has less or more.
    usual
        What cloth for garments has: where a number would lie in its own unit.
    units
        Other units that the number is often given in, to the factor that turns them into the one wanted.
    unit
        The unit that is wanted.
    """

    low: float
    high: float
    usual: tuple[float, float] = (0.0, 0.0)
    units: tuple[tuple[str, float], ...] = ()
    unit: str = ""


_BENDING = Limits(
    0.0, 0.02, (3e-7, 1e-3), (("uN m", 1e-6), ("gf cm^2/cm", 9.81e-5), ("mN m", 1e-3), ("N mm", 1e-3)), "N m"
)  # fmt: skip
_STRETCH = Limits(5.0, 1e6, (20.0, 2e5), (("kN/m", 1e3), ("N/mm", 1e3), ("mN/m", 1e-3)), "N/m")
_FRICTION = Limits(0.0, 10.0, (0.01, 2.0), (("percent", 0.01),))
LIMITS = {
    "areal_density": Limits(
        1e-3, 5.0, (0.03, 1.5), (("g/m^2", 1e-3), ("oz/yd^2", 0.0339), ("mg/cm^2", 1e-2)), "kg/m^2"
    ),
    "thickness": Limits(1e-5, 0.02, (2e-5, 0.015), (("mm", 1e-3), ("um", 1e-6), ("cm", 1e-2)), "m"),
    "bending_warp": _BENDING,
    "bending_weft": _BENDING,
    "bending_bias": _BENDING,
    "stretch_warp": _STRETCH,
    "stretch_weft": _STRETCH,
    "shear": Limits(0.0, 1e6, (1.0, 2e5), (("kN/m", 1e3), ("N/mm", 1e3), ("mN/m", 1e-3)), "N/m"),
    "compression": Limits(0.0, 1.0, (0.0, 1.0), (("percent", 0.01),)),
    "damping": Limits(0.0, 10.0, (0.0, 1.0), (("ms", 1e-3),), "s"),
    "bending_damping": Limits(0.0, 10.0, (0.0, 1.0), (("ms", 1e-3),), "s"),
    "crease_curvature": Limits(0.0, 1e5, (50.0, 1e4), (("1/mm", 1e3),), "1/m"),
    "crease_hardening": Limits(0.0, 1e3),
    "strain_limit": Limits(0.0, 0.999, (0.01, 0.5), (("percent", 0.01),)),
    "poisson": Limits(0.0, 0.99),
    "friction_body": _FRICTION,
    "friction_self": _FRICTION,
}
"""Every number of a fabric by its name.

Woven and knitted cloth of garments has 5 g/m^2 (organza) to 1 kg/m^2 (coating), leather and felt up to
5 kg/m^2; thicknesses lie between 20 um and the 2 cm of quilts. Bending rigidities of 618 measured fabrics
(Feng et al. 2022) lie between 0.3 and 200 uN m; felt 5 mm thick reaches 10 mN m.
"""
MUST_BE_POSITIVE = frozenset({"areal_density", "thickness", "stretch_warp", "stretch_weft"})
"""Numbers that cannot be zero: without mass or thread stiffness there is no cloth to simulate."""


def wrong_number(name: str, value: object) -> str | None:
    """Return what is wrong with a number of a fabric and which unit it may be in, None if nothing is."""
    limits = LIMITS[name]
    if not is_real(value):
        return f"must be a finite number, got {shown(value)}"
    number = float(value)  # type: ignore[arg-type]
    if name in MUST_BE_POSITIVE and number <= 0.0:
        return f"must be greater than zero, got {number:g}"
    if number < 0.0:
        return f"must not be negative, got {number:g}"
    if limits.low <= number <= limits.high:
        return None
    low, high = limits.usual
    meant = next((unit for unit, factor in limits.units if low <= number * factor <= high), None)
    doubt = "" if meant is None else f" (in {meant}?)"
    if name == "compression":
        return f"is a share and must not exceed 1, got {number:g}{doubt}"
    return (
        f"must lie between {limits.low:g} and {limits.high:g} {limits.unit}".rstrip()
        + f", got {number:g}{doubt}"
    )
