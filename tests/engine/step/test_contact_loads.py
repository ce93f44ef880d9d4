"""Pressure of an elastic band is that of Laplace; what lies on a body is borne by it."""

import numpy as np
import pytest
import trimesh

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.drape.drape import Drape
from toile.engine.drape.plan import DrapePlan
from toile.engine.step.contact_loads import contact_loads
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float, Int
from toile.geometry.normals import area_normals
from toile.remesh.panel.rectangle import rectangle

GAP, HEIGHT = 0.002, 0.4
STRETCH = 100.0
BAND = Fabric(
    name="band", areal_density=0.1, thickness=3e-4, bending_warp=1e-7, bending_weft=1e-7, bending_bias=1e-7,
    stretch_warp=STRETCH, stretch_weft=STRETCH, shear=20.0, compression=1.0,
)  # fmt: skip


def frustum(low: float, high: float, sections: int = 96, rows: int = 40) -> tuple[Float, Int]:
    """A closed cone about y of radii `low` at its foot and `high` at its top."""
    angle = 2.0 * np.pi * np.arange(sections) / sections
    rings = [
        np.column_stack((r * np.cos(angle), np.full(sections, y), -r * np.sin(angle)))
        for r, y in zip(np.linspace(low, high, rows + 1), np.linspace(0.0, HEIGHT, rows + 1), strict=True)
    ]
    faces = []
    for k in range(rows):
        for i in range(sections):
            a, b = k * sections + i, k * sections + (i + 1) % sections
            faces += [[a, b, b + sections], [a, b + sections, a + sections]]
    foot, top = sections * (rows + 1), sections * (rows + 1) + 1
    for i in range(sections):
        j = (i + 1) % sections
        faces += [[foot, j, i], [top, rows * sections + i, rows * sections + j]]
    vertices = np.concatenate([*rings, [[0.0, 0.0, 0.0], [0.0, HEIGHT, 0.0]]])
    return vertices, np.array(faces, np.int32)


def band(edge: float, strain: float, low: float, high: float) -> Cloth:
    """A band around the middle of that cone, shorter by `strain` around it than it is; warp goes around."""
    slope = (high - low) / HEIGHT
    tilt = float(np.hypot(1.0, slope))
    ys = np.linspace(0.15, 0.25, max(2, round(0.1 * tilt / edge / 0.866)) + 1)
    around = max(8, round(2.0 * np.pi * (0.5 * (low + high) + GAP) / edge))

    def radius(y: Float) -> Float:
        return np.asarray(low + slope * y + GAP * tilt)

    rows, turns = np.divmod(np.arange(len(ys) * around), around)
    angle = 2.0 * np.pi * (turns + 0.5 * (rows % 2)) / around
    r = radius(ys[rows])
    positions = np.column_stack((r * np.cos(angle), ys[rows], -r * np.sin(angle)))
    corners, faces = [], []
    for k in range(len(ys) - 1):
        for i in range(around):
            here, up = [(k, i), (k, i + 1)], [(k + 1, i), (k + 1, i + 1)]
            pair = (
                [[*here, up[0]], [here[1], up[1], up[0]]]
                if k % 2 == 0
                else [[*here, up[1]], [here[0], up[1], up[0]]]
            )
            for face in pair:
                row, turn = np.array(face).T
                at = 2.0 * np.pi * (turn + 0.5 * (row % 2)) / around
                u = at * radius(ys[row].mean()) / (1.0 + strain)
                corners.append(np.column_stack((u, tilt * ys[row])))
                faces.append(row * around + turn % around)
    triangles = np.array(faces, np.int32)
    zero, none = np.zeros(len(triangles), np.int32), np.empty(0, np.int32)
    return Cloth(
        positions=positions, velocities=np.zeros_like(positions),
        node=np.arange(len(positions), dtype=np.int32), faces=triangles, rest_corners=np.array(corners),
        fabrics=(BAND,), fabric=zero, garment=zero, panel=zero, uv=np.zeros((len(positions), 2)),
        stitches=np.empty((0, 2), np.int32), seam=none, stitch_length=np.empty(0), held=none, waist=none,
        pinned=np.zeros(len(positions), bool), rest_curved=np.zeros(len(triangles), bool),
        start_positions=positions.copy(),
    )  # fmt: skip


@pytest.mark.parametrize("edge", [0.016, 0.012, 0.008])
@pytest.mark.parametrize(("low", "high"), [(0.1, 0.1), (0.12, 0.08)], ids=["cylinder", "cone"])
def test_pressure_of_an_elastic_band_is_tension_over_radius(low: float, high: float, edge: float) -> None:
    body, cloth = frustum(low, high), band(edge, 0.1, low, high)
    plan = DrapePlan(
        step=StepOptions(gravity=0.0, self_contact=False), max_steps=400, rms_motion=1e-6, peak_motion=1e-5,
        cg_tolerance=1e-4,
    )  # fmt: skip
    run = Drape(cloth, body, [], plan, lambda _: True)
    run.hang()
    loads = contact_loads(run.cloth, body, plan.step, run.anchors())
    x, faces = run.cloth.positions, cloth.face_nodes
    area = 0.5 * np.linalg.norm(area_normals(x[faces]), axis=1)
    node_area = np.bincount(faces.ravel(), np.repeat(area / 3.0, 3), len(x))
    inner = (x[:, 1] > 0.165) & (x[:, 1] < 0.235)
    pressure = loads.press_nodes[inner].sum() / node_area[inner].sum()
    # The curvature across the warp of a cone is cos(its half angle) over its radius.
    radius = float(np.hypot(x[inner, 0], x[inner, 2]).mean()) * np.hypot(1.0, (high - low) / HEIGHT)
    assert pressure == pytest.approx(0.1 * STRETCH / radius, rel=0.03)
    assert np.abs(loads.on_nodes.sum(axis=0) + loads.on_avatar.sum(axis=0)).max() < 1e-9


def test_the_body_bears_the_weight_of_a_cloth_that_lies_on_it() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.12)
    body = np.ascontiguousarray(ball.vertices), np.ascontiguousarray(ball.faces, np.int32)
    flat, faces = rectangle(0.3, 0.3, 0.02)
    start = np.column_stack((flat[:, 0] - 0.15, np.full(len(flat), 0.125), 0.15 - flat[:, 1]))
    poplin = Fabric(
        name="poplin", areal_density=0.104, thickness=1.8e-4, bending_warp=9.6e-6, bending_weft=7e-6,
        bending_bias=7.9e-6, stretch_warp=2800.0, stretch_weft=4501.0, shear=120.0,
    )  # fmt: skip
    cloth = flat_cloth(flat, faces, start, poplin)
    plan = DrapePlan(step=StepOptions(), max_steps=600, rms_motion=2e-5, peak_motion=2e-4)
    run = Drape(cloth, body, [], plan, lambda _: True)
    run.hang()
    loads = contact_loads(run.cloth, body, plan.step, run.anchors())
    weight = float(cloth.mass.sum()) * 9.81
    assert -loads.on_avatar[:, 1].sum() == pytest.approx(weight, rel=0.01)
    assert np.abs(loads.on_avatar[:, [0, 2]].sum(axis=0)).max() < 0.01 * weight
    # Without friction the same contacts press on it, but do not hold it.
    assert contact_loads(run.cloth, body, plan.step).press_avatar == pytest.approx(loads.press_avatar)
