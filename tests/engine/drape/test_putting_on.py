"""While a garment is put on cloth falls before limbs come back, and late stitches take none between them."""

from dataclasses import replace

import numpy as np

from tests.engine.drape.test_growing import KNIT
from tests.engine.drape.test_unpicking import stacked
from tests.engine.step.test_only_what_is_asked import options, sheet
from toile.engine.cloth.cloth import Cloth
from toile.engine.drape.drape import Drape
from toile.engine.drape.merging import merge
from toile.engine.drape.plan import DrapePlan
from toile.engine.drape.settling import ease
from toile.studies.scenes.flat_meshes import mesh


def begun(cloth: Cloth, **plan: float) -> Drape:
    whole = DrapePlan(step=options(self_contact=True), max_steps=400)
    return Drape(cloth, None, [], replace(whole, **plan), lambda frame: True)  # type: ignore[arg-type]


def test_late_stitches_stay_open_where_merging_would_cross_cloth() -> None:
    cloth = stacked(between=True)
    cloth = replace(cloth, positions=cloth.positions * [1.0, 1.0, 0.05])
    clean, forced = begun(cloth), begun(cloth)
    for run in (clean, forced):
        assert (run.gaps() < run.plan.merge_gap).all()
    merge(clean, clean=True)
    assert len(clean.cloth.stitches) == len(cloth.stitches) and not clean.ghost.any()
    assert not len(clean.audit().cloth)
    merge(forced)
    assert not len(forced.cloth.stitches) and forced.ghost.any()
    apart = stacked(between=False)
    free = begun(replace(apart, positions=apart.positions * [1.0, 1.0, 0.05]))
    merge(free, clean=True)
    assert not len(free.cloth.stitches)


def hanging() -> Cloth:
    """A level sheet, 60 cm long, pinned along an edge."""
    points, faces = mesh("right", 0.6, 0.2, 0.04)
    positions = np.column_stack((points[:, 0], np.zeros(len(points)), -points[:, 1]))
    return replace(
        sheet(KNIT), positions=positions, velocities=np.zeros_like(positions),
        node=np.arange(len(points), dtype=np.int32), faces=faces.astype(np.int32),
        rest_corners=np.ascontiguousarray(points[faces]), fabric=np.zeros(len(faces), np.int32),
        garment=np.zeros(len(faces), np.int32), panel=np.zeros(len(faces), np.int32), uv=points,
        pinned=points[:, 0] < 1e-9, rest_curved=np.zeros(len(faces), bool), start_positions=positions,
    )  # fmt: skip


def test_cloth_falls_on_before_limbs_come_back() -> None:
    short, whole = begun(hanging()), begun(hanging())
    ease(short)
    assert short.record.steps == short.plan.easing_steps
    ease(whole, whole.plan.falling_steps)
    assert short.record.steps < whole.record.steps < short.plan.easing_steps + whole.plan.falling_steps
    lowest = [float(run.stepper.x[:, 1].min()) for run in (short, whole)]
    assert lowest[1] < 1.5 * lowest[0] < -0.3, "it had not come far"
