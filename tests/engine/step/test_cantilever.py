"""A heavy strip sags as the elastica does: H/W of its tip against the exact solution."""

import numpy as np
import pytest

from toile.studies.scenes.flat_meshes import KINDS
from toile.studies.validation.heavy_strip import clamped_strip, equilibrium
from toile.studies.validation.validate_cantilever import ELASTICA

GAMMAS = [0.1, 1.0, 3.16228, 10.0, 31.6228, 100.0]


@pytest.mark.parametrize("kind", KINDS)
def test_sag_of_a_strip(kind: str) -> None:
    """Within 1.5 % at 30 edges per length for Gamma 0.1 to 100 (the bar is 5 %)."""
    states = equilibrium(clamped_strip(kind, 0.2, 1 / 30), GAMMAS)
    for (drop, reach), exact in zip(states, (ELASTICA[gamma] for gamma in GAMMAS), strict=True):
        assert drop / reach == pytest.approx(exact, rel=0.015)


@pytest.mark.parametrize("kind", KINDS)
def test_sag_converges_at_second_order(kind: str) -> None:
    """The clamp ends at the last held side; free borders need no correction: error ~ h^2."""
    errors = [
        abs(np.divide(*equilibrium(clamped_strip(kind, 0.2, edge), [1.0])[0]) / ELASTICA[1.0] - 1)
        for edge in (1 / 8, 1 / 16, 1 / 32)
    ]
    order = np.polyfit(np.log([1 / 8, 1 / 16, 1 / 32]), np.log(errors), 1)[0]
    assert order > 1.6
    assert errors[-1] < 2e-3


@pytest.mark.parametrize("kind", KINDS)
def test_a_stiffer_membrane_hardly_moves_the_strip(kind: str) -> None:
    """Twenty times the membrane stiffness moves H/W by less than 2 %: little locking."""
    strip = clamped_strip(kind, 0.2, 1 / 30)
    gammas = [1.0, 10.0, 100.0]
    soft, stiff = (np.array(equilibrium(strip, gammas, stiffness)) for stiffness in (1e5, 2e6))
    assert np.abs(stiff[:, 0] / stiff[:, 1] / (soft[:, 0] / soft[:, 1]) - 1).max() < 0.02
