"""Hard cases of cloth that is whirled about, or that starts torn far out of its shape."""

from dataclasses import replace

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float, Int
from toile.remesh.panel.panel_mesh import triangulate_panel
from toile.remesh.panel.rectangle import rectangle
from toile.studies.scenes.scenes import sheet, surface_of
from toile.studies.stress.stress_scene import StressScene, pushed_plan

TURNS_PER_SECOND = 3.0
"""Speed of the spinning skirt."""
SPIN_UP, SPIN, AFTERWARDS = 0.5, 1.0, 1.0
"""How long the skirt is brought to speed, turns at it, and hangs after the sudden stop [s]."""
SPIN_FPS = 240.0
"""Frames per second of the turning body: in coarser ones its skin would cut the corners of its way."""
WAIST, SKIRT = 0.13, 0.45
"""Radius of the waist and length of the spinning skirt [m]."""
OVERSTRETCH = 5.0
"""Length of the triangles beside an overstretched seam, in their rest lengths."""


def spinning_skirt() -> StressScene:
    """Spin a circle skirt on hips and legs, three turns a second, and stop them at once."""
    edge = 0.035
    flat, triangles = _ring(WAIST, WAIST + SKIRT, edge)
    positions = np.column_stack((flat[:, 0], np.zeros(len(flat)), -flat[:, 1]))
    cloth = sheet(flat, triangles, positions, np.linalg.norm(flat, axis=1) < WAIST + 1e-6).led()
    parts = [trimesh.creation.capsule(height=0.5, radius=0.118, count=[24, 32])]
    for side in (-1.0, 1.0):
        leg = trimesh.creation.capsule(height=0.7, radius=0.055, count=[16, 24])
        leg.apply_translation([0.06 * side, 0.0, -0.6])
        parts.append(leg)
    body = trimesh.boolean.union(parts, engine="manifold")
    body.apply_transform(trimesh.transformations.rotation_matrix(-0.5 * np.pi, [1, 0, 0]))
    body.apply_translation([0.0, 0.1, 0.0])
    time = np.arange(round((SPIN_UP + SPIN + AFTERWARDS) * SPIN_FPS) + 1) / SPIN_FPS
    ramp = np.minimum(time, SPIN_UP)
    angle = 2.0 * np.pi * TURNS_PER_SECOND * (
        0.5 * ramp**2 / SPIN_UP + np.clip(time - SPIN_UP, 0.0, SPIN)
    )  # fmt: skip
    vertices, faces = surface_of(body)
    return StressScene(
        cloth=cloth, edge=edge, plan=pushed_plan(), seconds=float(time[-1]), limit=300.0,
        avatar=(vertices, faces),
        motion=VertexMotion(frames=_turned(vertices, angle), fps=SPIN_FPS),
        pin_motion=VertexMotion(frames=_turned(cloth.positions[cloth.pinned], angle), fps=SPIN_FPS),
    )  # fmt: skip


def overstretched_seams() -> StressScene:
    """Let go a strip of four panels, the triangles beside its seams drawn out five times, above a ball."""
    edge, panel = 0.025, 0.2
    flat, faces = rectangle(4.0 * panel, 0.4, edge)
    # Distances from the nearest seam grow to OVERSTRETCH times themselves within one edge of it.
    seam = panel * np.round(flat[:, 0] / panel)
    away = flat[:, 0] - seam
    torn = seam * (1.0 + 2.0 * (OVERSTRETCH - 1.0) * edge / panel)
    along = torn + np.sign(away) * (np.abs(away) + (OVERSTRETCH - 1.0) * np.minimum(np.abs(away), edge))
    positions = np.column_stack((along - 0.5 * along.max(), np.full(len(flat), 0.2), 0.2 - flat[:, 1]))
    cloth = sheet(flat, faces, positions, np.zeros(len(flat), bool))
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.15)
    return StressScene(
        cloth=cloth, edge=edge, plan=replace(pushed_plan(), longest_step=1.0 / 240.0), seconds=1.0,
        avatar=surface_of(ball),
    )  # fmt: skip


def _turned(points: Float, angle: Float) -> Float:
    """Return points [m], shape (n, 3), turned about the vertical by every angle [rad], shape (k, n, 3)."""
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y, z = points.T
    level = np.broadcast_to(y, (len(angle), len(y)))
    return np.stack((cosine * x + sine * z, level, cosine * z - sine * x), axis=2)


def _ring(inner: float, outer: float, edge: float) -> tuple[Float, Int]:
    """Mesh a ring: points [m], shape (n, 2), and faces, shape (t, 3), counter-clockwise."""
    radii = np.linspace(inner, outer, round((outer - inner) / edge) + 1)
    out, back = np.exp(1j * _halfway_round(outer, edge)), np.exp(1j * _halfway_round(inner, edge)[::-1])
    border = np.concatenate([radii[:-1], outer * out[:-1], -radii[:0:-1], inner * back[:-1]])
    half = triangulate_panel(np.column_stack((border.real, border.imag)), edge_length=edge)
    points = np.concatenate([half.vertices, -half.vertices])
    # The two halves share the points on the line between them.
    _, nearest = cKDTree(points).query(points, 2, distance_upper_bound=1e-9)
    first = np.minimum(nearest, np.arange(len(points))[:, None]).min(axis=1)
    kept, number = np.unique(first, return_inverse=True)
    faces = np.concatenate([half.faces, half.faces + len(half.vertices)])
    return points[kept], number[faces].astype(np.int32)


def _halfway_round(radius: float, edge: float) -> Float:
    """Angles [rad] from 0 to pi, about one edge apart at a radius [m]."""
    return np.linspace(0.0, np.pi, round(np.pi * radius / edge) + 1)
