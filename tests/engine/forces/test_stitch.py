import numpy as np
import pytest

from toile.engine.forces.step_request import StepRequest
from toile.engine.forces.stitch import Stitches
from toile.engine.step.state import Instant
from toile.geometry.arrays import Float

STIFFNESS = 250.0


def scene(seed: int) -> tuple[Stitches, Float, Float]:
    generator = np.random.default_rng(seed)
    pairs = np.array([(0, 1), (2, 3), (1, 4), (4, 0)], np.int32)
    x, length = generator.normal(size=(5, 3)), generator.uniform(0.0, 0.5, size=4)
    stitches = Stitches(pairs, length)
    request = StepRequest(
        h=0.01, at_rest=True, stitch_share=1.0, stitch_stiffness=STIFFNESS, stitch_reach=np.inf
    )
    assert stitches.begin(Instant(request, np.zeros_like(x), x), x)
    return stitches, x, length


def scattered(stitches: Stitches, count: int) -> Float:
    total = np.zeros((count, 3))
    np.add.at(total, stitches.pairs, stitches.element_gradient)
    return total


@pytest.mark.parametrize("seed", range(5))
def test_gradient_is_the_derivative_of_the_energy(seed: int) -> None:
    stitches, x, length = scene(seed)
    stitches.evaluate(x, length, STIFFNESS)
    gradient = scattered(stitches, len(x))
    assert gradient.sum(axis=0) == pytest.approx(0.0, abs=1e-12)
    for node in range(len(x)):
        for axis in range(3):
            step = np.zeros_like(x)
            step[node, axis] = 1e-6
            slope = stitches.energy(x + step) - stitches.energy(x - step)
            assert gradient[node, axis] == pytest.approx(slope / 2e-6, rel=1e-6, abs=1e-6)


def test_stretched_stitches_have_the_exact_hessian() -> None:
    stitches, x, length = scene(1)
    assert (np.linalg.norm(x[stitches.pairs[:, 0]] - x[stitches.pairs[:, 1]], axis=1) > length).all()
    stitches.evaluate(x, length, STIFFNESS)
    hessian = stitches.element_hessian.copy()
    for s, (a, _) in enumerate(stitches.pairs):
        for axis in range(3):
            step = np.zeros_like(x)
            step[a, axis] = 1e-6
            stitches.evaluate(x + step, length, STIFFNESS)
            change = stitches.element_gradient[s].copy()
            stitches.evaluate(x - step, length, STIFFNESS)
            change = (change - stitches.element_gradient[s]) / 2e-6
            assert hessian[s, 0, :, axis] == pytest.approx(change[0], rel=1e-5, abs=1e-4)
            assert hessian[s, 2, :, axis] == pytest.approx(change[1], rel=1e-5, abs=1e-4)
    assert np.array_equal(hessian[:, 0], hessian[:, 1])


@pytest.mark.parametrize("distance", [0.0, 1e-12, 0.01, 0.1, 1.0])
@pytest.mark.parametrize("length", [0.0, 0.05, 2.0])
def test_blocks_are_finite_and_positive_whatever_the_length(distance: float, length: float) -> None:
    stitches = Stitches(np.array([(0, 1)], np.int32), np.array([length]))
    x = np.array([(0.3, 0.2, 0.1), (0.3, 0.2 + distance, 0.1)])
    stitches.evaluate(x, np.array([length]), STIFFNESS)
    assert np.isfinite(stitches.element_gradient).all()
    values = np.linalg.eigvalsh(stitches.element_hessian[0, 0])
    assert values.min() >= 0.0 and values.max() == pytest.approx(STIFFNESS)
    if length == 0.0:
        assert stitches.element_hessian[0, 0] == pytest.approx(STIFFNESS * np.eye(3))
