import numpy as np
import pytest

from toile.engine.forces.tighten import Tightening
from toile.geometry.arrays import Float

STIFFNESS = 50.0
FACES = np.array([(0, 1, 2), (2, 1, 3), (3, 1, 4)], np.int32)
MARKED = np.array([True, True, True, True, False])


def gradient(springs: Tightening, x: Float) -> Float:
    total = np.zeros_like(x)
    springs.add_gradient(x, STIFFNESS, total)
    return total


def test_springs_are_the_edges_between_marked_nodes() -> None:
    springs = Tightening(FACES, MARKED)
    assert springs.edges.tolist() == [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]
    assert len(Tightening(FACES, ~MARKED).edges) == 0


def test_gradient_and_hessian_are_the_derivatives_of_the_energy() -> None:
    x = np.random.default_rng(0).normal(size=(5, 3))
    springs = Tightening(FACES, MARKED)
    found = gradient(springs, x)
    stencils = springs.stencils(STIFFNESS)
    hessian = np.zeros((5, 3, 5, 3))
    for nodes, weights, block in zip(stencils.nodes, stencils.weights, stencils.stiffness, strict=True):
        for a in range(2):
            for b in range(2):
                hessian[nodes[a], :, nodes[b], :] += weights[a] * weights[b] * block
    assert (stencils.nodes[:, 2:] == -1).all()
    for node in range(5):
        for axis in range(3):
            step = np.zeros_like(x)
            step[node, axis] = 1e-4
            slope = (springs.energy(x + step, STIFFNESS) - springs.energy(x - step, STIFFNESS)) / 2e-4
            assert found[node, axis] == pytest.approx(slope, abs=1e-7)
            change = (gradient(springs, x + step) - gradient(springs, x - step)) / 2e-4
            assert hessian[:, :, node, axis] == pytest.approx(change, abs=1e-7)
