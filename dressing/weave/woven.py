"""The fabric that a weave makes, without any number fitted."""

import math
from dataclasses import dataclass

import numpy as np

from toile.dressing.weave.crossing import Pulled, System, compliance, pulled
from toile.dressing.weave.interlacing import checked_weave, interlacings, locking_angle, weave_named
from toile.dressing.weave.yarn import Yarn, read_yarn
from toile.engine.cloth.fabric import Fabric
from toile.geometry.arrays import Bool
from toile.geometry.errors import InputError

TENSIONS = (
    1.0, 2.0, 5.0, 10.0, 20.0, 35.0, 50.0, 75.0, 100.0, 150.0, 200.0, 300.0, 500.0, 700.0, 1000.0,
)  # fmt: skip
"""Tensions of the curves [N/m]."""
TWIST = 1.0 / 1.3
"""Torsional over bending stiffness of a fibre: a round isotropic rod with Poisson's ratio 0.3."""
MOST_POISSON = 0.5
"""Contraction that the membrane is given at most.

Waves that pass freely from warp to weft would give nearly 1, and a circle skirt then crumples. Measured
fabrics have 0.26 (canvas) to 0.76 (charmeuse) at small strains, 0.5 in the mean: friction holds most waves in
place.
"""
CLOSEST, WIDEST = 1e-4, 1e-2
"""Spacings of yarns [m]: 1 to 100 per centimetre."""


@dataclass(frozen=True)
class Direction:
    """What is known of warp or weft.

    Attributes
    ----------
    crimp
        Yarn length over spacing, less 1: the strain at which its yarns are straight.
    stiffness
        Initial membrane stiffness, the other direction free [N/m].
    bending
        Bending rigidity when bent along it [N m].
    contraction
        Strain across over strain along, at the beginning.
    curve
        Equilibria under the tensions of `TENSIONS`.
    """

    crimp: float
    stiffness: float
    bending: float
    contraction: float
    curve: tuple[Pulled, ...]


@dataclass(frozen=True)
class Woven:
    """A woven fabric.

    Attributes
    ----------
    systems
        Its warp and weft.
    top
        Where the warp is on top, shape (ends, picks) of a repeat.
    areal_density, thickness
        [kg/m^2], [m].
    warp, weft
        What is known of both directions.
    shear
        Initial shear stiffness [N/m]: yarns bend between crossings that do not turn.
    locking
        Shear angle at which yarns touch their neighbours [rad].
    """

    systems: tuple[System, System]
    top: Bool
    areal_density: float
    thickness: float
    warp: Direction
    weft: Direction
    shear: float
    locking: float

    def fabric(self, name: str) -> Fabric:
        """Return it as a fabric, with its curves."""
        contraction = math.sqrt(self.warp.contraction * self.weft.contraction)
        return Fabric(
            name=name, areal_density=self.areal_density, thickness=self.thickness,
            bending_warp=self.warp.bending, bending_weft=self.weft.bending,
            bending_bias=0.25 * (1.0 + TWIST) * (self.warp.bending + self.weft.bending),
            stretch_warp=self.warp.stiffness, stretch_weft=self.weft.stiffness, shear=self.shear,
            stretch_curve_warp=_points(self.warp, 0), stretch_curve_weft=_points(self.weft, 1),
            poisson=min(contraction, MOST_POISSON),
        )  # fmt: skip


def _points(direction: Direction, axis: int) -> tuple[tuple[float, float], ...]:
    return tuple((float(one.strain[axis]), n) for one, n in zip(direction.curve, TENSIONS, strict=True))


def woven(
    warp: Yarn | str,
    weft: Yarn | str,
    *,
    ends: float,
    picks: float,
    weave: str | Bool = "plain",
    warp_wave: float = 0.5,
    set: float = 1.0,
) -> Woven:
    """Return the fabric of two yarns.

    Parameters
    ----------
    warp, weft
        Yarns, or texts such as "cotton:20tex".
    ends, picks
        Warp and weft yarns per metre of width and of length.
    weave
        plain, twill, satin, A/B, or where the warp is on top, shape (ends, picks) of a repeat.
    warp_wave
        Share of the wave height that is the warp's; tension on the loom decides it.
    set
        Share of their turns that yarns keep without load: 1 in finished cloth.

    Raises InputError if yarns do not fit beside each other, or a number is out of range.
    """
    warp = read_yarn(warp) if isinstance(warp, str) else warp
    weft = read_yarn(weft) if isinstance(weft, str) else weft
    top = checked_weave(weave_named(weave) if isinstance(weave, str) else weave)
    for name, count in (("ends", ends), ("picks", picks)):
        if not 1.0 / WIDEST <= count <= 1.0 / CLOSEST:
            raise InputError(f"{name} must be 1 to 100 per centimetre, got {count / 100.0:g}", field=name)
    for name, share in (("warp_wave", warp_wave), ("set", set)):
        if not 0.0 <= share <= 1.0:
            raise InputError(f"{name} is a share, 0 to 1, got {share:g}", field=name)
    for system, yarn, count, counted in (("warp", warp, ends, "ends"), ("weft", weft, picks, "picks")):
        if yarn.width * count > 1.0 + 1e-9:
            raise InputError(
                f"{system} yarns are {yarn.width * 1e3:.3g} mm wide, and {count / 100.0:g} {counted} per "
                f"centimetre leave {1e3 / count:.3g} mm for each: use fewer, or a finer yarn",
                field=counted,
            )
    height = warp.height + weft.height
    of_warp, of_weft = interlacings(top)
    systems = (
        System(warp, 1.0 / picks, warp_wave * height, of_warp, set),
        System(weft, 1.0 / ends, (1.0 - warp_wave) * height, of_weft, set),
    )
    return _known(systems, top)


def _known(systems: tuple[System, System], top: Bool) -> Woven:
    """Work out what is known of a weave."""
    warp, weft = systems
    soft = compliance(warp, weft)
    directions = []
    for axis, (own, other) in enumerate(((warp, weft), (weft, warp))):
        curve: list[Pulled] = []
        for tension in TENSIONS:
            pull = (tension, 0.0) if axis == 0 else (0.0, tension)
            curve.append(pulled(warp, weft, pull, curve[-1] if curve else None))
        directions.append(
            Direction(
                crimp=own.length / own.spacing - 1.0, stiffness=float(1.0 / soft[axis, axis]),
                bending=own.yarn.bending / other.spacing * own.spacing / own.length,
                contraction=float(-soft[1 - axis, axis] / soft[axis, axis]),
                curve=tuple(curve),
            )
        )  # fmt: skip
    mass = sum(
        own.yarn.linear_density * own.length / (own.spacing * other.spacing)
        for own, other in ((warp, weft), (weft, warp))
    )
    bent = sum(
        other.spacing * own.length**3 / (12.0 * own.yarn.bending * own.spacing)
        for own, other in ((warp, weft), (weft, warp))
    )
    return Woven(
        systems, top, mass, max(own.wave + own.yarn.height for own in systems), directions[0], directions[1],
        1.0 / bent,
        min(locking_angle(own.yarn.width, other.spacing) for own, other in ((warp, weft), (weft, warp))),
    )  # fmt: skip


def stiffness_at(woven: Woven, axis: int, strain: float) -> float:
    """Return the secant stiffness of warp (0) or weft (1) at a strain [N/m], between points of its curve."""
    direction = (woven.warp, woven.weft)[axis]
    strains = np.array([0.0, *(one.strain[axis] for one in direction.curve)])
    return float(np.interp(strain, strains, (0.0, *TENSIONS)) / strain)
