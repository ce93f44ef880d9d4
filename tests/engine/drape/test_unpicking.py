"""A seam that could close only through other cloth stays open; nothing crosses in the end."""

from dataclasses import replace

import numpy as np

from tests.engine.drape.test_growing import KNIT
from tests.engine.step.test_only_what_is_asked import options, sheet
from toile.engine.cloth.cloth import Cloth
from toile.engine.drape.drape import Drape
from toile.engine.drape.plan import DrapePlan, Frame
from toile.studies.scenes.flat_meshes import mesh


def stacked(between: bool) -> Cloth:
    """Two sheets 6 cm apart, to be sewn along one edge, and a large pinned sheet between them or aside."""
    small, small_faces = mesh("right", 0.2, 0.2, 0.02)
    large, large_faces = mesh("right", 0.6, 0.6, 0.05)
    large = large - 0.2
    large[:, 0] += 0.0 if between else 1.0
    count = len(small)
    uv = np.concatenate([small, small, large])
    z = np.repeat([0.03, -0.03, 0.0], [count, count, len(large)])
    faces = np.concatenate([small_faces, small_faces + count, large_faces + 2 * count]).astype(np.int32)
    edge = np.flatnonzero(small[:, 0] < 1e-9)
    edge = edge[np.argsort(small[edge, 1])]
    positions = np.column_stack((uv, z))
    plain = replace(KNIT, bending_warp=1e-5, bending_weft=1e-5, bending_bias=1e-5)
    return replace(
        sheet(plain), positions=positions, velocities=np.zeros_like(positions),
        node=np.arange(len(uv), dtype=np.int32), faces=faces, rest_corners=np.ascontiguousarray(uv[faces]),
        fabric=np.zeros(len(faces), np.int32), garment=np.zeros(len(faces), np.int32),
        panel=np.zeros(len(faces), np.int32), uv=uv,
        stitches=np.column_stack((edge, edge + count)).astype(np.int32), seam=np.zeros(len(edge), np.int32),
        stitch_length=np.full(len(edge), 0.06), pinned=np.arange(len(uv)) >= 2 * count,
        rest_curved=np.zeros(len(faces), bool), start_positions=positions,
    )  # fmt: skip


def sewn(cloth: Cloth, persistent: bool = True) -> tuple[Drape, list[Frame]]:
    frames: list[Frame] = []

    def on_frame(frame: Frame) -> bool:
        frames.append(frame)
        return True

    plan = DrapePlan(
        step=replace(options(self_contact=True), gravity=0.0), max_steps=400, persistent=persistent
    )
    run = Drape(cloth, None, [], plan, on_frame)
    run.run()
    return run, frames


def test_seam_with_cloth_between_is_opened_again() -> None:
    cloth = stacked(between=True)
    run, frames = sewn(cloth)
    assert any(len(frame.crossings.cloth) for frame in frames), "the seam was never forced"
    assert run.record.settled_crossings and not np.any(run.record.settled_crossings)
    assert len(run.cloth.stitches) == len(cloth.stitches)
    assert np.abs(run.cloth.positions - cloth.positions)[cloth.pinned].max() < 1e-12


def test_a_drape_that_may_start_again_gives_up_where_the_seam_jams() -> None:
    run, _ = sewn(stacked(between=True), persistent=False)
    assert run.record.gave_up and run.phase == "sewing" and not run.record.converged
    patient, _ = sewn(stacked(between=True))
    assert not patient.record.gave_up
    assert run.record.steps < patient.record.steps


def test_the_same_seam_closes_where_nothing_is_between() -> None:
    run, frames = sewn(stacked(between=False))
    assert not len(run.cloth.stitches)
    assert not any(len(frame.crossings.cloth) for frame in frames)
