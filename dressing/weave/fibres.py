"""What fibres weigh and resist.

Moduli are those of Morton and Hearle, Physical Properties of Textile Fibres (4th edition, 2008), table 13.1
(Meredith 1945: Upper cotton, flax, viscose, Botany 64s wool, silk) and table 13.2 (Farrow and Ford: staple
nylon 6.6, polyester, acrylic). Densities and finenesses are typical values of the same fibres.
"""

import math
from typing import NamedTuple

from toile.dressing.files.suggestion import unknown_name
from toile.geometry.errors import InputError


class Fibre(NamedTuple):
    """A kind of fibre.

    Attributes
    ----------
    density
        Mass per volume [kg/m^3].
    modulus
        Initial tensile modulus over density [N m/kg]: 1 N/tex is 1e6.
    fineness
        Mass per length of one fibre [kg/m].
    """

    density: float
    modulus: float
    fineness: float

    @property
    def bending(self) -> float:
        """Bending stiffness of one fibre [N m^2], a round solid rod: modulus fineness^2/(4 pi density)."""
        return self.modulus * self.fineness**2 / (4.0 * math.pi * self.density)


def _fibre(density: float, newtons_per_tex: float, decitex: float) -> Fibre:
    return Fibre(density, newtons_per_tex * 1e6, decitex * 1e-7)


FIBRES = {
    "cotton": _fibre(1520.0, 5.0, 1.7),
    "flax": _fibre(1540.0, 18.0, 3.0),
    "viscose": _fibre(1490.0, 4.8, 1.7),
    "wool": _fibre(1310.0, 2.3, 4.4),
    "silk": _fibre(1340.0, 7.3, 1.3),
    "nylon": _fibre(1140.0, 1.0, 1.7),
    "polyester": _fibre(1390.0, 8.8, 1.7),
    "acrylic": _fibre(1190.0, 6.2, 2.2),
}
"""Fibres by name."""


def fibre(name: str) -> Fibre:
    """Return a fibre. Raises InputError with the nearest names."""
    if name not in FIBRES:
        raise InputError(unknown_name("fibre", name, FIBRES), field="yarn")
    return FIBRES[name]
