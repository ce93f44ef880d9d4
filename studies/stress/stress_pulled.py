"""Hard cases in which pinned cloth is pulled: wrung, through a funnel, into a knot."""

from dataclasses import replace

import numpy as np
import trimesh
from scipy.interpolate import PchipInterpolator

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float, Int
from toile.remesh.panel.rectangle import rectangle
from toile.studies.scenes.scenes import sheet, surface_of
from toile.studies.stress.stress_scene import FPS, StressScene, pushed_plan

TURNS = 4.0
"""Turns of one end of the wrung tube against the other."""


def wring() -> StressScene:
    """Wring a tube by two rings that turn against each other, four turns, and draw near."""
    edge, radius, length = 0.03, 0.1, 0.5
    flat, faces = rectangle(2.0 * np.pi * radius, length, edge)
    angle = flat[:, 0] / radius
    across = np.column_stack((radius * np.cos(angle), radius * np.sin(angle)))
    positions = np.column_stack((flat[:, 1] - 0.5 * length, across))
    ends = (flat[:, 1] < 1e-9) | (flat[:, 1] > length - 1e-9)
    cloth = _closed(sheet(flat, faces, positions, ends), flat, 2.0 * np.pi * radius)
    start = cloth.positions[cloth.pinned]
    side = np.sign(start[:, 0])
    time = np.concatenate([np.linspace(0.0, 1.0, 60), np.ones(6)])[:, None]
    turn = side * np.pi * TURNS * time
    y = np.cos(turn) * start[:, 1] - np.sin(turn) * start[:, 2]
    z = np.sin(turn) * start[:, 1] + np.cos(turn) * start[:, 2]
    x = side * 0.5 * (length - 0.2 * time)
    return _pulled(cloth, edge, np.stack((x, y, z), axis=2), limit=450.0)


def funnel() -> StressScene:
    """Pull a cloth by its middle through a funnel that is much narrower than it."""
    edge = 0.02
    flat, faces = rectangle(0.5, 0.5, edge)
    centred = flat - 0.25
    positions = np.column_stack((centred[:, 0], np.full(len(flat), 0.01), -centred[:, 1]))
    cloth = sheet(flat, faces, positions, np.linalg.norm(centred, axis=1) < 0.025)
    # Its wall in cross-section, from the hole outwards and back.
    wall = np.array([(0.04, -0.25), (0.05, -0.25), (0.05, -0.2), (0.3, -0.02), (0.3, 0.0), (0.04, -0.17)])
    made = trimesh.creation.revolve(np.concatenate([wall, wall[:1]]), sections=48)
    made.apply_transform(trimesh.transformations.rotation_matrix(-0.5 * np.pi, [1, 0, 0]))
    start = cloth.positions[cloth.pinned]
    down = np.concatenate([np.linspace(0.0, 0.8, 48), np.full(4, 0.8)])
    frames = start[None] - down[:, None, None] * np.array([0.0, 1.0, 0.0])
    scene = _pulled(cloth, edge, frames, limit=300.0)
    return replace(scene, avatar=surface_of(made))


def knot() -> StressScene:
    """Pull a ribbon with an overhand knot tight."""
    width, edge = 0.03, 0.01
    # The plan of a long trefoil (Shastri 1992); the ribbon stands on edge, so that it is only bent.
    t = np.linspace(-2.15, 2.15, 2001)
    plan = 0.03 * np.column_stack((t**3 - 3.0 * t, t**4 - 4.0 * t**2))
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(plan, axis=0), axis=1))])
    # At its three crossings it passes over and under itself alternately.
    passes = along[_crossings(plan)]
    levels = 0.75 * width * (-1.0) ** np.arange(len(passes))
    knots = np.concatenate([[-0.1], passes, [along[-1] + 0.1]])
    height = PchipInterpolator(knots, np.concatenate([levels[:1], levels, levels[-1:]]))
    flat, faces = rectangle(along[-1], width, edge)
    rest = np.column_stack((flat[:, 0], flat[:, 1] + height(flat[:, 0])))
    place = [np.interp(flat[:, 0], along, plan[:, axis]) for axis in range(2)]
    positions = np.column_stack((place[0], rest[:, 1], -place[1]))
    ends = (flat[:, 0] < 1.5 * edge) | (flat[:, 0] > along[-1] - 1.5 * edge)
    cloth = sheet(rest, faces, positions, ends)
    start = cloth.positions[cloth.pinned]
    side = np.sign(start[:, 0])
    share = np.concatenate([np.linspace(0.0, 1.0, 60), np.ones(6)])[:, None]
    frames = np.repeat(start[None], len(share), axis=0)
    frames[:, :, 0] += side * share * (0.45 * along[-1] - float(np.abs(start[:, 0]).max()))
    scene = _pulled(cloth, edge, frames, limit=300.0)
    return replace(scene, plan=replace(scene.plan, step=replace(scene.plan.step, gravity=0.0)))


def _crossings(plan: Float) -> Int:
    """Return, in order, the points of a polyline, shape (n, 2), after which it crosses itself."""
    start, way = plan[:-1], np.diff(plan, axis=0)
    apart = start[None] - start[:, None]
    turn = way[:, None, 0] * way[None, :, 1] - way[:, None, 1] * way[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        own = (apart[:, :, 0] * way[None, :, 1] - apart[:, :, 1] * way[None, :, 0]) / turn
        other = (apart[:, :, 0] * way[:, None, 1] - apart[:, :, 1] * way[:, None, 0]) / turn
        hit = (own >= 0.0) & (own < 1.0) & (other >= 0.0) & (other < 1.0)
    first, second = np.nonzero(hit)
    distant = np.abs(first - second) > 1
    return np.asarray(np.unique(first[distant]), np.int32)


def _closed(cloth: Cloth, flat: Float, width: float) -> Cloth:
    """Sew the two sides of a flat sheet, shape (n, 2), to each other: nodes of the same height meet."""
    left, right = np.flatnonzero(flat[:, 0] < 1e-9), np.flatnonzero(flat[:, 0] > width - 1e-9)
    pairs = np.column_stack((left[np.argsort(flat[left, 1])], right[np.argsort(flat[right, 1])])).astype(
        np.int32
    )
    count = len(pairs)
    sewn = replace(cloth, stitches=pairs, seam=np.zeros(count, np.int32), stitch_length=np.zeros(count))
    return sewn.merged(np.ones(count, bool))


def _pulled(cloth: Cloth, edge: float, frames: Float, limit: float) -> StressScene:
    """Make a scene of a cloth whose pinned nodes, in order, follow `frames` [m], shape (k, pins, 3)."""
    motion = VertexMotion(frames=frames, fps=FPS)
    return StressScene(
        cloth=cloth.led(), edge=edge, plan=pushed_plan(), seconds=motion.seconds,
        pin_motion=motion, limit=limit,
    )  # fmt: skip
