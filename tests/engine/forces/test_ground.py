"""The floor as a force."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from toile.engine.forces.force import StepState
from toile.engine.forces.ground import FRICTION, SLIP, STIFFNESS, Ground
from toile.geometry.arrays import Float

AREA = np.array([1e-4, 2e-4, 3e-4])
PLACES = np.array([[0.0, -1e-3, 0.0], [0.1, 5e-4, 0.0], [0.2, 0.02, 0.1]])


def step(gravity: float = 1.0) -> Any:
    return SimpleNamespace(request=SimpleNamespace(gravity=gravity))


class Blocks:
    """Takes the blocks of nodes."""

    def add_nodes(self, blocks: Float) -> None:
        self.blocks = blocks


def begun(height: float = 0.0) -> Ground:
    force = Ground(height, AREA)
    state: StepState = step()
    assert force.begin(state, PLACES)
    return force


def test_gradient_and_hessian_are_those_of_the_energy() -> None:
    force, blocks = begun(), Blocks()
    x = PLACES + np.array([[2e-4, -1e-4, 1e-4], [1e-4, 1e-4, 0.0], [0.0, 0.0, 0.0]])
    gradient = np.zeros((3, 3))
    force.linearise(x, gradient, blocks)  # type: ignore[arg-type]
    for node in range(3):
        for axis in range(3):
            nudge = np.zeros((3, 3))
            nudge[node, axis] = 1e-7
            slope = (force.energy(x + nudge) - force.energy(x - nudge)) / 2e-7
            assert slope == pytest.approx(gradient[node, axis], abs=1e-6)
            ahead, behind = np.zeros((3, 3)), np.zeros((3, 3))
            force.add_gradient(x + nudge, ahead)
            force.add_gradient(x - nudge, behind)
            assert (ahead - behind)[node] / 2e-7 == pytest.approx(
                blocks.blocks[node, axis], rel=1e-6, abs=1e-6
            )


def test_cloth_sinks_in_by_its_weight_and_slides_at_friction() -> None:
    """A node of 0.2 kg/m2 rests 1 um deep; pushed a slip aside where PLACES are it is held by mu p A."""
    weight, force = 0.2 * 9.81, begun()
    depth = weight / STIFFNESS
    gradient = np.zeros((3, 3))
    force.add_gradient(np.array([[0.0, -depth, 0.0], *PLACES[1:]]), gradient)
    assert -gradient[0, 1] == pytest.approx(-weight * AREA[0] * -1.0)
    pushed = np.zeros((3, 3))
    force.add_gradient(PLACES + np.array([SLIP, 0.0, 0.0]), pushed)
    assert pushed[0, 0] == pytest.approx(FRICTION * STIFFNESS * 1e-3 * AREA[0])
    assert pushed[1, 0] == pushed[2, 0] == 0.0


def test_it_acts_only_under_gravity_and_near_the_floor() -> None:
    force = Ground(0.0, AREA)
    assert not force.begin(step(gravity=0.0), PLACES)
    assert not force.begin(step(), PLACES + np.array([0.0, 0.1, 0.0]))
