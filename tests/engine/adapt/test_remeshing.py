"""Cloth on a new mesh: what belongs to it follows, nothing crosses, energy does not jump."""

from dataclasses import replace

import numpy as np
import pytest

from toile.collide.audit import Auditor
from toile.collide.avatar_surface import AvatarSurface
from toile.engine.adapt.remeshing import Remeshed, remesh_run, remeshed
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.forces.contact import ContactLaw
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.cloth_forces import cloth_stepper
from toile.engine.step.cloth_run import ClothRun
from toile.engine.step.options import StepOptions
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.stage_clock import StageClock
from toile.remesh.sizing.sizing import SizingOptions
from toile.studies.scenes.flat_meshes import mesh

POPLIN = Fabric(
    name="poplin", areal_density=0.12, thickness=3e-4, bending_warp=8e-6, bending_weft=6e-6,
    bending_bias=5e-6, stretch_warp=3000.0, stretch_weft=2500.0, shear=90.0,
)  # fmt: skip
LAW = ContactLaw(stiffness=2e6, edge_share=1.0)
OPTIONS = StepOptions(
    gravity=9.81, radius_body=0.002, radius_self=0.001, law_body=LAW, law_self=LAW, growth_radius=0.006,
    slip=1e-3, self_contact=True,
)  # fmt: skip
FINE = SizingOptions(size_min=0.01, size_max=0.2, refine_angle=0.3)


def cloth_at(points: Float, faces: Int, positions: Float, pinned: Bool | None = None) -> Cloth:
    """A flat piece of poplin at some positions."""
    count, none = len(points), np.empty(0, np.int32)
    zeros = np.zeros(len(faces), np.int32)
    return Cloth(
        positions=positions, velocities=np.zeros((count, 3)), node=np.arange(count, dtype=np.int32),
        faces=np.asarray(faces, np.int32), rest_corners=points[faces], fabrics=(POPLIN,), fabric=zeros,
        garment=zeros, panel=zeros, uv=points, stitches=np.empty((0, 2), np.int32), seam=none,
        stitch_length=np.empty(0), held=none, waist=none,
        pinned=np.zeros(count, bool) if pinned is None else pinned,
        rest_curved=np.zeros(len(faces), bool),
        start_positions=np.column_stack([points, np.zeros(count)]),
    )  # fmt: skip


def stepper_of(cloth: Cloth, avatar: AvatarSurface | None = None) -> ClothStepper:
    return cloth_stepper(cloth, avatar, OPTIONS, StageClock())


def rolled(points: Float, radius: float) -> Float:
    """The strip bent round a cylinder over its middle third, flat on both sides."""
    u, v = points.T
    length = u.max()
    angle = np.clip(u - length / 3, 0.0, length / 3) / radius
    rest = np.maximum(u - 2 * length / 3, 0.0)
    x = np.minimum(u, length / 3) + radius * np.sin(angle) + rest * np.cos(angle)
    z = radius * (1.0 - np.cos(angle)) + rest * np.sin(angle)
    return np.column_stack([x, v, z])


@pytest.fixture(params=["right", "random"])
def bent(request: pytest.FixtureRequest) -> Cloth:
    points, faces = mesh(request.param, 0.6, 0.3, 0.04)
    return cloth_at(points, faces, rolled(points, 0.08), points[:, 0] < 1e-9)


def adapted(cloth: Cloth, options: SizingOptions = FINE) -> Remeshed:
    found = remeshed(cloth, stepper_of(cloth), options)
    assert found is not None
    return found


def test_fine_where_it_bends_and_coarse_where_it_is_flat(bent: Cloth) -> None:
    after = adapted(bent).cloth
    middle = after.rest_corners.mean(axis=1)
    place = after.start_positions[after.faces].mean(axis=1)[:, 0]
    area = after.rest_area
    assert middle.shape == (len(area), 2)
    inside, outside = (place > 0.25) & (place < 0.35), (place < 0.12) | (place > 0.48)
    assert np.median(area[inside]) < 0.4 * np.median(area[outside])


def test_a_start_out_of_shape_leaves_the_rest_shape_alone(bent: Cloth) -> None:
    torn = replace(bent, start_positions=bent.start_positions * np.array([5.0, 1.0, 1.0]))
    after = adapted(torn).cloth
    assert after.rest_area.sum() == pytest.approx(bent.rest_area.sum(), rel=1e-12)
    assert np.array_equal(after.rest_corners, adapted(bent).cloth.rest_corners)
    assert after.start_positions[:, 0] == pytest.approx(5.0 * after.uv[:, 0], abs=1e-12)


def test_mass_area_pattern_and_marks_follow(bent: Cloth) -> None:
    held = np.flatnonzero(bent.uv[:, 1] < 1e-9).astype(np.int32)
    after = adapted(replace(bent, held=held)).cloth
    assert after.rest_area.min() > 0.0
    assert after.rest_area.sum() == pytest.approx(bent.rest_area.sum(), rel=1e-12)
    assert after.mass.sum() == pytest.approx(bent.mass.sum(), rel=1e-12)
    assert after.uv == pytest.approx(after.start_positions[:, :2], abs=1e-13)
    assert after.rest_corners - after.rest_corners[:, :1] == pytest.approx(
        after.uv[after.faces] - after.uv[after.faces[:, :1]], abs=1e-12
    )
    edge = after.uv[:, 0] < 1e-9
    assert (after.pinned[after.node] == edge).all()
    assert set(after.held) == set(after.node[after.uv[:, 1] < 1e-9])
    assert after.positions[after.node[edge]][:, 0] == pytest.approx(0.0, abs=1e-12)


def test_momentum_of_moving_cloth_is_kept() -> None:
    points, faces = mesh("random", 0.5, 0.4, 0.05)
    cloth = cloth_at(points, faces, rolled(points, 0.1))
    moving = np.random.default_rng(2).normal(size=cloth.positions.shape)
    cloth = replace(cloth, velocities=np.cross([1.0, 3.0, -2.0], cloth.positions) + 0.3 * moving)
    after = adapted(cloth).cloth

    def momenta(c: Cloth) -> tuple[Float, Float]:
        momentum = c.mass[:, None] * c.velocities
        return momentum.sum(axis=0), np.cross(c.positions, momentum).sum(axis=0)

    for before_sum, after_sum in zip(momenta(cloth), momenta(after), strict=True):
        assert after_sum == pytest.approx(before_sum, rel=1e-10, abs=1e-14)


def test_energy_of_stretch_does_not_jump(bent: Cloth) -> None:
    stepper = stepper_of(bent)
    for _ in range(20):
        stepper.step(StepRequest(h=0.1, at_rest=True))
    found = remeshed(bent, stepper, FINE)
    assert found is not None and found.splits and found.flips
    after = stepper_of(found.cloth)
    before, membrane = stepper.force(Membrane), after.force(Membrane)
    assert before is not None and membrane is not None
    most = before.energy(stepper.x) + 0.0025 * stepper.elastic_energy()
    assert membrane.energy(after.x) < most


AT_REST = StepRequest(h=0.25, at_rest=True)


def settle(run: ClothRun, most: int) -> None:
    for _ in range(most):
        if run.stepper.step(AT_REST).moved.max() < 1e-6:
            break


@pytest.mark.parametrize("kind", ["right", "random"])
def test_cloth_at_rest_does_not_pop(kind: str) -> None:
    """On a mesh that fits it: one of 4 cm triangles hangs otherwise than one of 1 cm, by centimetres."""
    points, faces = mesh(kind, 0.6, 0.3, 0.04)
    run = ClothRun(
        cloth_at(points, faces, rolled(points, 0.15), points[:, 0] < 1e-9), None, OPTIONS, StageClock()
    )
    for _ in range(3):
        settle(run, 200)
        remesh_run(run, FINE, AT_REST, step=0)
    settle(run, 200)
    done = remesh_run(run, replace(FINE, refine_angle=0.8 * FINE.refine_angle), AT_REST, step=0)
    assert done is not None and done.splits > 20
    outcome = run.stepper.step(AT_REST)
    assert outcome.moved.max() < 0.1 * FINE.size_min


def test_remeshing_cloth_in_motion_adds_no_energy_and_keeps_momentum() -> None:
    points, faces = mesh("random", 0.5, 0.4, 0.05)
    bent = cloth_at(points, faces, rolled(points, 0.1))
    for shape in (points, rolled(points, 0.1)):
        still = shape if shape.shape[1] == 3 else np.column_stack([shape, np.zeros(len(shape))])
        # a turn, and a swing that no rigid motion contains
        swing = np.cross([1.0, 3.0, -2.0], still) + np.outer(np.cos(10.0 * still[:, 0]), [0.0, 0.0, 2.0])
        run = ClothRun(replace(bent, positions=still, velocities=swing), None, OPTIONS, StageClock())
        before = run.stepper.x.copy(), run.stepper.mass[:, None] * run.stepper.v
        kinetic = np.sum(before[1] * run.stepper.v)
        done = remesh_run(run, FINE, StepRequest(h=0.25, at_rest=True, gravity=0.0), step=0, keep_energy=True)
        assert done is not None
        assert done.energy_jump < 0.005
        after = run.stepper.x, run.stepper.mass[:, None] * run.stepper.v
        assert after[1].sum(axis=0) == pytest.approx(before[1].sum(axis=0), rel=1e-10, abs=1e-14)
        turning = (np.cross(x, p).sum(axis=0) for x, p in (before, after))
        assert next(turning) == pytest.approx(next(turning), rel=1e-10, abs=1e-14)
        assert np.sum(after[1] * run.stepper.v) == pytest.approx(kinetic, rel=0.05)


def test_a_pass_whose_energy_cannot_be_given_back_is_undone() -> None:
    """In steps of a microsecond nothing moves."""
    points, faces = mesh("right", 0.5, 0.4, 0.05)
    cloth = cloth_at(points, faces, rolled(points, 0.1))
    run = ClothRun(cloth, None, OPTIONS, StageClock())
    stepper, x, before = run.stepper, run.stepper.x.copy(), run.stepper.elastic_energy()
    hardly = StepRequest(h=1e-6, at_rest=True, gravity=0.0)
    assert remesh_run(run, FINE, hardly, step=0, keep_energy=True) is None
    assert run.cloth is cloth and run.stepper is stepper
    assert np.array_equal(stepper.x, x) and stepper.elastic_energy() == before
    assert remesh_run(run, FINE, replace(hardly, h=0.25), step=0, keep_energy=True) is not None


def test_flat_cloth_comes_back_to_few_triangles(bent: Cloth) -> None:
    fine = adapted(bent).cloth
    flat = replace(fine, positions=np.ascontiguousarray(fine.start_positions[np.argsort(fine.node)]))
    assert np.array_equal(np.sort(fine.node), np.arange(len(fine.node)))
    coarse = adapted(flat).cloth
    assert len(coarse.faces) < 0.35 * len(fine.faces)
    assert coarse.rest_area.sum() == pytest.approx(bent.rest_area.sum(), rel=1e-12)


def test_a_mesh_that_fits_stays(bent: Cloth) -> None:
    cloth = bent
    for _ in range(7):
        found = remeshed(cloth, stepper_of(cloth), FINE)
        if found is not None:
            cloth = found.cloth
    assert remeshed(cloth, stepper_of(cloth), FINE) is None


def test_nothing_crosses_the_ball_or_the_cloth_afterwards() -> None:
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.1)
    body = AvatarSurface(np.ascontiguousarray(ball.vertices), np.ascontiguousarray(ball.faces, np.int32))
    points, faces = mesh("right", 0.5, 0.5, 0.035)
    start = np.column_stack([points[:, 0] - 0.25, np.full(len(points), 0.105), points[:, 1] - 0.25])
    faces = np.ascontiguousarray(faces[:, ::-1])
    cloth = replace(
        cloth_at(points[:, ::-1].copy(), faces, start),
        start_positions=np.column_stack([points[:, ::-1], np.zeros(len(points))]),
    )
    stepper = stepper_of(cloth, body)
    meshed = 0
    for step in range(60):
        stepper.step(StepRequest(h=0.05, at_rest=True))
        if step % 10 == 9:
            found = remeshed(cloth, stepper, replace(FINE, size_min=0.012))
            if found is not None:
                meshed += 1
                cloth = found.cloth
                stepper = stepper_of(cloth, body)
                assert stepper.collisions is not None
                stepper.collisions.anchor[: len(stepper.x)] = found.anchors
            crossings = Auditor(body.vertices, body.faces).audit(stepper.x, cloth.face_nodes, cloth.weld)
            assert len(crossings.avatar) == 0 and len(crossings.cloth) == 0
    assert meshed > 2
    assert stepper.x[:, 1].min() < -0.05


def test_same_mesh_from_the_same_cloth(bent: Cloth) -> None:
    one, two = adapted(bent), adapted(bent)
    assert one.cloth.positions.tobytes() == two.cloth.positions.tobytes()
    assert one.cloth.faces.tobytes() == two.cloth.faces.tobytes()
