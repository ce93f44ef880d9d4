import numpy as np
import pytest

from toile.engine.forces.hold import Holds, SewingHolds
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.state import Instant

STIFFNESS = 30.0


def test_gradient_and_hessian_are_the_derivatives_of_the_energy() -> None:
    generator = np.random.default_rng(0)
    x = generator.normal(size=(6, 3))
    nodes = np.array([1, 4, 4], np.int32)
    holds = Holds(nodes, generator.normal(size=(3, 3)), np.array([(1, 1, 1), (0, 1, 0), (0.5, 0, 2)], float))
    assert holds.begin(Instant(StepRequest(h=0.01, at_rest=True, hold_stiffness=STIFFNESS), x, x), x)
    gradient = np.zeros_like(x)
    holds.add_gradient(x, gradient)
    stencils = holds.stencils()
    assert stencils.nodes[:, 0].tolist() == [1, 4, 4] and (stencils.nodes[:, 1:] == -1).all()
    blocks = np.zeros((6, 3, 3))
    np.add.at(blocks, stencils.nodes[:, 0], stencils.weights[:, 0, None, None] ** 2 * stencils.stiffness)
    for node in range(6):
        for axis in range(3):
            step = np.zeros_like(x)
            step[node, axis] = 1e-4
            up, down = holds.energy(x + step), holds.energy(x - step)
            assert gradient[node, axis] == pytest.approx((up - down) / 2e-4, abs=1e-7)
            there, back = np.zeros_like(x), np.zeros_like(x)
            holds.add_gradient(x + step, there)
            holds.add_gradient(x - step, back)
            assert blocks[node, :, axis] == pytest.approx((there - back)[node] / 2e-4, abs=1e-7)


def test_sewn_nodes_meet_and_labelled_nodes_keep_their_height() -> None:
    """Nodes 0 and 1, in panels at z = 0 and z = 0.2, are sewn; node 3 is a waistband's."""
    x = np.array([(0.0, 1.0, 0.0), (0.4, 1.2, 0.2), (5.0, 5.0, 5.0), (2.0, 0.7, 0.0)])
    normals = np.tile([0.0, 0.0, 1.0], (4, 1))
    weld = np.array([0, 0, 1, 2], np.int32)
    holds = SewingHolds(x, normals, weld, np.array([(0, 1)], np.int32), np.array([0, 3], np.int32))
    assert holds.held.tolist() == [0, 1, 3]
    assert holds.axes.tolist() == [[1, 1, 1], [1, 1, 1], [0, 1, 0]]
    meeting = np.array([0.2, 1.1, 0.1])
    holds.approach(np.zeros(4))
    assert holds.targets[:2] == pytest.approx(np.array([meeting, meeting]))
    holds.approach(np.ones(4))
    assert holds.targets[:, 2] == pytest.approx(x[[0, 1, 3], 2])
    assert holds.targets[:2, :2] == pytest.approx(np.array([meeting, meeting])[:, :2])
    assert holds.targets[2, 1] == 0.7
    holds.approach(np.array([0.5, 0.0, 0.0, 0.0]))
    assert holds.targets[0, 2] == pytest.approx(0.05) and holds.targets[1, 2] == pytest.approx(0.1)
