"""Sleeves start rolled around the arms, and clear of the bodice.

Front and back of a sleeve lie between those of the bodice. Flat, they reach in beside the armholes, and the
bodice closes upon them. Rolled about the arm, their edges face each other, and the tube is moved out along
the arm until it cuts nothing.
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

ARM = 0.12
"""How far from the middle of its sleeve's panels an arm is looked for [m]."""
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
            positions[panels[owner]] += _way_out(mesh, positions, panels, obstacle, axis)
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
    centre = _arm_centre(body, axis, positions[own][:, :2] @ axis, (middle, depth))
    faces = mesh.faces[panels[mesh.panel]]
    for factor in WIDER:
        trial = positions.copy()
        trial[own] = rolled(positions[own], facing[owner[own]], factor * radius, axis, middle, centre)
        if not obstacle.surface_crosses_avatar(trial, faces):
            return trial
    return None


def _arm_centre(body: Float, axis: Float, along: Float, near: tuple[float, float]) -> tuple[float, float]:
    """Middle of an arm across its direction and in depth [m], along the outer half of a tube."""
    t, s = body[:, :2] @ np.array([-axis[1], axis[0]]), body[:, :2] @ axis
    own = (s > 0.5 * (along.min() + along.max())) & (s < along.max())
    own &= (np.abs(t - near[0]) < ARM) & (np.abs(body[:, 2] - near[1]) < ARM)
    if not own.any():
        return near
    return 0.5 * float(t[own].min() + t[own].max()), 0.5 * float(body[own, 2].min() + body[own, 2].max())


def _way_out(mesh: GarmentMesh, positions: Float, panels: Bool, obstacle: RigidPieces, axis: Float) -> Float:
    """Shortest shift along an arm [m], shape (3,), after which tubes cut neither body nor panels."""
    faces = mesh.faces[panels[mesh.panel]]
    pieces = RigidPieces(positions, mesh.faces, panels[mesh.panel].astype(np.int32), None)
    for distance in np.arange(0.0, FARTHEST, STEP):
        shift = distance * axis
        if not pieces.crosses_pieces(1, shift) and not obstacle.surface_crosses_avatar(
            positions + shift, faces
        ):
            return np.asarray(shift)
    return np.zeros(3)
