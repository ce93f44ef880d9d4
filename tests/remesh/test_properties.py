"""Random cloth under random metrics and refusals, several passes in a row, stays what it was.

Every case is a seed, so that a failure is repeated by `check_passes(kind, seed)`.
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import fields

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from tests.remesh.random_cloth import (
    SURFACES,
    Random,
    field,
    marked,
    panel,
    refusals,
    renumbered,
    sewn,
    tangled,
    tube,
)
from tests.remesh.validity import check_arrays, check_change, check_momentum, check_surface, sides_of
from toile.geometry.arrays import Float
from toile.remesh.adapt.adapt import AdaptResult, adapt
from toile.remesh.mesh.cloth_mesh import ClothMesh

PASSES = 3
SEEDS = st.integers(0, 2**32 - 1)
COMMON = settings(
    derandomize=True,
    database=None,
    deadline=None,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=[HealthCheck.too_slow],
)
"""The same cases on every machine; nothing is shrunk, since a smaller seed is no simpler."""
QUICK = settings(COMMON, max_examples=15)
THOROUGH = settings(COMMON, max_examples=200)


def check_passes(kind: str, seed: int) -> Counter[str]:
    """Adapt random cloth again and again and check it each time; returns how often what was done."""
    random, done = np.random.default_rng(seed), Counter[str]()
    mesh = {**SURFACES, "tangled": tangled}[kind](random)
    mesh = renumbered(random, marked(random, mesh))
    spacing = float(np.sqrt(2.0 * mesh.rest_area.mean()))
    whole = np.bincount(mesh.region, weights=mesh.rest_area)
    for _ in range(PASSES):
        tensors = field(random, mesh, spacing)
        result = adapt(mesh, tensors, refusals(random))
        if kind == "tangled":
            check_arrays(result.mesh)
        else:
            check_surface(result.mesh)
        check_change(mesh, result)
        check_momentum(mesh, result, random.normal(size=mesh.positions.shape))
        if kind != "tangled" and not len(mesh.frozen_edges):
            check_fits(result, tensors)
        done.update(splits=result.splits, flips=result.flips, collapses=result.collapses)
        mesh = result.mesh
    assert np.abs(np.bincount(mesh.region, weights=mesh.rest_area) / whole - 1.0).max() < 1e-12
    return done


def check_fits(result: AdaptResult, tensors: Float) -> None:
    """No edge is longer than 1 on any side; the same metrics split nothing more."""
    mesh, carried = result.mesh, result.transfer.at_vertices(tensors)
    p, q = sides_of(mesh).ends.T
    along = mesh.rest[q] - mesh.rest[p]
    squared = np.einsum("ki,kij,kj->k", along, 0.5 * (carried[p] + carried[q]), along)
    assert squared.max() <= 1.0 + 1e-9
    assert adapt(mesh, carried).splits == 0


def run_cases(kind: str, profile: settings) -> Counter[str]:
    total = Counter[str]()

    @profile
    @given(seed=SEEDS)
    def every_case(seed: int) -> None:
        total.update(check_passes(kind, seed))

    every_case()
    return total


@pytest.mark.parametrize("kind", [*SURFACES, "tangled"])
def test_random_passes_keep_surface_shape_lines_marks_and_momentum(kind: str) -> None:
    total = run_cases(kind, QUICK)
    assert min(total["splits"], total["flips"], total["collapses"]) > 100, total


@pytest.mark.slow
@pytest.mark.parametrize("kind", [*SURFACES, "tangled"])
def test_many_random_passes_keep_surface_shape_lines_marks_and_momentum(kind: str) -> None:
    total = run_cases(kind, THOROUGH)
    assert total.total() > 10_000, total


@settings(COMMON, max_examples=10)
@given(make=st.sampled_from([panel, sewn, tube]), seed=SEEDS)
def test_two_runs_give_the_same_bytes(make: Callable[[Random], ClothMesh], seed: int) -> None:
    def run() -> AdaptResult:
        random = np.random.default_rng(seed)
        mesh = renumbered(random, marked(random, make(random)))
        return adapt(mesh, field(random, mesh, 1.0), refusals(random))

    one, two = run(), run()
    for entry in fields(ClothMesh):
        assert getattr(one.mesh, entry.name).tobytes() == getattr(two.mesh, entry.name).tobytes()
    for name in ("nodes", "vertices"):
        first, second = getattr(one.transfer, name), getattr(two.transfer, name)
        assert first.data.tobytes() == second.data.tobytes()
        assert first.indices.tobytes() == second.indices.tobytes()
    assert one[2:] == two[2:]


@settings(COMMON, max_examples=20)
@given(make=st.sampled_from(list(SURFACES.values())), seed=SEEDS)
def test_metrics_beside_a_flat_panel_and_the_place_in_space_change_nothing(
    make: Callable[[Random], ClothMesh], seed: int
) -> None:
    """What is done depends on lengths in rest space only."""
    random = np.random.default_rng(seed)
    mesh = make(random)
    tensors = field(random, mesh, 1.0)
    expected = adapt(mesh, tensors)
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    moved = ClothMesh(**{**vars(mesh), "positions": 3.0 * mesh.positions @ turn})
    if not mesh.rest[:, 2].any():
        tensors = tensors + random.normal(size=(len(tensors), 1, 1)) * np.diag([0.0, 0.0, 1.0])
    assert adapt(moved, tensors).mesh.faces.tobytes() == expected.mesh.faces.tobytes()
