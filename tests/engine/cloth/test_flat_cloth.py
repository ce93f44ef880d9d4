"""`flat_cloth`: what it makes of arrays, what it refuses; the engine's defaults."""

from typing import Any

import numpy as np
import pytest

import toile
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.film.plan import FilmPlan
from toile.engine.film.simulate import Simulation
from toile.engine.step.options import StepOptions
from toile.remesh.panel.rectangle import rectangle

POPLIN = toile.fabric("cotton-poplin")
POINTS, FACES = rectangle(0.4, 0.3, 0.05)
LEVEL = np.column_stack((POINTS[:, 0], np.zeros(len(POINTS)), -POINTS[:, 1]))


def test_area_and_mass_are_those_of_the_rectangle() -> None:
    cloth = flat_cloth(POINTS.tolist(), FACES.tolist(), 2.0 * LEVEL, POPLIN)
    assert cloth.rest_area.sum() == pytest.approx(0.12, rel=1e-12)
    assert cloth.mass.sum() == pytest.approx(0.12 * POPLIN.areal_density, rel=1e-12)
    assert not cloth.pinned.any() and not cloth.velocities.any() and not len(cloth.stitches)
    assert np.array_equal(cloth.face_nodes, FACES)


def test_it_keeps_its_own_arrays() -> None:
    positions, pinned = LEVEL.copy(), np.zeros(len(LEVEL), bool)
    cloth = flat_cloth(POINTS, FACES, positions, POPLIN, pinned)
    positions[:], pinned[:] = 7.0, True
    assert np.array_equal(cloth.positions, LEVEL) and not cloth.pinned.any()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"points": POINTS[:-1]}, r"points must be finite, of shape \(\d+, 2\)"),
        ({"points": np.full_like(POINTS, np.nan)}, "points must be finite"),
        ({"faces": FACES + len(POINTS)}, r"faces refer to vertices outside 0..\d+ \(first: face 0\)"),
        ({"faces": FACES[:, ::-1]}, r"faces run clockwise or have no area in points \(first: face 0\)"),
        ({"positions": POINTS}, r"positions must have shape \(n, 3\)"),
        ({"pinned": [0, 1]}, "pinned marks nodes, a bool for each"),
    ],
)
def test_arrays_that_do_not_fit_are_named(change: dict[str, Any], message: str) -> None:
    arrays: dict[str, Any] = {"points": POINTS, "faces": FACES, "positions": LEVEL, **change}
    with pytest.raises(toile.InputError, match=message):
        flat_cloth(fabric=POPLIN, **arrays)


def test_defaults_let_cloth_fall_as_it_should() -> None:
    plan = FilmPlan(cg_tolerance=1e-8)
    film = Simulation(flat_cloth(POINTS, FACES, LEVEL, POPLIN), None, plan, lambda frame: True)
    record = film.run(0.1)
    steps = record.steps
    # Backward Euler with n steps of h falls by g h^2 n (n + 1) / 2.
    expected = 9.81 * (0.1 / steps) ** 2 * steps * (steps + 1) / 2
    assert film.cloth.positions[:, 1] == pytest.approx(-expected, rel=1e-6)
    assert StepOptions() == FilmPlan().step
