"""A yarn: fibres spun to a count."""

import math
import re
from dataclasses import dataclass

from toile.dressing.weave.fibres import fibre
from toile.geometry.errors import InputError

PACKING = 0.6
"""Share of a yarn's free cross-section that is fibre."""
PRESSED = 0.7
"""Height of a yarn between two others, as a share of its free diameter."""
FINEST, COARSEST = 1e-6, 5e-3
"""Counts of yarns for cloth: 1 to 5,000 tex [kg/m]."""
SPELLING = re.compile(r"(?:(?P<fibre>[A-Za-z]+):)?\s*(?P<count>[0-9.eE+-]+)\s*(?P<unit>[A-Za-z]+)")
INDIRECT = {"Ne": 590.5e-6, "Nm": 1e-3}
DIRECT = {"tex": 1e-6, "dtex": 1e-7, "den": 1e-3 / 9000.0}


@dataclass(frozen=True, kw_only=True)
class Yarn:
    """A yarn in a fabric.

    Attributes
    ----------
    linear_density
        Mass per length [kg/m]; 1 tex is 1e-6.
    stiffness
        Axial stiffness [N]: force per strain.
    bending
        Bending stiffness [N m^2].
    height
        Height where another yarn presses on it [m].
    width
        Its width in the plane of the cloth [m].
    """

    linear_density: float
    stiffness: float
    bending: float
    height: float
    width: float


def spun(kind: str, linear_density: float) -> Yarn:
    """Return a yarn of fibres of one kind and a mass per length [kg/m].

    Fibres are parallel and slide past each other freely: its stiffness is the most that they can give, its
    bending stiffness the least, the sum of theirs.
    """
    own = fibre(kind)
    if not FINEST <= linear_density <= COARSEST:
        raise InputError(
            f"a yarn of cloth has 1 to 5,000 tex, got {linear_density * 1e6:.4g} tex; "
            "write counts as 20tex, 200dtex, 180den, 30Ne or 50Nm",
            field="yarn",
        )
    free = math.sqrt(4.0 * linear_density / (math.pi * own.density * PACKING))
    return Yarn(
        linear_density=linear_density, stiffness=own.modulus * linear_density,
        bending=own.bending * linear_density / own.fineness, height=PRESSED * free, width=free,
    )  # fmt: skip


def read_yarn(text: str, kind: str = "cotton") -> Yarn:
    """Return the yarn of a text such as "wool:50tex", "30Ne"; of fibres of a kind where it names none."""
    match = SPELLING.fullmatch(text.strip())
    count = None
    if match is not None:
        try:
            count = float(match["count"])
        except ValueError:
            count = None
    if match is None or count is None:
        raise InputError(f"a yarn is written FIBRE:COUNT, such as cotton:20tex; got '{text}'", field="yarn")
    unit = match["unit"]
    if unit not in DIRECT and unit not in INDIRECT:
        raise InputError(f"the count of a yarn is in tex, dtex, den, Ne or Nm; got '{text}'", field="yarn")
    if not (count > 0.0 and math.isfinite(count)):
        raise InputError(f"the count of a yarn must be greater than zero; got '{text}'", field="yarn")
    return spun(match["fibre"] or kind, DIRECT[unit] * count if unit in DIRECT else INDIRECT[unit] / count)
