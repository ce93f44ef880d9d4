"""Contact forces against their energy, and friction against the block on an incline."""

from dataclasses import replace

import numpy as np
import pytest

from tests.collide.surfaces import crumpled, sheet, stacked
from toile.collide.avatar_surface import AvatarSurface
from toile.collide.search import ContactSearch
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.forces.contact import ContactLaw, Contacts, Meeting, PairFriction, evaluate_contacts
from toile.engine.forces.friction import friction_after, friction_at_start, rubbed
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.cloth_forces import cloth_stepper
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float, Int
from toile.geometry.stage_clock import StageClock

RADIUS = 0.01
GRAVITY = 9.81
NONE = np.empty((0, 4), np.int32)


def law(edge_share: float = 1.0) -> ContactLaw:
    return ContactLaw(stiffness=1e6, edge_share=edge_share)


def rubbing(count: int, friction: float) -> PairFriction:
    return PairFriction(np.zeros(count, np.int32), np.full((1, 1), friction))


class Scene:
    """Two crumpled sheets of cloth close to each other and to an avatar sheet."""

    def __init__(self, seed: int) -> None:
        generator = np.random.default_rng(seed)
        self.x, faces = stacked([crumpled(generator, 4, 0.02, 0.3) for _ in range(2)])
        body, body_faces = crumpled(generator, 4, 0.03, 0.3)
        self.count = len(self.x)
        search = ContactSearch(
            faces, np.arange(self.count, dtype=np.int32), AvatarSurface(body, body_faces),
            self_contact=True, radius_self=RADIUS, radius_body=RADIUS,
        )  # fmt: skip
        search.search(self.x, np.full(self.count, 0.001))
        self.body, self.cloth, self.p = search.body, search.cloth, search.positions.copy()
        self.radius = generator.uniform(0.5, 1.0, size=len(self.p)) * RADIUS

    def evaluate(
        self, p: Float, start: Float, law_: ContactLaw, friction: float = 0.0, slip: float = 1e-3
    ) -> Contacts:
        area = np.full(len(p), 4e-4)
        contacts = evaluate_contacts(
            p, start, self.count, Meeting(self.body, self.radius, law_),
            Meeting(self.cloth, self.radius, law_), area, rubbing(len(p), friction),
        )  # fmt: skip
        return rubbed(contacts, friction_at_start(contacts, slip))


def forces_on_nodes(contacts: Contacts, count: int) -> Float:
    """Sum of contact forces per cloth node [N]."""
    total = np.zeros((count, 3))
    for corner in range(4):
        real = contacts.nodes[:, corner] >= 0
        push = contacts.weights[real, corner, None] * contacts.force[real]
        np.add.at(total, contacts.nodes[real, corner], push)
    return total


@pytest.mark.parametrize("edge_share", [1.0, 0.5])
@pytest.mark.parametrize("seed", range(3))
def test_force_is_the_derivative_of_the_energy(seed: int, edge_share: float) -> None:
    """Without friction and with equal areas (areas that differ change with the closest point)."""
    scene = Scene(seed)
    contacts = scene.evaluate(scene.p, scene.p, law(edge_share=edge_share))
    assert contacts.body > 10 and contacts.count - contacts.body > 10
    force = forces_on_nodes(contacts, scene.count)
    size = 1e-9
    for node in range(scene.count):
        for axis in range(3):
            there, back = scene.p.copy(), scene.p.copy()
            there[node, axis] += size
            back[node, axis] -= size
            change = (
                scene.evaluate(there, there, law(edge_share=edge_share)).energy
                - scene.evaluate(back, back, law(edge_share=edge_share)).energy
            )
            assert force[node, axis] == pytest.approx(-change / (2 * size), rel=1e-4, abs=1e-4)


@pytest.mark.parametrize("seed", range(3))
def test_cloth_on_cloth_forces_cancel(seed: int) -> None:
    """Action is reaction, friction included: momentum within the cloth is kept."""
    scene = Scene(seed)
    generator = np.random.default_rng(seed)
    start = scene.p - 1e-3 * generator.normal(size=scene.p.shape)
    scene.body = (NONE, NONE)
    contacts = scene.evaluate(scene.p, start, law(), 0.4)
    force = forces_on_nodes(contacts, scene.count)
    assert contacts.count > 10
    assert force.sum(axis=0) == pytest.approx(0.0, abs=1e-12 * np.abs(force).sum())
    # The closest points of a pair lie along the normal force: without friction it turns nothing.
    smooth = forces_on_nodes(scene.evaluate(scene.p, start, law()), scene.count)
    turn = np.cross(scene.p[: scene.count], smooth)
    assert turn.sum(axis=0) == pytest.approx(0.0, abs=1e-12 * np.abs(turn).sum() + 1e-12)


@pytest.mark.parametrize("slide", [0.0, 1e-4, 1e-3, 1e-2])
def test_stiffness_is_symmetric_and_never_negative(slide: float) -> None:
    scene = Scene(1)
    start = scene.p - slide * np.random.default_rng(3).normal(size=scene.p.shape)
    contacts = scene.evaluate(scene.p, start, law(), 0.5)
    assert np.array_equal(contacts.stiffness, contacts.stiffness.swapaxes(1, 2))
    values = np.linalg.eigvalsh(contacts.stiffness)
    assert (values[:, 0] >= -1e-12 * values[:, 2]).all() and (values[:, 2] > 0).all()


def vertex_over_face(gap: float, slid: Float, friction: float, slip: float = 1e-3) -> Contacts:
    """A cloth vertex above the middle of an avatar face, after sliding by `slid` in the plane."""
    p = np.array([(slid[0], gap, slid[1]), (-1.0, 0.0, -1.0), (0.0, 0.0, 1.0), (1.0, 0.0, -1.0)])
    start = p.copy()
    start[0] = (0.0, gap, 0.0)
    pair = np.array([[0, 1, 2, 3]], np.int32)
    contacts = evaluate_contacts(
        p, start, 1, Meeting((pair, NONE), np.full(4, RADIUS), law()),
        Meeting((NONE, NONE), np.full(4, RADIUS), law()), np.full(4, 2e-4), rubbing(4, friction),
    )  # fmt: skip
    return rubbed(contacts, friction_at_start(contacts, slip))


def test_pressure_is_continuous_and_grows_without_limit() -> None:
    gaps = np.array([1e-9, 1e-6, 1e-4, 2e-3, 0.4999e-2, 0.5001e-2, 0.9e-2, 0.99999e-2])
    still = np.zeros(2)
    push = np.array([vertex_over_face(gap, still, 0.0).force[0, 1] for gap in gaps])
    assert (np.diff(push) < 0).all() and push[0] > 1e5 * push[4] and push[-1] < 1e-4 * push[4]
    assert push[4] == pytest.approx(push[5], rel=1e-3)
    assert vertex_over_face(RADIUS, still, 0.0).count == 0
    # 1e6 Pa per metre, 2e-4 m^2, halfway in.
    assert push[5] == pytest.approx(1e6 * 2e-4 * 0.5 * RADIUS, rel=1e-3)
    assert vertex_over_face(0.008, still, 0.0).stiffness[0, 1, 1] == pytest.approx(1e6 * 2e-4)


@pytest.mark.parametrize("slid", [1e-6, 3e-4, 0.999e-3, 1.001e-3, 5e-3])
def test_friction_obeys_coulomb(slid: float) -> None:
    gap, friction, slip = 0.006, 0.4, 1e-3
    way = np.array([0.6, -0.8])
    contacts = vertex_over_face(gap, slid * way, friction)
    normal = contacts.force[0, 1]
    pull = contacts.force[0, [0, 2]]
    assert pull @ way == pytest.approx(-np.linalg.norm(pull))
    share = 1.0 if slid >= slip else slid / slip * (2.0 - slid / slip)
    assert np.linalg.norm(pull) == pytest.approx(friction * normal * share, rel=1e-9)


@pytest.mark.parametrize("drive", [0.3, 0.99, 1.01, 3.0])
@pytest.mark.parametrize("weight", [1e-3, 1.0])
def test_friction_of_one_pair_is_that_of_its_own_step(drive: float, weight: float) -> None:
    """Solve a vertex on a face by itself, again and again: it ends where Coulomb's law puts it.

    However hard it is pushed out at the start, it rubs with the force that its weight [N] brings about.
    """
    friction, slip, inertia = 0.4, 1e-3, np.array([50.0])
    contacts = vertex_over_face(0.0095, np.zeros(2), 0.0)
    contacts = replace(contacts, friction=np.array([friction]))
    opened = (contacts.push[0] - weight) / contacts.hard[0]
    pull = np.array([drive * friction * weight, inertia[0] * opened - weight, 0.0])
    known = friction_at_start(contacts, slip)
    for _ in range(60):
        now = rubbed(contacts, known)
        move = np.linalg.solve(inertia[0] * np.eye(3) + now.stiffness[0], pull + now.force[0])
        known = friction_after(contacts, known, move[None], inertia, slip)
    assert known.load[0] == pytest.approx(weight, rel=1e-6)
    rubs = float(known.grip[0] * move[0])
    stuck = drive * friction * weight
    slides = inertia[0] * move[0] + rubs
    assert slides == pytest.approx(stuck, rel=1e-6)
    share = 1.0 if move[0] >= slip else move[0] / slip * (2.0 - move[0] / slip)
    assert rubs == pytest.approx(friction * weight * share, rel=1e-3)


def incline(
    degrees: float, friction: float, *, seconds: float, h: float = 1.0 / 240.0
) -> tuple[Float, Float]:
    """Slide a stiff square of cloth on a tilted avatar; return times [s] and distances downhill [m]."""
    angle = np.radians(degrees)
    tilt = np.array(
        [(np.cos(angle), np.sin(angle), 0.0), (-np.sin(angle), np.cos(angle), 0.0), (0.0, 0.0, 1.0)]
    )
    ground, ground_faces = sheet(36, 0.021)
    ground = (ground - ground.mean(axis=0)) @ tilt
    points, faces = sheet(4, 0.02)
    rest = np.ascontiguousarray(points[:, [0, 2]][faces])
    faces, rest = _facing(faces, rest)
    options = StepOptions(
        gravity=GRAVITY, radius_body=0.002, radius_self=0.002, law_body=law(), law_self=law(),
        growth_radius=0.002, slip=2e-5, self_contact=False,
    )  # fmt: skip
    area_load = 0.2 * GRAVITY * np.cos(angle)
    # Start where the pressure carries the weight: kappa (r - d) times both sides' share of area.
    height = 0.002 - area_load / options.law_body.stiffness
    placed = np.ascontiguousarray((points + np.array([0.0, height, 0.0])) @ tilt)
    cloth = _square(placed, faces, rest, friction)
    stepper = cloth_stepper(
        cloth, AvatarSurface(np.ascontiguousarray(ground), ground_faces), options, StageClock()
    )
    downhill = -tilt[0]
    request = StepRequest(h=h, at_rest=False, newton=20, cg_tolerance=1e-6, newton_tolerance=1e-9)
    times, distances = [], []
    for step in range(round(seconds / h)):
        stepper.step(request)
        times.append((step + 1) * h)
        distances.append(float(((stepper.x - placed) @ downhill).mean()))
    return np.array(times), np.array(distances)


def _facing(faces: Int, rest: Float) -> tuple[Int, Float]:
    """Turn faces so that their rest shapes run counter-clockwise."""
    u, v = rest[:, 1] - rest[:, 0], rest[:, 2] - rest[:, 0]
    if (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])[0] < 0.0:
        faces, rest = faces[:, [0, 2, 1]], rest[:, [0, 2, 1]]
    return np.ascontiguousarray(faces), np.ascontiguousarray(rest)


def _square(positions: Float, faces: Int, rest: Float, friction: float) -> Cloth:
    fabric = Fabric(
        name="board", areal_density=0.2, thickness=0.001, bending_warp=1e-3, bending_weft=1e-3,
        bending_bias=1e-3, stretch_warp=5000.0, stretch_weft=5000.0, shear=2000.0, friction_body=friction,
    )  # fmt: skip
    count = len(positions)
    no_nodes, first = np.empty(0, np.int32), np.zeros(len(faces), np.int32)
    return Cloth(
        positions=positions,
        velocities=np.zeros((count, 3)),
        node=np.arange(count, dtype=np.int32),
        faces=faces,
        rest_corners=rest,
        fabrics=(fabric,),
        fabric=first,
        garment=first,
        panel=first,
        uv=positions[:, :2].copy(),
        stitches=np.empty((0, 2), np.int32),
        seam=no_nodes,
        stitch_length=np.empty(0),
        held=no_nodes,
        waist=no_nodes,
        pinned=np.zeros(count, bool),
        rest_curved=np.zeros(len(faces), bool),
        start_positions=positions.copy(),
    )


def test_a_block_rests_where_friction_exceeds_the_slope() -> None:
    """tan 20 = 0.364 < 0.4: it gives by less than the elastic slip, then stays."""
    _, distance = incline(20.0, 0.4, seconds=0.5)
    assert np.abs(distance).max() < 1e-4
    assert abs(distance[-1] - distance[len(distance) // 2]) < 1e-6


@pytest.mark.parametrize(("degrees", "friction"), [(30.0, 0.4), (20.0, 0.2), (25.0, 0.0)])
def test_a_block_slides_with_coulombs_acceleration(degrees: float, friction: float) -> None:
    times, distance = incline(degrees, friction, seconds=0.25)
    angle = np.radians(degrees)
    expected = GRAVITY * (np.sin(angle) - friction * np.cos(angle))
    half = len(times) // 2
    fit = np.polyfit(times[half:], distance[half:], 2)
    assert 2.0 * fit[0] == pytest.approx(expected, rel=0.01)
