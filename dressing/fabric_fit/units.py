"""Units of fabric testing, and what they are in SI."""

import math

from toile.geometry.errors import InputError

GF = 9.80665e-3
"""Newtons of a gram-force (standard gravity)."""
UNITS: dict[str, dict[str, float]] = {
    "mass per area": {"g/m2": 1e-3, "kg/m2": 1.0, "oz/yd2": 0.0339057, "mg/cm2": 1e-2},
    "length": {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254},
    "strain": {"%": 1e-2, "1": 1.0},
    "angle": {"deg": math.pi / 180.0, "rad": 1.0},
    "curvature": {"1/cm": 1e2, "1/m": 1.0, "1/mm": 1e3},
    "force per width": {"gf/cm": GF / 1e-2, "N/m": 1.0, "N/cm": 1e2, "cN/cm": 1.0, "gf.cm/cm2": GF / 1e-2},
    "moment per width": {"gf.cm/cm": GF, "mN.mm/mm": 1e-3, "N.m/m": 1.0, "N": 1.0, "cN.cm/cm": 1e-2},
    "bending rigidity": {
        "gf.cm2/cm": GF * 1e-2, "uN.m": 1e-6, "mN.mm": 1e-6, "N.m": 1.0, "mg.cm": GF * 1e-5, "dyn.cm": 1e-7,
        "cN.cm2/cm": 1e-4,
    },
    "shear stiffness": {
        "gf/(cm.deg)": GF / 1e-2 * 180.0 / math.pi, "N/m": 1.0, "N/(m.deg)": 180.0 / math.pi,
    },
}  # fmt: skip
"""SI value of one of every unit, by what it measures.

Bending rigidity is a moment per width over a curvature: gf.cm2/cm is 98.07 uN.m. Shear stiffness is a force
per width over the tangent of the shear angle: gf/(cm.deg) is 56.19 N/m.
"""
SPELLINGS = {"²": "2", "·": ".", "*": ".", "^": "", " ": ".", "µ": "u", "μ": "u", "°": "deg"}
"""Other ways to write parts of units."""


def plain_unit(text: str) -> str:
    """Return a unit as UNITS spells it."""
    for other, own in SPELLINGS.items():
        text = text.replace(other, own)
    return text.replace("gf/cm.deg", "gf/(cm.deg)").replace("gf/cm/deg", "gf/(cm.deg)")


def factor(unit: str, kind: str) -> float:
    """Return the SI value of a unit of this kind. Raises InputError with the units that are known."""
    known = UNITS[kind]
    found = known.get(plain_unit(unit))
    if found is None:
        raise InputError(f"'{unit}' is no unit of {kind}; use one of {', '.join(known)}")
    return found


def quantity(text: str, kind: str, default: str) -> float:
    """Return an SI value from a number with a unit, such as "21mm" or "0.05 gf cm2/cm"; else in `default`.

    Raises InputError if there is no number, or the unit is of another kind.
    """
    text = text.strip()
    end = len(text)
    while end and not _is_number(text[:end]):
        end -= 1
    if not end:
        raise InputError(f"'{text}' is no {kind}: write a number and a unit, as in 21 {default}")
    unit = text[end:].strip()
    return float(text[:end]) * factor(unit or default, kind)


def _is_number(text: str) -> bool:
    """Whether a text is a finite number."""
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
