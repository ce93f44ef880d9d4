"""One crossing of a weave in equilibrium: how far it gives when warp and weft are pulled.

A yarn changes sides over a share f of its crossings, where it rises by its wave height h over the spacing p
(slope a = atan(h/p)), and lies flat over the rest: l = f sqrt(p^2 + h^2) + (1 - f) p is its length per
crossing. With L its rest length, k_s and k_b its axial and bending stiffness, q the squares of its turns over
a^2 and a_0 its slope at rest, its energy is

    E = k_s L/2 (l/L - 1)^2 + k_b q/(2 L) (a - a_0)^2

Warp and weft touch: their wave heights add up to the heights of both yarns (Peirce 1937). What one gains the
other loses. The crossing minimises both energies less the work of the pull over the two spacings and the
warp's wave height.
"""

from typing import NamedTuple

import numpy as np

from toile.dressing.weave.interlacing import Interlacing
from toile.dressing.weave.yarn import Yarn
from toile.geometry.arrays import Float

ITERATIONS = 200
PRECISE = 1e-10
"""Share of the spacing that is no motion."""


class System(NamedTuple):
    """Yarns of one direction.

    Attributes
    ----------
    yarn
        The yarn.
    spacing
        Distance of the crossings along it [m].
    wave
        How high it rises from one side to the other [m].
    interlacing
        How it interlaces with the others.
    set
        Share of its turns that it keeps without load: 1 in finished cloth, 0 for straight yarn.
    """

    yarn: Yarn
    spacing: float
    wave: float
    interlacing: Interlacing
    set: float

    @property
    def length(self) -> float:
        """Length of yarn per crossing [m]."""
        return _length(self.spacing, self.wave, self.interlacing.changes)[0]

    @property
    def slope(self) -> float:
        """Slope of the yarn where it changes sides [rad]."""
        return float(np.arctan2(self.wave, self.spacing))


class Pulled(NamedTuple):
    """A crossing under load: strains of warp and weft, the warp's wave [m], force between its yarns [N]."""

    strain: tuple[float, float]
    wave: float
    force: float


def _length(p: float, h: float, f: float) -> tuple[float, Float, Float]:
    """Length per crossing, its gradient and Hessian by spacing and wave height."""
    r = np.hypot(p, h)
    gradient = np.array([f * p / r + 1.0 - f, f * h / r])
    hessian = f / r**3 * np.array([[h * h, -p * h], [-p * h, p * p]])
    return float(f * r + (1.0 - f) * p), gradient, hessian


def _slope(p: float, h: float) -> tuple[float, Float, Float]:
    """Slope, its gradient and Hessian by spacing and wave height."""
    square = p * p + h * h
    gradient = np.array([-h, p]) / square
    hessian = np.array([[2.0 * p * h, h * h - p * p], [h * h - p * p, -2.0 * p * h]]) / square**2
    return float(np.arctan2(h, p)), gradient, hessian


def yarn_energy(system: System, p: float, h: float) -> tuple[float, Float, Float]:
    """Return the energy of a yarn per crossing [J], gradient and Hessian by spacing and wave height [m]."""
    rest, yarn = system.length, system.yarn
    length, dl, ddl = _length(p, h, system.interlacing.changes)
    slope, da, dda = _slope(p, h)
    strain, turn = length / rest - 1.0, slope - system.set * system.slope
    bending = yarn.bending * system.interlacing.turns / rest
    return (
        0.5 * yarn.stiffness * rest * strain**2 + 0.5 * bending * turn**2,
        yarn.stiffness * strain * dl + bending * turn * da,
        yarn.stiffness * (np.outer(dl, dl) / rest + strain * ddl) + bending * (np.outer(da, da) + turn * dda),
    )


def _energy(warp: System, weft: System, at: Float, pull: Float) -> tuple[float, Float, Float]:
    """Energy of a crossing, gradient and Hessian by warp's and weft's spacing and the warp's wave height."""
    height = warp.wave + weft.wave
    one, d_one, dd_one = yarn_energy(warp, at[0], at[2])
    other, d_other, dd_other = yarn_energy(weft, at[1], height - at[2])
    gradient, hessian = np.zeros(3), np.zeros((3, 3))
    gradient[[0, 2]] += d_one
    gradient[[1, 2]] += d_other * (1.0, -1.0)
    hessian[np.ix_((0, 2), (0, 2))] += dd_one
    hessian[np.ix_((1, 2), (1, 2))] += dd_other * ((1.0, -1.0), (-1.0, 1.0))
    gradient[:2] -= pull
    return float(one + other - pull @ at[:2]), gradient, hessian


def pulled(warp: System, weft: System, tension: tuple[float, float], start: Pulled | None = None) -> Pulled:
    """Return the crossing in equilibrium under tensions along warp and weft [N/m of the cloth at rest].

    Newton's method from another equilibrium, with the part of the Hessian that is positive, and backtracking.
    """
    pull = np.array([tension[0] * weft.spacing, tension[1] * warp.spacing])
    rest = np.array([warp.spacing, weft.spacing])
    at = np.append(rest, warp.wave)
    if start is not None:
        at = np.append(rest * (1.0 + np.array(start.strain)), start.wave)
    energy, gradient, hessian = _energy(warp, weft, at, pull)
    for _ in range(ITERATIONS):
        values, vectors = np.linalg.eigh(hessian)
        values = np.maximum(np.abs(values), 1e-9 * np.abs(values).max())
        step = -vectors @ ((vectors.T @ gradient) / values)
        step *= min(1.0, 0.2 * rest.min() / max(float(np.abs(step).max()), 1e-300))
        if np.abs(step).max() < PRECISE * rest.min():
            break
        share = 1.0
        while share > 1e-12:
            there = at + share * step
            trial = _energy(warp, weft, there, pull)
            if (there[:2] > 0.0).all() and trial[0] <= energy + 1e-4 * share * float(gradient @ step):
                at, (energy, gradient, hessian) = there, trial
                break
            share *= 0.5
        else:
            break
    height = warp.wave + weft.wave
    force = yarn_energy(warp, at[0], at[2])[1][1] + yarn_energy(weft, at[1], height - at[2])[1][1]
    strain = at[:2] / rest - 1.0
    return Pulled((float(strain[0]), float(strain[1])), float(at[2]), max(float(force), 0.0))


def compliance(warp: System, weft: System) -> Float:
    """Return strains of warp and weft per tension where nothing pulls [m/N], shape (2, 2)."""
    free = pulled(warp, weft, (0.0, 0.0))
    rest = np.array([warp.spacing, weft.spacing])
    there = np.append(rest * (1.0 + np.array(free.strain)), free.wave)
    hessian = _energy(warp, weft, there, np.zeros(2))[2]
    inverse = np.linalg.inv(hessian)[:2, :2]
    return np.asarray(inverse / rest[:, None] * rest[::-1][None, :])
