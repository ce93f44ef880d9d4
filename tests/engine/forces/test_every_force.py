"""Every force keeps the protocol: derivatives of its energy, a positive Hessian, positions left alone."""

import inspect
import pkgutil
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest

import toile.engine.forces
import toile.engine.step.collisions
from tests.engine.forces.force_cases import CASES
from tests.engine.forces.moving_step import MovingStep
from toile.engine.forces.added.surface_pressure import SurfacePressure
from toile.engine.forces.force import Force
from toile.engine.forces.hold import Holds
from toile.engine.forces.laws.bend_damping import BendDamping
from toile.engine.forces.stitch import Stitches
from toile.engine.forces.untangle import Untangling
from toile.engine.solve.hessian import Hessian
from toile.engine.step.collisions import Collisions
from toile.geometry.arrays import Float

EXACT = [name for name, make in CASES.items() if make().exact]
SCALE = 3e-6
"""Error of differences as a share of the largest derivative."""


def close(found: Float, expected: Float) -> bool:
    return bool(np.abs(found - expected).max() <= SCALE * np.abs(expected).max())


@pytest.mark.parametrize("name", CASES)
def test_gradient_is_the_derivative_of_the_energy(name: str) -> None:
    case = CASES[name]()
    assert case.begun()
    gradient = case.gradient(case.x)
    assert np.abs(gradient).max() > 1e-6
    assert close(case.differences(case.force.energy)[:, 0], gradient.ravel())


@pytest.mark.parametrize("name", CASES)
def test_linearise_adds_the_same_gradient(name: str) -> None:
    case = CASES[name]()
    case.begun()
    found, expected = case.linearised(case.x)[0], case.gradient(case.x)
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-14 * np.abs(expected).max())


@pytest.mark.parametrize("name", CASES)
def test_it_adds_to_what_is_there(name: str) -> None:
    case = CASES[name]()
    case.begun()
    there, alone = np.random.default_rng(7).normal(size=case.x.shape), case.gradient(case.x)
    total = there.copy()
    case.force.add_gradient(case.x, total)
    small = 1e-12 * max(1.0, float(np.abs(alone).max()))
    assert total - there == pytest.approx(alone, abs=small)
    nodes = case.force.nodes
    hessian = Hessian(len(there), [] if nodes is None else [nodes])
    once = case.linearised(case.x)[1]
    for _ in range(2):
        case.force.linearise(case.x, total, hessian)
    assert total - there == pytest.approx(3.0 * alone, abs=3.0 * small)
    if case.force.constant_matrix is None:
        assert hessian.to_dense() == pytest.approx(2.0 * once, abs=1e-12 * np.abs(once).max())


@pytest.mark.parametrize("name", CASES)
def test_hessian_is_symmetric_and_never_negative(name: str) -> None:
    case = CASES[name]()
    case.begun()
    hessian = case.linearised(case.x)[1]
    most = np.abs(hessian).max()
    # Within a step pressure is a dead load; damping of bending adds to its matrix, which is not here.
    assert most > 0.0 or isinstance(case.force, SurfacePressure | BendDamping)
    assert np.abs(hessian - hessian.T).max() <= 1e-12 * most
    assert np.linalg.eigvalsh(0.5 * (hessian + hessian.T)).min() >= -1e-9 * most


@pytest.mark.parametrize("name", EXACT)
def test_hessian_is_exact_where_all_of_it_is_positive(name: str) -> None:
    case = CASES[name]()
    case.begun()
    hessian = case.linearised(case.x)[1]
    assert close(case.differences(case.gradient), hessian)


@pytest.mark.parametrize("name", CASES)
def test_positions_are_left_alone(name: str) -> None:
    case = CASES[name]()
    start, x = case.start.copy(), case.x.copy()
    case.begun()
    case.force.energy(case.x)
    case.gradient(case.x)
    case.linearised(case.x)
    assert np.array_equal(case.start, start) and np.array_equal(case.x, x)


@pytest.mark.parametrize("name", CASES)
def test_what_is_asked_for_nothing_says_that_it_does_not_act(name: str) -> None:
    case = CASES[name]()
    idle = replace(case.request, stitch_stiffness=0.0, hold_stiffness=0.0, untangle_stiffness=0.0)
    asked_for = isinstance(case.force, Stitches | Holds | Untangling)
    assert case.force.begin(MovingStep(idle, case.start), case.start) is not asked_for
    assert case.begun()


def test_bending_counts_with_the_factor_of_the_step() -> None:
    """Its energy stays that of the fabric."""
    case = CASES["bending, curved"]()
    case.begun()
    energy, (gradient, hessian) = case.force.energy(case.x), case.linearised(case.x)
    stiff = replace(case, request=replace(case.request, bending_factor=4.0))
    stiff.begun()
    assert stiff.force.energy(case.x) == energy
    found = stiff.linearised(case.x)
    assert found[0] == pytest.approx(4.0 * gradient) and found[1] == pytest.approx(4.0 * hessian)
    assert stiff.gradient(case.x) == pytest.approx(4.0 * gradient)


@pytest.mark.parametrize(("name", "moved"), [("goals", 0.1), ("moving goals", -0.2)])
def test_goals_are_where_the_step_has_them(name: str, moved: float) -> None:
    case = CASES[name]()
    case.begun()
    there = case.start + moved
    assert case.force.energy(there) == pytest.approx(0.0, abs=1e-20)
    assert case.force.energy(case.start) > 0.01


def test_collisions_meet_both_the_avatar_and_cloth_in_every_way() -> None:
    """Vertices on faces and edges on edges, near and far: what the case of contact stands on."""
    case = CASES["collisions"]()
    assert isinstance(case.force, Collisions)
    contacts = case.force.detect(case.x)
    assert contacts.body == 6 and contacts.count > 9
    weights = np.sign(contacts.weights[contacts.body :])
    on_faces = (weights[:, :2] > 0.0).sum(axis=1) == 1
    assert on_faces.any() and not on_faces.all()
    gap = contacts.gap / np.where(np.arange(contacts.count) < contacts.body, 2e-3, 1e-3)
    assert (gap < 0.5).any() and (gap > 0.5).any()


def test_every_class_of_forces_is_here() -> None:
    names = [
        found.name
        for found in pkgutil.walk_packages(toile.engine.forces.__path__, "toile.engine.forces.")
        if not found.ispkg
    ]
    found: set[type] = set()
    for name in [*names, toile.engine.step.collisions.__name__]:
        for kind in vars(import_module(name)).values():
            if inspect.isclass(kind) and kind.__module__ == name and _is_force(kind):
                found.add(kind)
    assert found == {type(make().force) for make in CASES.values()}


def _is_force(kind: type) -> bool:
    if inspect.isabstract(kind) or kind is Force:
        return False
    return all(hasattr(kind, name) for name in ("begin", "energy", "add_gradient", "linearise"))
