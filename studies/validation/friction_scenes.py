"""Scenes of friction: cloth on a slope, a belt on a drum that turns, one with two weights on a fixed drum.

Coulomb's law and Euler's hold to a fraction of a per cent where every step is solved; CONVERGED says what
that takes.
"""

from dataclasses import replace

import numpy as np
import trimesh

from toile.dressing.garment.fabrics import fabric
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.film.plan import PUSHED_NEWTON, PUSHED_TOLERANCE, FilmFrame, FilmPlan
from toile.engine.film.simulate import Simulation
from toile.engine.forces.membrane import Membrane
from toile.geometry.arrays import Float, Int
from toile.remesh.panel.rectangle import rectangle
from toile.studies.scenes.flat_meshes import right_grid
from toile.studies.scenes.scenes import GRAVITY, film_plan, sheet, surface_of

CONVERGED = {"newton": 8, "newton_tolerance": 1e-7, "cg_tolerance": 1e-4}
PUSHED = {"newton": PUSHED_NEWTON, "newton_tolerance": PUSHED_TOLERANCE}
"""As garments follow an avatar."""
GAP = 0.002
"""Contact radius of film scenes [m]."""
FPS = 30.0


def plan(solver: dict[str, float]) -> FilmPlan:
    """Return the plan of a film without self-contact whose steps are solved as `solver` says."""
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
    plane, ground_faces = right_grid(2.05, 2.05, 0.05)
    plane = plane - 0.5 * 2.05
    ground = np.ascontiguousarray(np.column_stack((plane[:, 0], np.zeros(len(plane)), -plane[:, 1])) @ tilt)
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
    """Return the acceleration of a motion in its second half [m/s^2]."""
    half = len(times) // 2
    return float(2.0 * np.polyfit(times[half:], distances[half:], 2)[0])


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
    """Return the surface of a drum along z: vertices [m], shape (n, 3), and faces, shape (t, 3)."""
    return surface_of(trimesh.creation.cylinder(radius=RADIUS, height=2.0 * WIDTH, sections=180))


def belt(wrap: float, first: float | None, last: float, friction: float) -> Cloth:
    """Return a strip that comes straight to the drum, goes around it by `wrap` [rad] and hangs down behind.

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
    """Return the force of the membrane on the pinned nodes [N]."""
    stepper = run.stepper
    membrane = stepper.force(Membrane)
    assert membrane is not None
    gradient = np.zeros_like(stepper.x)
    membrane.add_gradient(stepper.x, gradient)
    return float(np.linalg.norm(gradient[run.cloth.pinned].sum(axis=0)))


def band_brake(degrees: int, towards: str, friction: float) -> tuple[float, float]:
    """Hang a weight on a pinned belt around a drum that turns beneath it towards the "weight" or the "pins".

    Returns the pull at the pins and the one of Euler's formula, exp(+-mu phi) times the weight [N].
    """
    speed, rest, seconds = 0.1, 0.2, 0.8
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
    return float(np.mean(pulls[-9:])), float(exact)


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
