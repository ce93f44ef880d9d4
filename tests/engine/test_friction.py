"""Friction of cloth in a film: Coulomb's law on an incline, Euler's on a drum.

The law holds to a fraction of a per cent where every step is solved; CONVERGED says what that takes.
"""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from tests.collide.surfaces import sheet as ground_grid
from tests.engine.meshes import right_grid
from toile.dress.benchmarks.scenes import GRAVITY, film_plan, rectangle, sheet
from toile.dress.fabrics import fabric
from toile.engine.assembly import scatter_gradients
from toile.engine.cloth import Cloth
from toile.engine.fabric import Fabric
from toile.engine.film_plan import PUSHED_NEWTON, PUSHED_TOLERANCE, FilmFrame, FilmPlan
from toile.engine.simulate import Simulation
from toile.engine.vertex_motion import VertexMotion
from toile.geometry.arrays import Float, Int

CONVERGED = {"newton": 8, "newton_tolerance": 1e-7, "cg_tolerance": 1e-4}
PUSHED = {"newton": PUSHED_NEWTON, "newton_tolerance": PUSHED_TOLERANCE}
"""As garments follow an avatar."""
GAP = 0.002
"""Contact radius of film scenes [m]."""
FPS = 30.0


def plan(solver: dict[str, float]) -> FilmPlan:
    usual = film_plan()
    return replace(usual, step=replace(usual.step, self_contact=False), **solver)  # type: ignore[arg-type]


def incline(
    friction: float, steepness: float, seconds: float, solver: dict[str, float] = CONVERGED
) -> tuple[Float, Float, float]:
    """Lay poplin on a plane of slope `steepness` times the friction coefficient and let it go.

    Returns times [s], distances downhill of all nodes [m], shape (k, n), and Coulomb's acceleration [m/s^2].
    """
    angle = np.arctan(steepness * friction)
    tilt = np.array(
        [(np.cos(angle), np.sin(angle), 0.0), (-np.sin(angle), np.cos(angle), 0.0), (0.0, 0.0, 1.0)]
    )
    ground, ground_faces = ground_grid(42, 0.05)
    ground = np.ascontiguousarray((ground - ground.mean(axis=0)) @ tilt)
    material = replace(fabric("cotton-poplin"), friction_body=friction)
    film = plan(solver)
    # Where the pressure carries the weight.
    height = GAP - material.areal_density * GRAVITY * np.cos(angle) / film.step.law_body.stiffness
    flat, faces = rectangle(0.3, 0.3, 0.03)
    level = np.column_stack((flat[:, 0] - 0.15, np.full(len(flat), height), 0.15 - flat[:, 1]))
    start = np.ascontiguousarray(level @ tilt)
    cloth = sheet(flat, faces, start, np.zeros(len(flat), bool), material)
    times: list[float] = []
    distances: list[Float] = []

    def keep(frame: FilmFrame) -> bool:
        times.append(frame.seconds)
        distances.append((start - frame.cloth.positions) @ tilt[0])
        return True

    Simulation(cloth, (ground, ground_faces), film, keep).run(seconds)
    expected = GRAVITY * (np.sin(angle) - friction * np.cos(angle))
    return np.array(times), np.array(distances), float(expected)


def acceleration(times: Float, distances: Float) -> float:
    """Acceleration of a motion in its second half [m/s^2]."""
    half = len(times) // 2
    return float(2.0 * np.polyfit(times[half:], distances[half:], 2)[0])


@pytest.mark.parametrize("friction", [0.2, 0.4])
def test_cloth_sticks_on_a_slope_just_below_the_friction_limit(friction: float) -> None:
    """It creeps by less than 0.1 mm/s.

    First it gives by the elastic slip eps, where friction is yet to build up, and what it has gained there
    carries it on: by energy, eps / (3 (1 - share)) in all.
    """
    times, distances, _ = incline(friction, 0.97, 1.5)
    creep = (distances[-1] - distances[-9]) / (times[-1] - times[-9])
    assert np.abs(creep).max() < 1e-4
    slip = film_plan().step.slip
    assert 0.0 < distances.max() < slip / (3.0 * 0.03)


@pytest.mark.parametrize(("friction", "steepness"), [(0.2, 1.03), (0.4, 1.03), (0.8, 1.03), (0.4, 2.0)])
def test_cloth_slides_with_coulombs_acceleration(friction: float, steepness: float) -> None:
    """Just above the limit 3 % of the acceleration is 0.1 % of the friction."""
    times, distances, expected = incline(friction, steepness, 0.5)
    assert acceleration(times, distances.mean(axis=1)) == pytest.approx(expected, rel=0.03)
    assert np.ptp(distances[-1]) < 1e-3


@pytest.mark.parametrize(
    ("friction", "steepness", "least"), [(0.4, 1.1, 0.85), (0.2, 1.5, 0.85), (0.4, 2.0, 0.6)]
)
def test_cloth_slides_about_as_far_in_the_few_iterations_of_a_film_on_an_avatar(
    friction: float, steepness: float, least: float
) -> None:
    """One iteration per step: shares of Coulomb's distance, 2 to 6 % where friction is of the step's start.

    What is missing goes in few steps: a node that lands hard grips at once what friction takes from it later.
    """
    times, distances, expected = incline(friction, steepness, 0.5, PUSHED)
    assert least < distances[-1].mean() / (0.5 * expected * times[-1] ** 2) < 1.15


BELT = Fabric(
    name="belt", areal_density=0.002, thickness=2e-4, bending_warp=1e-7, bending_weft=1e-7, bending_bias=1e-7,
    stretch_warp=20000.0, stretch_weft=2000.0, shear=300.0, compression=1.0,
)  # fmt: skip
"""So light and limp that only what hangs on it counts."""
RADIUS, LEAD, WIDTH, EDGE = 0.05, 0.06, 0.01, 0.008
"""Radius of the drum; of the belt its straight ends, its width and its edges [m]."""
WEIGHT = 0.02
"""Mass that hangs on the belt [kg]: contacts give by 0.2 mm."""


def drum() -> tuple[Float, Int]:
    mesh = trimesh.creation.cylinder(radius=RADIUS, height=2.0 * WIDTH, sections=180)
    return np.ascontiguousarray(mesh.vertices, np.float64), np.ascontiguousarray(mesh.faces, np.int32)


def belt(wrap: float, first: float | None, last: float, friction: float) -> Cloth:
    """A strip that comes straight to the drum, goes around it by `wrap` and hangs down on its far side.

    `first` and `last` are the masses at its ends [kg]; without one the first end is pinned.
    """
    reach = RADIUS + GAP
    length = 2.0 * LEAD + reach * wrap
    flat, faces = right_grid(length, WIDTH, EDGE)
    along = flat[:, 0] - LEAD
    angle = wrap - np.clip(along / reach, 0.0, wrap)
    before, after = np.maximum(-along, 0.0), np.maximum(along - reach * wrap, 0.0)
    positions = np.column_stack(
        (
            reach * np.cos(angle) - before * np.sin(wrap),
            reach * np.sin(angle) + before * np.cos(wrap) - after,
            0.5 * WIDTH - flat[:, 1],
        )
    )
    pinned = (flat[:, 0] < 1e-9) & (first is None)
    material = replace(BELT, friction_body=friction)
    cloth = sheet(flat, faces, positions, pinned, material)
    fabrics, index = [material], np.zeros(len(faces), np.int32)
    corners = flat[faces][:, :, 0]
    ends = (corners.max(axis=1) < 2.5 * EDGE, corners.min(axis=1) > length - 2.5 * EDGE)
    for weight, end in zip((first, last), ends, strict=True):
        if weight is not None:
            index[end] = len(fabrics)
            fabrics.append(replace(material, areal_density=weight / cloth.rest_area[end].sum()))
    return replace(cloth, fabrics=tuple(fabrics), fabric=index)


def pull_at_the_pins(run: Simulation) -> float:
    """Force of the membrane on the pinned nodes [N]."""
    stepper = run.stepper
    stepper.membrane.evaluate(stepper.x)
    forces = np.zeros_like(stepper.x)
    scatter_gradients(stepper.faces, stepper.membrane.element_gradient, forces)
    return float(np.linalg.norm(forces[run.cloth.pinned].sum(axis=0)))


@pytest.mark.parametrize(("degrees", "towards"), [(90, "weight"), (90, "pins"), (180, "pins")])
def test_a_turning_drum_pulls_a_belt_as_eulers_formula_says(degrees: int, towards: str) -> None:
    """A band brake: the weight hangs still, the drum turns beneath, the pins hold exp(+-mu phi) of it."""
    friction, speed, rest, seconds = 0.3, 0.1, 0.2, 0.8
    wrap, sign = np.radians(degrees), -1.0 if towards == "weight" else 1.0
    vertices, faces = drum()
    turns = sign * speed / RADIUS * np.maximum(np.arange(round(seconds * FPS) + 1) / FPS - rest, 0.0)
    x, y = vertices[:, 0], vertices[:, 1]
    poses = [
        np.column_stack((np.cos(a) * x - np.sin(a) * y, np.sin(a) * x + np.cos(a) * y, vertices[:, 2]))
        for a in turns
    ]
    pulls: list[float] = []

    def measure(_: FilmFrame) -> bool:
        pulls.append(pull_at_the_pins(run))
        return True

    film = plan(CONVERGED)
    motion = VertexMotion(frames=np.stack(poses), fps=FPS)
    run = Simulation(belt(wrap, None, WEIGHT, friction), (motion.pose(0), faces), film, measure, motion)
    run.run(seconds)
    exact = WEIGHT * GRAVITY * np.exp(-sign * friction * wrap)
    # Corners of the drum pluck at the belt: means of 0.3 s.
    assert np.mean(pulls[-9:]) == pytest.approx(exact, rel=0.03)


def pulley(friction: float, share: float, seconds: float) -> tuple[Float, Float, float]:
    """Hang a belt over a fixed drum, half way around, one weight `share` exp(mu pi) times the other.

    Returns times [s], how far the heavy end went down and the light one up [m], and their masses' ratio.
    """
    ratio = share * float(np.exp(friction * np.pi))
    cloth = belt(np.pi, WEIGHT, ratio * WEIGHT, friction)
    light, heavy = (cloth.uv[:, 0] == end for end in (cloth.uv[:, 0].min(), cloth.uv[:, 0].max()))
    times: list[float] = []
    places: list[float] = []

    def watch(frame: FilmFrame) -> bool:
        height = frame.cloth.positions[:, 1]
        times.append(frame.seconds)
        places.append(0.5 * float(height[light].mean() - height[heavy].mean()))
        return True

    film = replace(plan(CONVERGED), frame_seconds=1.0 / 60.0)
    Simulation(cloth, drum(), film, watch).run(seconds)
    return np.array(times), np.array(places) - places[0], ratio


def test_a_belt_over_a_fixed_drum_holds_just_below_eulers_ratio() -> None:
    times, distances, _ = pulley(0.3, 0.97, 1.0)
    assert abs(distances[-1] - distances[-13]) / (times[-1] - times[-13]) < 1e-4


@pytest.mark.parametrize(
    ("friction", "share", "seconds"), [(0.3, 1.03, 0.5), (0.3, 1.2, 0.3), (0.2, 1.2, 0.3)]
)
def test_a_belt_over_a_fixed_drum_slides_above_eulers_ratio(
    friction: float, share: float, seconds: float
) -> None:
    """Its ends fall and rise with a: the pulls are m2 (g - a) and m1 (g + a), their ratio exp(mu pi)."""
    times, distances, ratio = pulley(friction, share, seconds)
    a = acceleration(times, distances)
    assert 0.01 < distances[-1] < LEAD and a > 0.1
    pulls = ratio * (GRAVITY - a) / (GRAVITY + a)
    assert pulls == pytest.approx(np.exp(friction * np.pi), rel=0.03)
