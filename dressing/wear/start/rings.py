"""Bodices and collars start rolled around the body's axis.

Their panels lie in front of and behind the body, and their seams close a ring: flat, a collar's strips reach
far beside the neck, and a bodice closes upon the sleeves between its front and back. Rolled about a vertical
axis, as a cylinder of the ring's length, every panel keeps its shape, and partners' edges face each other.
"""

from dataclasses import dataclass, replace

import numpy as np

from toile.collide.rigid_pieces import RigidPieces
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.arms import on_sleeves
from toile.dressing.wear.layer_order import CURLED, curl
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.normals import area_normals

BELOW = 0.1
"""How far below the shoulders panels may end that hang from them [m]."""
UP = np.array([0.0, 1.0])
OPEN = 1.04
"""Circumference of a ring over the width of its panels: their edges start apart."""
WIDER = 1.0, 1.1, 1.2, 1.35, 1.5, 1.75
"""Factors on the radius of a ring, the next where the body is in its way."""
OVERLAP = 0.02
"""How far panels of a bodice may overlap at its front and back together [m]: what buttons up stays flat."""
UPRIGHT = 0.98
"""Least share of a panel's normal towards front or back."""
COLLAR = 0.12
"""Height of a panel above the shoulders that is a collar, at most [m]; hoods are higher."""
BODICE_OPEN, BODICE = 1.1, 0.27
"""The same of a bodice, which shoulders and bust need room in; largest radius of its ring [m]: one with
sleeves cut on stays flat."""


@dataclass(frozen=True)
class Ring:
    """Panels of a ring, marked (p,), and its radius [m]."""

    panels: Bool
    radius: float


def rolled_rings(
    mesh: GarmentMesh, avatar: tuple[Float, Int], shoulder: float, unit: float = 1.0
) -> tuple[GarmentMesh, tuple[str, ...]]:
    """Roll the rings of a garment around a body, vertices (v, 3) [m] and faces, shoulders at a height [m].

    A ring starts as narrow as its panels allow and the body is clear of it; it stays flat where it never is.
    Returns the garment and one sentence for each ring; `unit` is how many metres a unit of length is.
    """
    if not mesh.flat or not len(mesh.stitches) or not np.isfinite(shoulder):
        return mesh, ()
    body, obstacle = avatar[0], obstacle_of(avatar)
    owner = owner_of(mesh)
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
        facing = np.sign(facing_of(mesh))[owner[own]]
        faces = mesh.faces[ring.panels[mesh.panel]]
        for factor in WIDER:
            trial = positions.copy()
            trial[own] = rolled(positions[own], facing, factor * ring.radius, UP, 0.0, (0.0, depth))
            if not obstacle.surface_crosses_avatar(trial, faces):
                break
        else:
            continue
        positions = trial
        names = ", ".join(np.array(mesh.panel_names)[ring.panels])
        notes.append(
            f"garment {mesh.name}: {names} start rolled around the body, "
            f"{100.0 * unit * factor * ring.radius:.0f} cm from its middle"
        )
    return (replace(mesh, positions=positions), tuple(notes)) if notes else (mesh, ())


def rolled(
    points: Float, facing: Float, radius: float, axis: Float, middle: float, centre: tuple[float, float]
) -> Float:
    """Bend upright panels, points (n, 3) [m], to cylinders about a line, front and back on opposite sides.

    The line runs along `axis`, a unit vector (x, y); its `centre` is how far to the left of the origin it
    runs, and its depth z [m]. `middle` is what of the panels comes to lie before and behind it, in the same
    measure. `facing` is 1 for points of front panels and -1 for those of back ones, shape (n,). Lengths along
    the panels stay what they are.
    """
    across = np.array([-axis[1], axis[0]])
    angle = (points[:, :2] @ across - middle) / radius
    along = points[:, :2] @ axis
    flat = along[:, None] * axis + (centre[0] + radius * np.sin(angle))[:, None] * across
    return np.column_stack([flat, centre[1] + facing * radius * np.cos(angle)])


def _rings(mesh: GarmentMesh, owner: Int, shoulder: float) -> list[Ring]:
    """Find the rings of a garment: its collar and its bodice."""
    count = len(mesh.panel_names)
    facing = facing_of(mesh)
    upright = np.abs(facing) > UPRIGHT
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, owner, mesh.positions)
    np.maximum.at(high, owner, mesh.positions)
    found = []
    collar = upright & (low[:, 1] > shoulder) & (high[:, 1] - low[:, 1] < COLLAR)
    if collar.any():
        width = float((high[collar, 0] - low[collar, 0]).sum())
        found.append(Ring(collar, OPEN * width / (2.0 * np.pi)))
    bodice = upright & (high[:, 1] >= shoulder - BELOW) & ~collar
    bodice[owner[on_sleeves(mesh)]] = False
    sides = [bodice & (side * facing > 0.0) for side in (1.0, -1.0)]
    if all(side.any() for side in sides):
        width = sum(float(high[side, 0].max() - low[side, 0].min()) for side in sides)
        ring = Ring(bodice, BODICE_OPEN * width / (2.0 * np.pi))
        overlap = float((high[bodice, 0] - low[bodice, 0]).sum()) - width
        ends = owner[mesh.stitches]
        other = ~bodice[ends] & ~on_sleeves(mesh)[mesh.stitches] & ~collar[ends]
        flared = is_flared(mesh, other.any(axis=1) & bodice[ends].any(axis=1), other)
        if ring.radius < BODICE and overlap < OVERLAP and not flared:
            found.append(ring)
    return [
        ring for ring in found if (low[ring.panels, 0] < 0.0).any() and (high[ring.panels, 0] > 0.0).any()
    ]


def is_flared(mesh: GarmentMesh, joins: Bool, own: Bool) -> bool:
    """Whether panels, marked at the ends of stitches (s, 2), have a curled edge at the `joins` (s,) together.

    The edge of a panel may be cut into several seams, each of them almost straight.
    """
    vertices = np.unique(mesh.stitches[joins][own[joins]])
    panel = owner_of(mesh)[vertices]
    for number in np.unique(panel):
        line = mesh.uv[vertices[panel == number]]
        if curl(line[np.argsort(line[:, 0], kind="stable")]) > CURLED:
            return True
    return False


def obstacle_of(avatar: tuple[Float, Int]) -> RigidPieces:
    """Return an avatar as an obstacle to surfaces."""
    return RigidPieces(np.empty((0, 3)), np.empty((0, 3), np.int32), np.empty(0, np.int32), avatar)


def owner_of(mesh: GarmentMesh) -> Int:
    """Panel of every material vertex, shape (m,)."""
    owner = np.zeros(len(mesh.positions), np.int32)
    owner[mesh.faces.ravel()] = np.repeat(mesh.panel, 3)
    return owner


def facing_of(mesh: GarmentMesh) -> Float:
    """Front (+) or back (-) part of every panel's unit normal, shape (p,)."""
    normal = np.zeros((len(mesh.panel_names), 3))
    np.add.at(normal, mesh.panel, area_normals(mesh.positions[mesh.faces]))
    return np.asarray(normal[:, 2] / np.maximum(np.linalg.norm(normal, axis=1), 1e-300))
