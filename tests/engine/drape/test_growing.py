"""A body that grows into tight cloth gets its shape, and crosses nothing on the way."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from tests.engine.step.test_only_what_is_asked import options
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.drape.drape import Drape
from toile.engine.drape.plan import DrapePlan, Frame, Growth
from toile.geometry.arrays import Float, Int

KNIT = Fabric(
    name="knit", areal_density=0.2, thickness=5e-4, bending_warp=1e-6, bending_weft=1e-6, bending_bias=1e-6,
    stretch_warp=300.0, stretch_weft=300.0, shear=50.0,
)  # fmt: skip


def limb(radius: float) -> tuple[Float, Int]:
    """An upright cylinder, 0.4 m long, of 1 cm triangles."""
    solid = trimesh.creation.cylinder(radius=1.0, height=0.4, sections=40).subdivide_to_size(0.16)
    vertices = np.asarray(solid.vertices)[:, [0, 2, 1]] * (radius, 1.0, radius)
    return np.ascontiguousarray(vertices), np.ascontiguousarray(solid.faces[:, ::-1], np.int32)


def sleeve(radius: float) -> Cloth:
    """A closed tube of cloth, 0.2 m long, of 1 cm triangles."""
    around, rows, size = 48, 20, 0.01
    row, column = (k.ravel() for k in np.meshgrid(np.arange(rows), np.arange(around), indexing="ij"))
    squares = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)]
    corners = np.stack([np.stack(square, axis=1) for square in squares], axis=1)
    corners = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
    faces = np.asarray(corners[..., 0] * around + corners[..., 1] % around, np.int32)
    rest = np.stack((corners[..., 1] * 2 * np.pi * radius / around, corners[..., 0] * size), axis=-1)
    k = np.arange((rows + 1) * around)
    angle = 2 * np.pi * (k % around) / around
    positions = np.column_stack(
        (radius * np.cos(angle), (k // around - 0.5 * rows) * size, radius * np.sin(angle))
    )
    return Cloth(
        positions=positions, velocities=np.zeros_like(positions), node=k.astype(np.int32), faces=faces,
        rest_corners=np.ascontiguousarray(rest), fabrics=(KNIT,), fabric=np.zeros(len(faces), np.int32),
        garment=np.zeros(len(faces), np.int32), panel=np.zeros(len(faces), np.int32),
        uv=positions[:, :2].copy(), stitches=np.empty((0, 2), np.int32), seam=np.empty(0, np.int32),
        stitch_length=np.empty(0), held=np.empty(0, np.int32), waist=np.empty(0, np.int32),
        pinned=np.zeros(len(k), bool), rest_curved=np.zeros(len(faces), bool), start_positions=positions,
    )  # fmt: skip


@pytest.mark.parametrize("radius", [0.05, 0.06])
def test_tight_cloth_does_not_keep_the_body_from_its_shape(radius: float) -> None:
    """Cloth of 0.045 m radius around a limb that grows from 0.04 m: strained by 11 and by 33 %."""
    start, faces = limb(0.04)
    goal, _ = limb(radius)
    crossings = []

    def on_frame(frame: Frame) -> bool:
        crossings.append(len(frame.crossings.avatar) + len(frame.crossings.cloth))
        return True

    plan = DrapePlan(step=replace(options(self_contact=True), gravity=0.0), max_steps=150)
    growth = [Growth(vertices=goal, per_step=0.005)]
    run = Drape(sleeve(0.045), (start, faces), growth, plan, on_frame)
    record = run.run()
    assert run.surface is not None and np.array_equal(run.surface.vertices, goal)
    assert record.settled_crossings and not any(crossings)
    around = run.warp_weft_strain()[:, 0]
    assert np.median(around) == pytest.approx((radius + 0.002) / 0.045 - 1.0, abs=0.01)
