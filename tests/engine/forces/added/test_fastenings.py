"""Fastened points: what they bear, opening over a film, points that stay where they are in the cloth."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.adapt.test_remeshing import adapted, cloth_at, rolled
from tests.engine.forces.added.shapes import SOFT
from tests.engine.step.test_only_what_is_asked import GRAVITY, options
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.fastenings import Fastening, found_points
from toile.engine.cloth.fields.keyed import Keyed
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.film.begin_holds import at_start
from toile.engine.forces.added.fastening_pull import FasteningPull
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.cloth_forces import cloth_forces, cloth_stepper
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Float, Int
from toile.geometry.stage_clock import StageClock
from toile.studies.scenes.flat_meshes import mesh, right_grid

WIDTH, HEIGHT, GAP = 0.2, 0.1, 0.002
STIFF = 2000.0


def strips(*rows: Fastening) -> Cloth:
    """Two strips that hang in the plane x, y, the upper one (panel 0) pinned all over."""
    points, faces = right_grid(WIDTH, HEIGHT, 0.03)
    count = len(points)
    places = np.column_stack([points, np.zeros(count)])
    below = places - (0.0, HEIGHT + GAP, 0.0)
    cloth = flat_cloth(
        np.concatenate([points, points]), np.concatenate([faces, faces + count]),
        np.concatenate([places, below]), SOFT, np.arange(2 * count) < count,
    )  # fmt: skip
    panel = np.repeat(np.array([0, 1], np.int32), len(faces))
    return replace(cloth, panel=panel, fastenings=rows)


def row(x: Float, closed: float | Keyed = 1.0, most: float = 100.0, side: int = 0) -> Fastening:
    """The upper border of the lower strip on the lower border of the upper one, at some x [m], shape (k,)."""
    none = np.zeros(len(x))
    return Fastening(
        over=(0, 1), under=(0, 0), over_points=np.column_stack([x, none + HEIGHT, none]),
        under_points=np.column_stack([x, none, none]), side=side, distance=GAP,
        stiffness=np.full(len(x), STIFF), most=np.full(len(x), most), closed=closed,
    )  # fmt: skip


def stepper_of(cloth: Cloth) -> ClothStepper:
    return cloth_stepper(cloth, None, options(), StageClock())


def pull_of(stepper: ClothStepper) -> FasteningPull:
    force = stepper.force(FasteningPull)
    assert force is not None
    return force


@pytest.mark.parametrize("side", [0, 1])
def test_a_strip_hangs_by_its_weight_over_the_stiffness(side: int) -> None:
    """Also of buttons, whose distance is along the normal: they start to one side of it."""
    x = WIDTH * (np.arange(5) + 0.5) / 5
    cloth = strips(row(x, side=side))
    stepper = stepper_of(cloth)
    for h in [0.005] * 10 + [0.05] * 60:
        stepper.step(StepRequest(h=h, at_rest=True, cg_tolerance=1e-6))
    weight = float(cloth.mass[~cloth.pinned].sum() * GRAVITY)
    pull = pull_of(stepper).pull(stepper.x)
    away = weight / 5 / STIFF
    assert float(pull.sum()) == pytest.approx(weight, rel=0.01 if side == 0 else 0.05)
    if side == 0:
        top = stepper.x[~cloth.pinned][cloth.uv[~cloth.pinned, 1] > HEIGHT - 1e-9, 1]
        assert -top.mean() == pytest.approx(GAP + away, abs=0.2 * away + 2e-5)


def test_no_force_and_no_torque_on_the_whole() -> None:
    cloth = strips(row(WIDTH * np.array([0.2, 0.7]), side=1), row(WIDTH * np.array([0.4]), side=-1, most=0.5))
    force = FasteningPull.for_cloth(cloth)
    assert force is not None
    x = cloth.positions + 0.01 * np.random.default_rng(1).standard_normal(cloth.positions.shape)
    gradient = np.zeros_like(x)
    force.add_gradient(x, gradient)
    scale = np.abs(gradient).max()
    assert scale > 0.1
    assert np.abs(gradient.sum(axis=0)).max() < 1e-12 * scale
    assert np.abs(np.cross(x, gradient).sum(axis=0)).max() < 1e-12 * scale


def test_a_pair_never_pulls_with_more_than_its_most() -> None:
    cloth = strips(row(np.array([0.05, 0.15]), most=3.0))
    force = FasteningPull.for_cloth(cloth)
    assert force is not None
    x = cloth.positions - np.where(cloth.pinned, 0.0, 0.3)[:, None]
    assert force.pull(x) == pytest.approx([3.0, 3.0])


def test_a_row_closes_from_its_beginning_pair_by_pair() -> None:
    half = row(np.linspace(0.02, 0.18, 8), closed=0.5)
    assert half.acting(0.0).tolist() == [1, 1, 1, 1, 0, 0, 0, 0]
    opening = row(np.linspace(0.02, 0.18, 4), closed=Keyed((0.0, 1.0), (1.0, 0.0)))
    assert opening.acting(0.375).tolist() == [1.0, 1.0, 0.5, 0.0]
    # A film's keys count from its frame 0, after the lead-in.
    motion = VertexMotion(frames=np.zeros((5, 1, 3)), fps=2.0, lead=2)
    (moved,) = at_start(strips(opening), motion).fastenings
    assert moved.acting(1.375).tolist() == [1.0, 1.0, 0.5, 0.0]


def test_a_zip_that_opens_in_a_film_lets_go() -> None:
    """First it hangs; when all is open it falls as a stone does."""
    x = WIDTH * (np.arange(20) + 0.5) / 20
    cloth = strips(row(x, closed=Keyed((0.1, 0.2), (1.0, 0.0))))
    stepper = stepper_of(cloth)
    h = 0.005
    heights = []
    for step in range(60):
        stepper.step(StepRequest(h=h, at_rest=False, cg_tolerance=1e-4, seconds=(step + 1) * h))
        heights.append(stepper.x[~cloth.pinned, 1].mean())
    assert heights[0] - heights[19] < 2e-3
    fall = np.diff(np.array(heights[45:]), 2) / h**2
    assert fall == pytest.approx(-GRAVITY, rel=0.02)


def test_points_lie_in_the_cloth_where_they_did_after_remeshing() -> None:
    points, faces = mesh("random", 0.6, 0.3, 0.04)
    cloth = cloth_at(points, faces, rolled(points, 0.08))
    inside = np.random.default_rng(3).uniform((0.0, 0.0), (0.6, 0.3), (50, 2))
    edge = np.column_stack([np.linspace(0.0, 0.6, 20), np.full(20, 0.3)])
    marked = np.pad(np.concatenate([inside, edge]), ((0, 0), (0, 1)))

    def there(now: Cloth) -> Float:
        chosen: Int = np.arange(len(now.faces), dtype=np.int32)
        found = found_points(marked, chosen, now.rest_space[now.faces])
        return np.asarray(np.einsum("kq,kqi->ki", found.weights, now.rest_space[now.faces[found.face]]))

    after = adapted(cloth).cloth
    assert len(after.faces) != len(cloth.faces)
    for now in (cloth, after, adapted(replace(after, positions=rolled(after.uv, 0.12))).cloth):
        assert np.abs(there(now) - marked).max() < 1e-12


def test_nothing_of_it_without_closures_and_while_seams_are_open() -> None:
    cloth = strips()
    assert not any(isinstance(force, FasteningPull) for force in cloth_forces(cloth, options()))
    closed = strips(row(np.array([0.1])))
    sewn = replace(
        closed, stitches=np.array([[0, 1]], np.int32), seam=np.zeros(1, np.int32), stitch_length=np.ones(1)
    )
    assert FasteningPull.for_cloth(closed) is not None and FasteningPull.for_cloth(sewn) is None
