"""One crossing against closed forms, published geometry and finite differences."""

import math

import numpy as np
import pytest

from toile.dressing.weave.crossing import Pulled, System, compliance, pulled, yarn_energy
from toile.dressing.weave.interlacing import Interlacing, interlacings, weave_named
from toile.dressing.weave.yarn import Yarn

POPLIN = Yarn(linear_density=2e-5, stiffness=60.0, bending=1.8e-9, height=0.167e-3, width=0.167e-3)
SPACING = 0.4e-3
PLAIN = Interlacing(1.0, 4.0)

# A lattice of 20 x 20 crossings with six unknowns each, worked out apart from this code: tension [N/m],
# strains along and across, wave of the pulled yarn [mm], force between yarns [mN].
LATTICE = (
    (1.0, 0.00084, -0.00084, 0.1662, 0.17),
    (10.0, 0.00781, -0.00815, 0.1594, 1.60),
    (50.0, 0.02970, -0.03658, 0.1355, 6.90),
    (100.0, 0.04556, -0.06473, 0.1150, 11.91),
    (250.0, 0.06656, -0.12051, 0.0807, 21.65),
    (500.0, 0.07852, -0.17030, 0.0551, 30.59),
    (1000.0, 0.08750, -0.21666, 0.0343, 39.43),
)


def systems(set: float = 1.0, interlacing: Interlacing = PLAIN) -> tuple[System, System]:
    one = System(POPLIN, SPACING, POPLIN.height, interlacing, set)
    return one, one


def test_curve_is_that_of_a_lattice_of_crossings() -> None:
    found: Pulled | None = None
    for tension, along, across, wave, force in LATTICE:
        found = pulled(*systems(), (tension, 0.0), found)
        assert found.strain[0] == pytest.approx(along, abs=6e-6)
        assert found.strain[1] == pytest.approx(across, abs=6e-6)
        assert found.wave == pytest.approx(wave * 1e-3, abs=6e-8)
        assert found.force == pytest.approx(force * 1e-3, rel=0.015, abs=6e-6)


def test_warp_and_weft_are_alike() -> None:
    along, across = pulled(*systems(), (50.0, 0.0)), pulled(*systems(), (0.0, 50.0))
    assert across.strain == pytest.approx(along.strain[::-1], rel=1e-9)
    assert across.wave == pytest.approx(2.0 * POPLIN.height - along.wave, rel=1e-9)


@pytest.mark.parametrize("set", [0.0, 1.0])
def test_initial_stiffness_is_the_closed_form(set: float) -> None:
    """8 k_b (1 + (1 - set) a tan a)/(p^2 L tan^2 a), in series with the yarn: p/k_s."""
    slope = math.atan(POPLIN.height / SPACING)
    length = math.hypot(SPACING, POPLIN.height)
    waves = 8.0 * POPLIN.bending * (1.0 + (1.0 - set) * slope * math.tan(slope))
    waves /= SPACING**2 * length * math.tan(slope) ** 2
    # Yarn of length L along the slope gives 1/cos^2 as much as a straight one.
    yarn = length / SPACING / math.cos(slope) ** 2 * SPACING / POPLIN.stiffness
    soft = compliance(*systems(set))
    assert 1.0 / soft[0, 0] == pytest.approx(1.0 / (1.0 / waves + yarn), rel=5e-3)
    assert soft[0, 1] == pytest.approx(soft[1, 0], rel=1e-9)
    assert -soft[1, 0] / soft[0, 0] == pytest.approx(1.0, abs=0.02)


def test_straight_yarns_are_as_stiff_as_yarn() -> None:
    straight = System(POPLIN, SPACING, 0.0, Interlacing(1.0, 4.0), 1.0)
    found = pulled(straight, straight, (100.0, 0.0))
    assert 100.0 / found.strain[0] == pytest.approx(POPLIN.stiffness / SPACING, rel=1e-9)
    assert found.strain[1] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("interlacing", [PLAIN, Interlacing(0.4, 1.2)])
def test_derivatives_are_those_of_the_energy(interlacing: Interlacing) -> None:
    system = systems(0.6, interlacing)[0]
    at, h = np.array([1.03 * SPACING, 0.8 * POPLIN.height]), 1e-9
    _, gradient, hessian = yarn_energy(system, *at)
    for axis in range(2):
        step = h * np.eye(2)[axis]
        plus, minus = yarn_energy(system, *(at + step)), yarn_energy(system, *(at - step))
        assert (plus[0] - minus[0]) / (2.0 * h) == pytest.approx(gradient[axis], rel=1e-6)
        assert (plus[1] - minus[1]) / (2.0 * h) == pytest.approx(hessian[axis], rel=1e-6)


@pytest.mark.parametrize(
    ("name", "changes", "turns"),
    [
        ("plain", 1.0, 4.0),
        ("twill", 0.5, 1.0),
        ("2/1", 2.0 / 3.0, 2.0),
        ("3/1", 0.5, 1.5),
        ("satin", 0.4, 1.2),
    ],
)
def test_yarns_turn_where_they_change_sides(name: str, changes: float, turns: float) -> None:
    for found in interlacings(weave_named(name)):
        assert found == pytest.approx((changes, turns))


def test_long_floats_stretch_less() -> None:
    """The fewer the waves, the less there is to straighten."""
    limits = []
    for name in ("plain", "2/1", "satin"):
        own = System(POPLIN, SPACING, POPLIN.height, interlacings(weave_named(name))[0], 1.0)
        limits.append(pulled(own, own, (1000.0, 0.0)).strain[0])
    assert limits == sorted(limits, reverse=True)
