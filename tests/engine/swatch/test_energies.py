"""Energies of yarns: their gradients are their slopes, and rigid motion costs nothing."""

import numpy as np
import pytest

from tests.engine.swatch.nets import PLAIN, TWILL, net_of, yarn
from toile.engine.swatch.corner import shear_terms, touch_terms
from toile.engine.swatch.curvature import curvature_terms
from toile.engine.swatch.net import Net
from toile.engine.swatch.piece import piece_terms
from toile.engine.swatch.terms import Terms, energy, gradient
from toile.engine.swatch.wave import wave_terms
from toile.engine.swatch.weight import weight_energy
from toile.geometry.arrays import Bool, Float

KINDS = {
    "stretch": lambda net, state: [piece_terms(net, state)],
    "wave": lambda net, state: [wave_terms(net, state)],
    "curvature": lambda net, state: [curvature_terms(net, state)],
    "shear": lambda net, state: [shear_terms(net, state)],
    "touch": touch_terms,
}


def crumpled(top: Bool = PLAIN) -> tuple[Net, Float]:
    """Return a small net whose crossings are all moved at random, its yarns squeezed together along x."""
    net, state = net_of(4, 5, yarn(set=0.6, width=3e-4), top)
    random = np.random.default_rng(3)
    state[: net.crossings, 0] *= 0.7
    state[: net.crossings] += 2e-5 * random.standard_normal((net.crossings, 3))
    state[net.crossings :] += 5e-6 * random.standard_normal((net.crossings, 3))
    return net, state


@pytest.mark.parametrize("top", [PLAIN, TWILL], ids=["plain", "twill"])
@pytest.mark.parametrize("kind", KINDS)
def test_gradients_are_slopes(kind: str, top: Bool) -> None:
    net, state = crumpled(top)
    elements = KINDS[kind]
    found = gradient(elements(net, state), len(state))
    step, expected = 1e-9, np.zeros_like(state)
    for at in np.ndindex(state.shape):
        ahead, behind = state.copy(), state.copy()
        ahead[at] += step
        behind[at] -= step
        expected[at] = (energy(elements(net, ahead)) - energy(elements(net, behind))) / (2.0 * step)
    assert sum(len(one.nodes) for one in elements(net, state)) > 0
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("kind", KINDS)
def test_hessians_have_no_negative_part(kind: str) -> None:
    net, state = crumpled()
    for one in KINDS[kind](net, state):
        values = np.linalg.eigvalsh(one.hessian)
        assert values.min(initial=0.0) >= -1e-9 * values.max(initial=0.0)


def test_weight_has_the_slope_of_its_energy() -> None:
    net, state = crumpled()
    gravity = np.array([0.0, 1.0, -9.81])
    found = weight_energy(net, state, gravity)[1]
    random = np.random.default_rng(5)
    way = random.standard_normal(state.shape)
    ahead, behind = (weight_energy(net, state + sign * 1e-6 * way, gravity)[0] for sign in (1.0, -1.0))
    assert (ahead - behind) / 2e-6 == pytest.approx(float((found * way).sum()), rel=1e-7)


def all_terms(net: Net, state: Float) -> list[Terms]:
    return [one for elements in KINDS.values() for one in elements(net, state)]


def test_turned_and_moved_yarns_store_the_same() -> None:
    net, state = crumpled()
    turn = np.linalg.qr(np.random.default_rng(1).standard_normal((3, 3)))[0]
    moved = state.copy()
    moved[: net.crossings] = state[: net.crossings] @ turn + [0.3, -0.1, 0.2]
    moved[net.crossings :, :2] += [1e-3, -2e-3]
    assert energy(all_terms(net, moved)) == pytest.approx(energy(all_terms(net, state)), rel=1e-9)
    forces = gradient(all_terms(net, state), len(state))
    scale = np.abs(forces).max()
    np.testing.assert_allclose(forces[: net.crossings].sum(axis=0), 0.0, atol=1e-12 * scale * len(state))
    np.testing.assert_allclose(forces[net.crossings :, :2].sum(axis=0), 0.0, atol=1e-9 * scale)
    torque = np.cross(state[: net.crossings], forces[: net.crossings]).sum(axis=0)
    np.testing.assert_allclose(torque, 0.0, atol=1e-12 * scale)


def test_a_weave_at_rest_has_no_force() -> None:
    for top in (PLAIN, TWILL):
        net, state = net_of(6, 5, yarn(), top)
        assert np.abs(gradient(all_terms(net, state), len(state))).max() < 1e-12
