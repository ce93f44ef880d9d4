"""The cantilever test (ASTM D1388, BS 3356): a strip hangs over an edge, its chord at 41.5 degrees.

Half the overhang is the bending length c = (B / (rho g))^(1/3), B the bending rigidity, rho the mass per
area.
"""

from toile.dressing.fabric_fit.estimate import Estimate, Measured
from toile.geometry.errors import InputError

GRAVITY = 9.80665
LENGTH_ERROR = 0.02
"""Relative uncertainty of an overhang: a millimetre of five centimetres."""
DIRECTIONS = ("warp", "weft", "bias")


def rigidity(density: float, bending_length: float, error: float, source: str) -> Estimate:
    """Return the bending rigidity [N m] of a density [kg/m2] and a length [m] with a relative error."""
    value = density * GRAVITY * bending_length**3
    return Estimate(value=value, error=3.0 * error * value, source=source)


def cantilever(density: float, overhangs: list[float]) -> Measured:
    """Return the rigidities of overhangs along warp, weft and perhaps bias [m]; `density` in kg/m2."""
    if any(length <= 0.0 for length in overhangs) or density <= 0.0:
        raise InputError("overhangs and weight must be greater than zero", field="--cantilever")
    return Measured(
        values={
            f"bending_{direction}": rigidity(
                density, 0.5 * length, LENGTH_ERROR, f"overhang of {1e3 * length:g} mm"
            )
            for direction, length in zip(DIRECTIONS, overhangs, strict=False)
        }
    )  # fmt: skip
