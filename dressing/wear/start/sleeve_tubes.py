"""Sleeves start rolled around the arms, and clear of the bodice.

Front and back of a sleeve lie between those of the bodice. Flat, they reach in beside the armholes, and the
bodice closes upon them. Rolled about the arm, their edges face each other. The tube lies so that the arm, or
the hand where a cuff lies beyond it, passes the opening of its outer edge, and as far out along the arm as it
must to cut nothing.
"""

from dataclasses import replace

import numpy as np

from toile.collide.rigid_pieces import RigidPieces
from toile.dressing.body.measurements import Measurements
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.arms import on_sleeves
from toile.dressing.wear.start.rings import OPEN, UPRIGHT, WIDER, facing_of, obstacle_of, owner_of, rolled
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected
from toile.geometry.topology import triangle_topology

ARM = 0.12
"""How far from the middle of its sleeve's panels an arm is looked for [m]."""
ROOM = 0.01
"""Room around an arm within the edge of its sleeve [m]."""
HAND = 0.1
"""How far before a tube that no arm reaches into the hand is looked for [m]."""
FAR = 0.1
"""Distance of a sleeve from its armhole from which it is moved in [m]."""
STEP, FARTHEST = 0.01, 0.25
"""Steps in which tubes are moved out along the arm, and how far at most [m]."""


def rolled_sleeves(
    mesh: GarmentMesh, avatar: tuple[Float, Int], body: Measurements | None, arm_angle: float
) -> tuple[GarmentMesh, tuple[str, ...]]:
    """Roll the sleeves of a garment around arms that hang `arm_angle` below the horizontal [rad].

    Sleeves of a front and a back are rolled, cuffs by themselves; where the body is in the way, wider.
    Returns the garment and one sentence for each tube.
    """
    sleeve = on_sleeves(mesh)
    if body is None or not mesh.flat or not sleeve.any() or not len(mesh.stitches):
        return mesh, ()
    owner, facing = owner_of(mesh), facing_of(mesh)
    count = len(mesh.panel_names)
    is_sleeve = np.zeros(count, bool)
    is_sleeve[owner[sleeve]] = True
    is_sleeve &= np.abs(facing) > UPRIGHT
    ends = mesh.stitches[is_sleeve[owner[mesh.stitches]].all(axis=1)]
    across = owner[ends]
    across = across[facing[across[:, 0]] * facing[across[:, 1]] < 0.0]
    tube = connected(across, count)
    positions, obstacle = mesh.positions.copy(), obstacle_of(avatar)
    notes = []
    rolled_panels = np.zeros(count, bool)
    for number in np.unique(tube[across.ravel()]):
        panels = is_sleeve & (tube == number)
        own = panels[owner]
        side = 1.0 if positions[own, 0].mean() > 0.0 else -1.0
        axis = np.array([side * np.cos(arm_angle), -np.sin(arm_angle)])
        found = _rolled(
            mesh, positions, panels, np.sign(facing), axis, float(body.shoulder_point[2]), avatar[0], obstacle
        )
        if found is None:
            continue
        positions = found
        rolled_panels |= panels
        names = ", ".join(np.array(mesh.panel_names)[panels])
        notes.append(f"garment {mesh.name}: {names} start rolled around the arm")
    for side in (1.0, -1.0):
        axis = np.array([side * np.cos(arm_angle), -np.sin(arm_angle), 0.0])
        panels = rolled_panels & (side * np.bincount(owner, positions[:, 0], count) > 0.0)
        if panels.any():
            positions[panels[owner]] += _way_along(mesh, positions, panels, obstacle, axis)
    return (replace(mesh, positions=positions), tuple(notes)) if notes else (mesh, ())


def _rolled(
    mesh: GarmentMesh, positions: Float, panels: Bool, facing: Float, axis: Float, depth: float,
    body: Float, obstacle: RigidPieces,
) -> Float | None:  # fmt: skip
    """Positions with the panels of a tube rolled about a direction (x, y); None if the body is in the way."""
    owner = owner_of(mesh)
    own = panels[owner]
    across = np.array([-axis[1], axis[0]])
    t = positions[:, :2] @ across
    widths = [float(np.ptp(t[owner == panel])) for panel in np.flatnonzero(panels)]
    front = max(w for w, panel in zip(widths, np.flatnonzero(panels), strict=True) if facing[panel] > 0.0)
    back = max(w for w, panel in zip(widths, np.flatnonzero(panels), strict=True) if facing[panel] < 0.0)
    radius = OPEN * (front + back) / (2.0 * np.pi)
    middle = 0.5 * float(t[own].min() + t[own].max())
    (across_arm, depth), thickness = _arm(body, axis, positions[own][:, :2] @ axis, (middle, depth))
    opening = t[_outer_edge(mesh, panels, positions[:, :2] @ axis)]
    faces = mesh.faces[panels[mesh.panel]]
    for factor in WIDER:
        trial = positions.copy()
        aside = off_opening(opening - middle, factor * radius, 0.5 * thickness)
        centre = across_arm - aside, depth
        trial[own] = rolled(positions[own], facing[owner[own]], factor * radius, axis, middle, centre)
        if not obstacle.surface_crosses_avatar(trial, faces):
            return trial
    return None


def _arm(
    body: Float, axis: Float, along: Float, near: tuple[float, float]
) -> tuple[tuple[float, float], float]:
    """Middle of an arm across its direction and in depth, and its thickness [m], in a tube's outer half."""
    t, s = body[:, :2] @ np.array([-axis[1], axis[0]]), body[:, :2] @ axis
    beside = (np.abs(t - near[0]) < ARM) & (np.abs(body[:, 2] - near[1]) < ARM) & (s < along.max())
    own = beside & (s > 0.5 * (along.min() + along.max()))
    if not own.any():
        # It lies beyond the fingers, and is moved in over them.
        own = beside & (s > along.min() - HAND)
    if not own.any():
        return near, 0.0
    low, high = float(t[own].min()), float(t[own].max())
    return (0.5 * (low + high), 0.5 * float(body[own, 2].min() + body[own, 2].max())), high - low


def _outer_edge(mesh: GarmentMesh, panels: Bool, along: Float) -> Bool:
    """Mark the vertices of a tube's edge towards the hand, shape (m,): a hem, or what a cuff is sewn to.

    `along` is how far along the arm every vertex lies [m], shape (m,).
    """
    owner = owner_of(mesh)
    own = panels[owner]
    marked = np.zeros(len(own), bool)
    marked[triangle_topology(mesh.faces).border_edges.ravel()] = True
    marked[mesh.stitches.ravel()] = False
    ends = mesh.stitches[own[mesh.stitches].sum(axis=1) == 1]
    mine = np.where(own[ends[:, 0]], ends[:, 0], ends[:, 1])
    other = owner[np.where(own[ends[:, 0]], ends[:, 1], ends[:, 0])]
    middle = np.bincount(owner, along, len(panels)) / np.maximum(np.bincount(owner, minlength=len(panels)), 1)
    marked[mine[on_sleeves(mesh)[mine] & (middle[other] > middle[owner[mine]])]] = True
    return marked & own


def off_opening(opening: Float, radius: float, half: float) -> float:
    """How far the middle of a rolled edge lies from the middle of its tube [m], if an arm is outside of it.

    `opening` is where the points of the edge lie across the tube while that is flat [m], shape (k,). A sleeve
    that narrows much has its opening on one side of the tube, and the arm would lie in the gap of its
    underarm seam. 0 where an arm in the middle, `half` as wide to either side [m], passes the opening.
    """
    if not len(opening):
        return 0.0
    across = radius * np.sin(np.clip(opening / radius, -0.5 * np.pi, 0.5 * np.pi))
    low, high = float(across.min()), float(across.max())
    return 0.0 if low < -half - ROOM and high > half + ROOM else 0.5 * (low + high)


def _way_along(
    mesh: GarmentMesh, positions: Float, panels: Bool, obstacle: RigidPieces, axis: Float
) -> Float:
    """Shortest shift along an arm [m], shape (3,), after which its tubes cut neither body nor panels.

    Tubes far out start farther in, where the armhole's edges meet: they would be dragged in along the arm
    while their own seams still close.
    """
    faces = mesh.faces[panels[mesh.panel]]
    own = panels[owner_of(mesh)]
    between = own[mesh.stitches].sum(axis=1) == 1
    ends = mesh.stitches[between & ~on_sleeves(mesh)[mesh.stitches].all(axis=1)]
    inner = own[ends]
    gap = (positions[ends[inner]] - positions[ends[~inner]]) @ axis
    far = float(gap.mean()) - ROOM if len(gap) else 0.0
    pieces = RigidPieces(positions, mesh.faces, panels[mesh.panel].astype(np.int32), None)
    for distance in np.arange(-STEP * int(far / STEP) if far > FAR else 0.0, FARTHEST, STEP):
        shift = distance * axis
        if not pieces.crosses_pieces(1, shift) and not obstacle.surface_crosses_avatar(
            positions + shift, faces
        ):
            return np.asarray(shift)
    return np.zeros(3)
