"""The scenes of the hard-case suite."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import trimesh

from toile.dressing.garment.fabrics import fabric
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float, Int
from toile.remesh.panel.rectangle import rectangle
from toile.studies.scenes.scenes import film_plan, sheet, surface_of
from toile.studies.stress.stress_pulled import funnel, knot, wring
from toile.studies.stress.stress_scene import FPS, StressScene, pushed_plan
from toile.studies.stress.stress_torn import overstretched_seams, spinning_skirt


def sphere_10ms() -> StressScene:
    """Send a ball at 10 m/s into a hanging cloth."""
    cloth, edge = _hanging(0.04)
    ball, faces = _ball(0.15)
    along = np.minimum(-0.6 + 10.0 * np.arange(14) / FPS, 0.6)
    return _moving(cloth, edge, ball, faces, along[:, None] * np.array([0.0, 0.0, 1.0]))


def spikes() -> StressScene:
    """Drop a cloth on a bed of spikes."""
    cones = []
    for i in range(5):
        for j in range(5):
            cone = trimesh.creation.cone(radius=0.03, height=0.15, sections=12)
            cone.apply_transform(trimesh.transformations.rotation_matrix(-0.5 * np.pi, [1, 0, 0]))
            cone.apply_translation([0.12 * (i - 2), 0.0, 0.12 * (j - 2)])
            cones.append(cone)
    bed = trimesh.util.concatenate(cones)
    cloth = _level(0.6, 0.03, height=0.2)
    return _still(cloth, 0.03, bed, 1.5)


def twenty_layers() -> StressScene:
    """Let a stack of twenty squares fall on a ball."""
    flat, faces = rectangle(0.3, 0.3, 0.03)
    count = 20
    heights = 0.16 + 0.01 * np.arange(count)
    positions = np.concatenate(
        [np.column_stack((flat[:, 0] - 0.15, np.full(len(flat), y), 0.15 - flat[:, 1])) for y in heights]
    )
    all_faces = np.concatenate([faces + len(flat) * layer for layer in range(count)]).astype(np.int32)
    cloth = sheet(np.tile(flat, (count, 1)), all_faces, positions, np.zeros(len(positions), bool))
    ball, ball_faces = _ball(0.12)
    plan = film_plan()
    return StressScene(cloth=cloth, edge=0.03, plan=plan, seconds=1.0, avatar=(ball, ball_faces), limit=300.0)


def squeeze() -> StressScene:
    """Press a hanging cloth between two arms until they overlap, and let go again."""
    cloth, edge = _hanging(0.04)
    arm = trimesh.creation.capsule(height=0.5, radius=0.08, count=[24, 24])
    arm.apply_transform(trimesh.transformations.rotation_matrix(0.5 * np.pi, [0, 1, 0]))
    arm.apply_translation([-arm.bounds.mean(axis=0)[0], 0.0, 0.05])
    body = trimesh.util.concatenate([arm, arm.copy()])
    side = np.where(np.arange(len(body.vertices)) < len(arm.vertices), -1.0, 1.0)
    distance = np.concatenate([np.linspace(0.2, 0.075, 18), np.full(6, 0.075), np.linspace(0.075, 0.2, 12)])
    vertices, faces = surface_of(body)
    moves = distance[:, None, None] * side[None, :, None] * np.array([0.0, 0.0, 1.0])
    return _film(cloth, edge, vertices[None] + moves, faces)


def self_crossing() -> StressScene:
    """Let a cloth fall on a body of two balls that cross each other."""
    left = trimesh.creation.icosphere(subdivisions=3, radius=0.15)
    right = left.copy()
    left.apply_translation([-0.1, 0.0, 0.0])
    right.apply_translation([0.1, 0.0, 0.03])
    return _still(_level(0.7, 0.03, height=0.2), 0.03, trimesh.util.concatenate([left, right]), 1.5)


def stiff_canvas() -> StressScene:
    """Let canvas swing down from one edge in steps of 1/24 s."""
    cloth, edge = _hanging(0.04, level=True, material=fabric("canvas"))
    plan = replace(film_plan(), longest_step=1.0 / 24.0, frame_seconds=1.0 / 24.0, motion_max=1.0)
    return StressScene(cloth=cloth, edge=edge, plan=plan, seconds=1.5)


def light_cloth() -> StressScene:
    """Let cloth of 0.01 kg/m^2 fall on a ball."""
    return _weighed(0.01)


def heavy_cloth() -> StressScene:
    """Let cloth of 5 kg/m^2 fall on a ball."""
    return _weighed(5.0)


def slivers() -> StressScene:
    """Let a cloth with triangles of one degree fall on a ball."""
    flat, faces = rectangle(0.7, 0.7, 0.05)
    # Every tenth face gets a vertex that close to its longest edge.
    new_points: list[Float] = []
    added: list[tuple[int, int, int]] = []
    kept = np.ones(len(faces), bool)
    for number in range(0, len(faces), 10):
        a, b, c = (flat[v] for v in faces[number])
        lift = np.tan(np.radians(1.0)) * 0.5 * np.linalg.norm(b - a)
        middle = 0.5 * (a + b)
        away = (c - middle) / np.linalg.norm(c - middle)
        new = len(flat) + len(new_points)
        new_points.append(middle + lift * away)
        i, j, k = faces[number]
        kept[number] = False
        added += [(i, j, new), (j, k, new), (k, i, new)]
    flat = np.concatenate([flat, np.array(new_points)])
    faces = np.concatenate([faces[kept], np.array(added, np.int32)])
    positions = np.column_stack((flat[:, 0] - 0.35, np.full(len(flat), 0.2), 0.35 - flat[:, 1]))
    cloth = sheet(flat, np.ascontiguousarray(faces, np.int32), positions, np.zeros(len(flat), bool))
    ball, ball_faces = _ball(0.15)
    return StressScene(cloth=cloth, edge=0.05, plan=film_plan(), seconds=1.0, avatar=(ball, ball_faces))


def teleport() -> StressScene:
    """Let a ball under a cloth jump by three metres: no cloth can follow."""
    cloth = _level(0.5, 0.04, height=0.16)
    ball, faces = _ball(0.15)
    along = np.zeros((12, 3))
    along[8:, 0] = 3.0
    return replace(_moving(cloth, 0.04, ball, faces, along), expected="message")


def crumple() -> StressScene:
    """Shrink a box around a square to an eighth of its width, without gravity."""
    edge = 0.03
    cloth = _level(0.4, edge, height=0.0, jitter=1e-3)
    box = trimesh.creation.box(extents=(0.5, 0.5, 0.5)).subdivide().subdivide()
    # Its outside is where the cloth is.
    vertices, faces = (
        np.ascontiguousarray(box.vertices, np.float64),
        np.ascontiguousarray(box.faces[:, ::-1], np.int32),
    )
    share = np.concatenate([np.linspace(1.0, 0.125, 40), np.full(4, 0.125)])
    scene = _film(cloth, edge, share[:, None, None] * vertices[None], faces)
    step = replace(scene.plan.step, gravity=0.0)
    return replace(scene, plan=replace(scene.plan, step=step), limit=600.0, shows_avatar=False)


STRESS_SCENES: dict[str, Callable[[], StressScene]] = {
    case.__name__: case
    for case in (
        sphere_10ms, spikes, twenty_layers, squeeze, self_crossing, stiff_canvas, light_cloth, heavy_cloth,
        slivers, teleport, crumple, wring, funnel, knot, spinning_skirt, overstretched_seams,
    )
}  # fmt: skip
"""Cases by name."""


def _ball(radius: float) -> tuple[Float, Int]:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    return surface_of(ball)


def _hanging(edge: float, level: bool = False, material: Fabric | None = None) -> tuple[Cloth, float]:
    """Return a square of 1 m held along its upper edge, hanging or still level."""
    flat, faces = rectangle(1.0, 1.0, edge)
    up = flat[:, 1] - 0.5
    still = np.zeros(len(flat))
    positions = np.column_stack((flat[:, 0] - 0.5, still, -up) if level else (flat[:, 0] - 0.5, up, still))
    return sheet(flat, faces, positions, flat[:, 1] > 1.0 - 1e-9, material), edge


def _level(
    size: float, edge: float, height: float, jitter: float = 0.0, material: Fabric | None = None
) -> Cloth:
    """Return a level square, free, perhaps uneven by up to `jitter` [m]."""
    flat, faces = rectangle(size, size, edge)
    uneven = jitter * np.sin(37.0 * flat[:, 0]) * np.cos(41.0 * flat[:, 1])
    positions = np.column_stack((flat[:, 0] - 0.5 * size, height + uneven, 0.5 * size - flat[:, 1]))
    return sheet(flat, faces, positions, np.zeros(len(flat), bool), material)


def _still(cloth: Cloth, edge: float, obstacle: trimesh.Trimesh, seconds: float) -> StressScene:
    return StressScene(cloth=cloth, edge=edge, plan=film_plan(), seconds=seconds, avatar=surface_of(obstacle))


def _weighed(areal_density: float) -> StressScene:
    material = replace(fabric("cotton-poplin"), areal_density=areal_density)
    ball, faces = _ball(0.15)
    cloth = _level(0.7, 0.035, height=0.2, material=material)
    return StressScene(cloth=cloth, edge=0.035, plan=film_plan(), seconds=1.5, avatar=(ball, faces))


def _moving(cloth: Cloth, edge: float, vertices: Float, faces: Int, places: Float) -> StressScene:
    """Make a scene of a rigid body at `places` [m], shape (k, 3)."""
    return _film(cloth, edge, vertices[None] + places[:, None, :], faces)


def _film(cloth: Cloth, edge: float, frames: Float, faces: Int) -> StressScene:
    """Make a scene of a body in motion, `frames` [m] of shape (k, v, 3)."""
    motion = VertexMotion(frames=frames, fps=FPS)
    return StressScene(
        cloth=cloth,
        edge=edge,
        plan=pushed_plan(),
        seconds=motion.seconds,
        avatar=(frames[0].copy(), faces),
        motion=motion,
    )
