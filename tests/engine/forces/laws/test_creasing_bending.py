"""Creases: kept after unfolding as the yield says, on every mesh, and carried through remeshing."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.engine.forces.moving_step import MovingStep
from tests.engine.step.test_only_what_is_asked import SLACK, options, sheet
from toile.engine.adapt.remeshing import carried_over, cloth_mesh
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.forces.laws.creasing_bending import CreasingBending
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.cloth_forces import cloth_stepper
from toile.geometry.arrays import Float
from toile.geometry.stage_clock import StageClock
from toile.remesh.adapt.adapt import adapt
from toile.studies.scenes.flat_meshes import mesh

LENGTH, WIDTH, TIGHTEST = 0.06, 0.03, 60.0
"""Of a strip [m], and the curvature in the middle of it where it is bent most [1/m]."""
HARDENING = 0.5
STEP = StepRequest(h=0.01, at_rest=False)


def creasable(crease_curvature: float, edge: float, kind: str = "right") -> Cloth:
    fabric = replace(
        SLACK, bending_warp=1e-4, bending_weft=1e-4, bending_bias=1e-4, crease_curvature=crease_curvature,
        crease_hardening=HARDENING,
    )  # fmt: skip
    points, faces = mesh(kind, LENGTH, WIDTH, edge)
    return flat_cloth(points, faces, np.pad(points, ((0, 0), (0, 1))), fabric, points[:, 0] < 1.5 * edge)


def bent(points: Float) -> Float:
    """The strip bent over its middle by about 100 degrees: curvature TIGHTEST sin^2(pi s / LENGTH)."""
    s = np.linspace(0.0, LENGTH, 4001)
    angle = np.cumsum(TIGHTEST * np.sin(np.pi * s / LENGTH) ** 2) * (s[1] - s[0])
    across, up = (np.cumsum(f(angle)) * (s[1] - s[0]) for f in (np.cos, np.sin))
    place = points[:, 0]
    return np.column_stack((np.interp(place, s, across), points[:, 1], np.interp(place, s, up)))


@cache
def kept(crease_curvature: float, edge: float, kind: str = "right") -> float:
    """Angle [rad] that a strip keeps between its ends after it was bent and let go."""
    cloth = creasable(crease_curvature, edge, kind)
    stepper = cloth_stepper(cloth, None, replace(options(), gravity=0.0), StageClock())
    force = stepper.force(CreasingBending)
    assert force is not None
    x = bent(cloth.uv)
    force.begin(MovingStep(STEP, x), x)
    for number in range(120):
        stepper.step(StepRequest(h=min(2e-3 * 1.2**number, 1.0), at_rest=True, cg_tolerance=1e-3))
    free = np.linalg.norm(cloth.uv[:, None] - [[LENGTH, 0.0], [LENGTH - 0.01, 0.0]], axis=2).argmin(axis=0)
    way = stepper.x[free[0]] - stepper.x[free[1]]
    return float(np.arctan2(abs(way[2]), way[0]))


def theory(crease_curvature: float) -> float:
    s = np.linspace(0.0, LENGTH, 4001)
    beyond = np.maximum(TIGHTEST * np.sin(np.pi * s / LENGTH) ** 2 - crease_curvature, 0.0)
    return float(beyond.sum() * (s[1] - s[0]) / (1.0 + HARDENING))


@pytest.mark.parametrize("kind", ["right", "random"])
@pytest.mark.parametrize("crease_curvature", [10.0, 25.0])
def test_a_strip_keeps_what_theory_says_on_every_mesh(crease_curvature: float, kind: str) -> None:
    coarse, fine = (kept(crease_curvature, edge, kind) for edge in (0.005, 0.0025))
    assert fine == pytest.approx(theory(crease_curvature), rel=0.05)
    assert coarse == pytest.approx(fine, rel=0.05)


def test_cloth_that_yields_later_keeps_less() -> None:
    angles = [kept(curvature, 0.005) for curvature in (5.0, 10.0, 25.0, 40.0, 70.0)]
    assert (np.diff(angles) < 0.0).all()
    assert angles[-1] == pytest.approx(0.0, abs=1e-6)


def test_yielding_twice_to_one_shape_changes_nothing() -> None:
    cloth = creasable(10.0, 0.005)
    force = CreasingBending.for_cloth(cloth)
    assert cloth.creases is not None
    x = bent(cloth.uv)
    force.begin(MovingStep(replace(STEP, at_rest=True), x), x)
    assert not cloth.creases.worked.any()
    force.begin(MovingStep(STEP, x), x)
    once = cloth.creases.curvature.copy()
    assert once.any()
    force.begin(MovingStep(STEP, x), x)
    np.testing.assert_allclose(cloth.creases.curvature, once, rtol=1e-12, atol=1e-9)
    # Another force of the same cloth knows them.
    again = CreasingBending.for_cloth(cloth)
    assert again.energy(x) == pytest.approx(force.energy(x))


def test_gradient_is_the_derivative_of_the_energy() -> None:
    cloth = creasable(10.0, 0.01)
    force = CreasingBending.for_cloth(cloth)
    x = bent(cloth.uv)
    force.begin(MovingStep(STEP, x), x)
    generator = np.random.default_rng(3)
    there, way = x + 0.001 * generator.normal(size=x.shape), generator.normal(size=x.shape)
    gradient = np.zeros_like(x)
    force.add_gradient(there, gradient)
    slope = (force.energy(there + 1e-8 * way) - force.energy(there - 1e-8 * way)) / 2e-8
    assert slope == pytest.approx(float(np.vdot(gradient, way)), rel=1e-5)


def test_remeshing_carries_creases() -> None:
    """Their mean over the cloth, by area, stays to what moved borders of faces account for."""
    cloth = creasable(10.0, 0.005)
    force = CreasingBending.for_cloth(cloth)
    x = bent(cloth.uv)
    force.begin(MovingStep(STEP, x), x)
    assert cloth.creases is not None
    before = cloth.rest_area @ cloth.creases.curvature[:, 0]
    for wanted, tolerance in ((0.002, 0.005), (0.006, 0.1)):
        moved = replace(cloth, positions=bent(cloth.uv))
        grid = cloth_mesh(moved, moved.positions)
        result = adapt(grid, np.tile(np.eye(3) / wanted**2, (len(grid.rest), 1, 1)))
        cloth = carried_over(moved, result.mesh, result.transfer)
        assert cloth.creases is not None and len(cloth.creases.worked) == len(cloth.faces)
        assert cloth.rest_area @ cloth.creases.curvature[:, 0] == pytest.approx(before, rel=tolerance)


def test_other_fabrics_keep_no_creases() -> None:
    cloth = sheet(replace(SLACK, bending_bias=1e-6))
    assert cloth.creases is None
    assert cloth_stepper(cloth, None, options(), StageClock()).force(CreasingBending) is None
