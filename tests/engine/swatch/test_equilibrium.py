"""Patches in equilibrium, beside closed forms and one crossing that minimises its energy by itself."""

import math

import numpy as np
import pytest

from tests.engine.swatch.nets import PLAIN, SPACING, WAVE, net_of, yarn
from toile.engine.swatch.equilibrium import NoEquilibriumError, Patch
from toile.engine.swatch.net import Strand, woven_net
from toile.engine.swatch.terms import gradient
from toile.geometry.arrays import Float


def pulled(tension: float, strand: Strand, count: int = 12, axis: int = 0) -> tuple[Patch, float, float]:
    """Pull a square along one of its yarns; return it, and the strains of its middle along and across."""
    net, state = net_of(count, count, strand)
    free = np.ones_like(state, dtype=bool)
    free[: net.crossings, 2] = False
    free[net.crossings :, :2] = False
    grid = net.grid if axis == 0 else net.grid.T
    free[grid[:, 0], axis] = False
    free[grid[count // 2, 0], 1 - axis] = False
    patch = Patch(net._replace(shear=0.0), state, free)
    patch.pull[grid[:, -1], axis] = tension * SPACING
    patch.settle()
    x, c = patch.state[grid], count // 2
    along = (x[c, c + 1, axis] - x[c, c - 1, axis]) / (2.0 * SPACING) - 1.0
    across = (x[c + 1, c, 1 - axis] - x[c - 1, c, 1 - axis]) / (2.0 * SPACING) - 1.0
    return patch, float(along), float(across)


def test_straight_yarns_stretch_by_their_own_stiffness() -> None:
    _, along, across = pulled(100.0, yarn(wave=0.0))
    assert 100.0 / along == pytest.approx(60.0 / SPACING, rel=1e-6)
    assert across == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("tension", "along", "across", "wave", "force"),
    [(50.0, 0.02970, -0.03658, 0.1355e-3, 6.90e-3), (500.0, 0.07852, -0.17030, 0.0551e-3, 30.59e-3)],
)
def test_waves_pass_from_the_pulled_yarns_to_the_others(
    tension: float, along: float, across: float, wave: float, force: float
) -> None:
    patch, found_along, found_across = pulled(tension, yarn(), count=16)
    assert found_along == pytest.approx(along, rel=0.005)
    assert found_across == pytest.approx(across, rel=0.005)
    net = patch.net
    middle = net.grid[8, 8]
    assert net.half_height + patch.state[net.crossings + middle, 2] == pytest.approx(wave, rel=0.01)
    assert patch.contact_forces()[middle].mean() == pytest.approx(force, rel=0.01)


def test_warp_and_weft_are_alike() -> None:
    warp, weft = (pulled(50.0, yarn(), axis=axis)[1:] for axis in (0, 1))
    assert warp == pytest.approx(weft, rel=1e-5)


def test_same_input_gives_the_same_bytes() -> None:
    assert pulled(50.0, yarn())[0].state.tobytes() == pulled(50.0, yarn())[0].state.tobytes()


def one_yarn(count: int, strand: Strand, friction: float, pressed: float) -> Patch:
    """Return one warp yarn that slides through held crossings; zero: pressed as it is found to be."""
    net, state = woven_net(PLAIN, np.ones((1, count), bool), (strand, strand), 0.0, 0.0)
    free = np.zeros_like(state, dtype=bool)
    free[net.slide(net.grid[0, :-1]), 0] = True
    return Patch(
        net, state, free, friction=friction, grip=2e7 if pressed == 0.0 else 1e5,
        pressed=np.full((count, 2), pressed), given=pressed > 0.0, precise=1e-8,
    )  # fmt: skip


def drawn(patch: Patch, steps: int, step: float) -> float:
    """Draw a yarn by its last crossing, and return the force in the end [N]."""
    end = patch.net.crossings + patch.net.grid[0, -1]
    for _ in range(steps):
        patch.state[end, 0] -= step
        patch.settle()
    return -float(patch.reactions()[end, 0])


@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_a_yarn_is_drawn_against_the_friction_of_all_crossings(friction: float) -> None:
    patch = one_yarn(10, yarn(wave=0.0), friction, 5e-3)
    assert drawn(patch, 20, 1e-6) == pytest.approx(10 * friction * 5e-3, rel=1e-6)


def test_tension_grows_from_crossing_to_crossing_as_on_a_capstan() -> None:
    patch = one_yarn(8, yarn(bending=0.0), 0.2, 0.0)
    net = patch.net
    patch.free[net.crossings + net.grid[0, 0], 0] = False
    drawn(patch, 40, 1e-7)
    rest = np.diff(patch.state[net.slide(net.grid[0]), 0])
    tension = 60.0 * (math.hypot(SPACING, WAVE) / rest - 1.0)
    sine = WAVE / math.hypot(SPACING, WAVE)
    expected = (1.0 + 0.2 * sine) / (1.0 - 0.2 * sine)
    np.testing.assert_allclose(tension[1:] / tension[:-1], expected, rtol=1e-3)


def test_friction_takes_what_a_cycle_loses() -> None:
    patch = one_yarn(8, yarn(wave=0.0), 0.3, 5e-3)
    net = patch.net
    end = net.crossings + net.grid[0, -1]
    lost, rubbed, before = 0.0, 0.0, 0.0
    for way in [1.0] * 40 + [-1.0] * 40:
        anchors = patch.anchors[:, 0].copy()
        force = drawn(patch, 1, 5e-8 * way)
        lost += 0.5 * (before + force) * 5e-8 * way
        rubbed += 0.3 * 5e-3 * float(np.abs(patch.anchors[:, 0] - anchors).sum())
        before = force
    held = patch.state[net.crossings :, 0] - patch.anchors[:, 0]
    lost -= patch.stored() + 0.5 * patch.grip * float((held**2).sum())
    assert rubbed > 0.0
    assert lost == pytest.approx(rubbed, rel=0.02)
    assert end == net.crossings + 7


def cantilever(count: int, gamma: float) -> float:
    """Return drop over reach of a strip of two warps, whose weight is gamma times rigidity over length^3."""
    rigidity, overhang = 1.8e-9 / math.hypot(SPACING, WAVE), (count - 1.5) * SPACING
    density = gamma * rigidity / overhang**3 / 9.81 * SPACING**2 / math.hypot(SPACING, WAVE)
    strands = (yarn(linear_density=density), yarn(linear_density=0.0))
    net, state = woven_net(PLAIN, np.ones((2, count), bool), strands, 20.0, 0.0)
    free = np.ones_like(state, dtype=bool)
    free[net.crossings :, :2] = False
    free[net.grid[:, :2].ravel()] = False
    patch = Patch(net, state, free, gravity=np.array([0.0, 0.0, -9.81]))
    patch.settle()
    tip = patch.state[net.grid[0, -1]]
    return -float(tip[2]) / (float(tip[0]) - 0.5 * SPACING)


def test_a_strip_bends_as_the_heavy_elastica() -> None:
    assert cantilever(21, 1.0) == pytest.approx(0.124562, rel=0.01)


def test_reactions_balance_the_pull() -> None:
    patch, _, _ = pulled(50.0, yarn())
    held = ~patch.free[: patch.net.crossings, 0]
    total = patch.pull[:, 0].sum()
    assert patch.reactions()[: patch.net.crossings][held, 0].sum() == pytest.approx(-total, rel=1e-5)


def test_the_gradient_vanishes_where_numbers_are_free() -> None:
    patch, _, _ = pulled(50.0, yarn())
    forces: Float = gradient(patch.terms(), len(patch.state))
    forces[: patch.net.crossings] -= patch.pull
    assert np.abs(forces[patch.free]).max() < 1e-5 * np.abs(forces).max()


def test_no_equilibrium_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("toile.engine.swatch.equilibrium.MOST_ITERATIONS", 1)
    with pytest.raises(NoEquilibriumError, match="no equilibrium after 1 iterations"):
        pulled(500.0, yarn())
