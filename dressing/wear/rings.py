"""Rings of upright panels start rolled around the body's axis: collars, and tiers that are wider than the body.

Such panels lie in front of and behind the body, and their seams close a ring: flat, a collar's strips reach far
beside the neck, and a gathered tier is crowded into the middle. Rolled about a vertical axis, as a cylinder of the
ring's length, every panel keeps its shape, and the edges of partners face each other.
"""

from dataclasses import dataclass, replace

import numpy as np

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.normals import area_normals

OPEN = 1.04
"""Circumference of a ring over the width of its panels: their edges start apart."""
UPRIGHT = 0.98
"""Least share of a panel's normal towards front or back."""
COLLAR = 0.12
"""Height of a panel above the shoulders that is a collar, at most [m]; hoods are higher."""
WIDE = 0.25
"""Least radius of the ring of a tier [m]: smaller ones may not clear the hips."""
CURLED = 1.02
"""Length of a panel's upper seam over the distance of its ends up to which it is rolled: it is no flare."""


@dataclass(frozen=True)
class Ring:
    """Panels of a ring, marked (p,), its radius [m], and whether it is a collar."""

    panels: Bool
    radius: float
    collar: bool


def rolled_rings(mesh: GarmentMesh, body: Float, shoulder: float) -> tuple[GarmentMesh, tuple[str, ...]]:
    """Roll the rings of a garment around a body, vertices (v, 3) [m], whose shoulders are at a height [m].

    Returns the garment and one sentence for each ring.
    """
    if not mesh.flat or not len(mesh.stitches):
        return mesh, ()
    owner = np.zeros(len(mesh.positions), np.int32)
    owner[mesh.faces.ravel()] = np.repeat(mesh.panel, 3)
    positions = mesh.positions.copy()
    notes = []
    for ring in _rings(mesh, owner, shoulder):
        own = ring.panels[owner]
        level = positions[own, 1]
        there = body[
            (body[:, 1] > level.min()) & (body[:, 1] < level.max()) & (np.abs(body[:, 0]) < ring.radius)
        ]
        depth = (
            float(there[:, 2].min() + there[:, 2].max()) / 2.0
            if len(there)
            else float(positions[own, 2].mean())
        )
        facing = np.sign(_facing(mesh))[owner[own]]
        positions[own] = rolled(positions[own], facing, ring.radius, depth)
        names = ", ".join(np.array(mesh.panel_names)[ring.panels])
        notes.append(f"garment {mesh.name}: {names} start rolled around the body")
    return (replace(mesh, positions=positions), tuple(notes)) if notes else (mesh, ())


def rolled(points: Float, facing: Float, radius: float, depth: float) -> Float:
    """Bend upright panels, points (n, 3) [m], about the vertical axis at x = 0 and a depth [m].

    `facing` is 1 in front of the body and -1 behind it, shape (n,). Lengths along the panels stay what they are.
    """
    angle = points[:, 0] / radius
    return np.column_stack([radius * np.sin(angle), points[:, 1], depth + facing * radius * np.cos(angle)])


def _rings(mesh: GarmentMesh, owner: Int, shoulder: float) -> list[Ring]:
    """Find the rings of a garment: what closes around the body by seams between front and back on both sides."""
    count = len(mesh.panel_names)
    facing = _facing(mesh)
    upright = np.abs(facing) > UPRIGHT
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, owner, mesh.positions)
    np.maximum.at(high, owner, mesh.positions)
    collar = upright & (low[:, 1] > shoulder) & (high[:, 1] - low[:, 1] < COLLAR)
    found = []
    if collar.any():
        found.append(_ring(collar, low, high, True))
    ends = owner[mesh.stitches]
    for seam in np.unique(mesh.seam):
        one, other = ends[mesh.seam == seam][0].tolist()
        pair = np.zeros(count, bool)
        pair[[one, other]] = True
        if (
            one == other
            or facing[one] * facing[other] > 0.0
            or not upright[pair].all()
            or (high[pair, 1] > shoulder).any()
        ):
            continue
        sides = mesh.positions[mesh.stitches[pair[ends].all(axis=1)]][:, :, 0].mean(axis=1)
        straight = all(_curl(mesh, owner, ends, panel) < CURLED for panel in (one, other))
        both = (low[pair, 0] < 0.0).all() and (high[pair, 0] > 0.0).all() and sides.min() < 0.0 < sides.max()
        ring = _ring(pair, low, high, False)
        if both and straight and ring.radius > WIDE and not any((r.panels & pair).any() for r in found):
            found.append(ring)
    return [
        ring for ring in found if (low[ring.panels, 0] < 0.0).any() and (high[ring.panels, 0] > 0.0).any()
    ]


def _ring(panels: Bool, low: Float, high: Float, collar: bool) -> Ring:
    width = float((high[panels, 0] - low[panels, 0]).sum())
    return Ring(panels, OPEN * width / (2.0 * np.pi), collar)


def _curl(mesh: GarmentMesh, owner: Int, ends: Int, panel: int) -> float:
    """Largest length over the distance of their ends of a panel's seams to panels that lie above or below."""
    worst = 1.0
    for seam in np.unique(mesh.seam):
        pairs = mesh.stitches[mesh.seam == seam]
        if len(pairs) < 3 or (owner[pairs[0]] != panel).all() or owner[pairs[0, 0]] == owner[pairs[0, 1]]:
            continue
        line = mesh.positions[pairs[:, 0] if owner[pairs[0, 0]] == panel else pairs[:, 1], :2]
        length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
        worst = max(worst, float(length / max(float(np.linalg.norm(line[-1] - line[0])), 1e-9)))
    return worst


def _facing(mesh: GarmentMesh) -> Float:
    """Front (+) or back (-) part of every panel's unit normal, shape (p,)."""
    normal = np.zeros((len(mesh.panel_names), 3))
    np.add.at(normal, mesh.panel, area_normals(mesh.positions[mesh.faces]))
    return np.asarray(normal[:, 2] / np.maximum(np.linalg.norm(normal, axis=1), 1e-300))
