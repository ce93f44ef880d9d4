"""Hanging cloth remeshed at rest: a pass after which a node would visibly move is undone."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.adapt.test_remeshing import FINE, OPTIONS, cloth_at
from toile.engine.drape import state as drape_state
from toile.engine.drape.drape import Drape
from toile.engine.drape.plan import DrapePlan
from toile.engine.drape.state import DrapeState
from toile.studies.scenes.flat_meshes import mesh


def hung() -> Drape:
    """A strip of coarse triangles after it has come to rest, its ends held at two thirds of its length."""
    points, faces = mesh("random", 0.6, 0.3, 0.04)
    u, v = points.T
    roof = 0.2 * np.sqrt(5.0) * np.abs(1.0 - u / 0.3)
    ends = (u < 1e-9) | (u > 0.6 - 1e-9)
    cloth = cloth_at(points, faces, np.column_stack([2.0 / 3.0 * u, roof, v]), ends)
    plan = DrapePlan(step=OPTIONS, max_steps=600, sizing=replace(FINE, refine_angle=0.2))
    drape = Drape(cloth, None, [], plan, lambda frame: True)
    drape.hang()
    return drape


def test_no_node_moves_far_after_a_pass_that_is_kept() -> None:
    drape = hung()
    record = drape.record
    assert record.converged and record.remeshings
    assert record.pop <= 0.1 * FINE.size_min
    assert len(drape.cloth.faces) == record.remeshings[-1].faces
    assert len(drape.cloth.positions) == record.node_counts[-1]
    assert max(map(sum, record.crossings)) == 0


def test_a_pass_that_pops_is_undone_once_the_mesh_is_fitted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no motion at all is allowed, the first at rest is kept and no other; the drape ends at rest."""
    monkeypatch.setattr(drape_state, "POP", -1.0)
    monkeypatch.setattr(drape_state, "MOVED", 1e9)
    monkeypatch.setattr(drape_state, "MOVED_AT_END", -1.0)
    kept: list[bool] = []
    keep_mesh = DrapeState.keep_mesh

    def noted(drape: DrapeState, pop: float) -> bool:
        fresh = drape._before is not None
        keeps = keep_mesh(drape, pop)
        if fresh:
            kept.append(keeps)
        return keeps

    monkeypatch.setattr(DrapeState, "keep_mesh", noted)
    drape = hung()
    record = drape.record
    assert kept == [True, False]
    assert record.converged and len(record.remeshings) == 1 and record.pop == 0.0
    assert len(drape.cloth.faces) == record.remeshings[0].faces != record.first_faces
    assert len(record.node_counts) == 2 and record.node_counts[-1] == len(drape.cloth.positions)
    assert drape.stepper.x.shape == drape.cloth.positions.shape
