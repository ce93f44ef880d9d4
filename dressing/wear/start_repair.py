"""Repair of a start in which flat panels cut the body or each other: whole panels are moved clear.

A garment whose seams would have to close through the body (shoulder seams that start below the shoulder)
is lifted first, so that they close above it.

Panels are rigid until sewing begins, so a panel that cuts something is shifted, by the shortest way found,
along its own outward normal (any pattern puts its panels around the body), or failing that along other axes.
"""

from dataclasses import replace

import numpy as np

from toile.collide.rigid_pieces import RigidPieces
from toile.collide.segments import SegmentTest
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.arms import on_sleeves
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.errors import InputError
from toile.geometry.normals import area_normals

STEP = 0.01
FARTHEST = 0.8
CLEARANCE = 0.01
ROUNDS = 6
LIFT_STEP = 0.01
HIGHEST_LIFT = 0.15
LIFT_CLEARANCE = 0.015
HEADROOM = 0.05
WORTH = 2.0
SHOULDER_REACH = 0.25


def clear_panels(
    meshes: list[GarmentMesh], avatar: tuple[Float, Int] | None, unit: float = 1.0
) -> tuple[list[GarmentMesh], tuple[str, ...]]:
    """Shift panels of flat garments until none cuts the avatar or another panel of any garment.

    Returns the garments and one sentence per panel that moved; `unit` is how many metres a unit of length is.

    Raises
    ------
    InputError
        A panel cannot be cleared within FARTHEST; the message names it.
    """
    flat = [mesh for mesh in meshes if mesh.flat]
    if not flat:
        return meshes, ()
    names = [(mesh, name) for mesh in flat for name in mesh.panel_names]
    first_panel = np.cumsum([0] + [len(mesh.panel_names) for mesh in flat])
    first_vertex = np.cumsum([0] + [len(mesh.positions) for mesh in flat])
    positions = np.concatenate([mesh.positions for mesh in flat])
    faces = np.concatenate([mesh.faces + first for mesh, first in zip(flat, first_vertex, strict=False)])
    panel = np.concatenate([mesh.panel + first for mesh, first in zip(flat, first_panel, strict=False)])
    pieces = RigidPieces(positions, faces, panel, avatar)
    corners = [positions[faces[panel == index]] for index in range(len(names))]
    middle = 0.0 if avatar is None else float(avatar[0][:, 2].mean())
    # Outermost first: they have room to give way.
    order = sorted(range(len(names)), key=lambda index: -abs(float(corners[index][..., 2].mean()) - middle))
    for _ in range(ROUNDS):
        changed = False
        for index in order:
            zero = np.zeros(3)
            if not pieces.crosses_avatar(index, zero) and not pieces.crosses_pieces(index, zero):
                continue
            shift = _clearing_shift(pieces, index, _outward(corners[index]))
            if shift is None:
                mesh, name = names[index]
                raise InputError(
                    f"garment {mesh.name}: panel {name} cuts the body or another panel and cannot be "
                    f"moved clear within {FARTHEST * unit:.2g} m; move its translation in the pattern "
                    "farther out",
                    field=f"pattern.panels.{name}.translation",
                    garment=mesh.name,
                )
            pieces.shift[index] += shift
            changed = True
        if not changed:
            break
    zero = np.zeros(3)
    for index in order:
        if pieces.crosses_avatar(index, zero) or pieces.crosses_pieces(index, zero):
            mesh, name = names[index]
            raise InputError(
                f"garment {mesh.name}: panel {name} cuts the body or other panels however they are shifted; "
                "place the panels farther apart in the pattern",
                field=f"pattern.panels.{name}.translation",
                garment=mesh.name,
            )
    distance = np.linalg.norm(pieces.shift, axis=1)
    notes = tuple(
        f"garment {names[index][0].name}: panel {names[index][1]} cut the body or another panel and starts "
        f"{distance[index] * unit * 100:.0f} cm farther out"
        for index in np.flatnonzero(distance > 0.0)
    )
    owner = np.zeros(len(positions), np.int32)
    owner[faces.ravel()] = np.repeat(panel, 3)
    moved = positions + pieces.shift[owner]
    done = iter(
        replace(mesh, positions=moved[first : first + len(mesh.positions)])
        for mesh, first in zip(flat, first_vertex, strict=False)
    )
    return [next(done) if mesh.flat else mesh for mesh in meshes], notes


def lift_over_shoulders(
    mesh: GarmentMesh, avatar: tuple[Float, Int] | None, shoulder: float = -np.inf, unit: float = 1.0
) -> tuple[GarmentMesh, tuple[str, ...]]:
    """Lift a garment where that frees enough seam that runs through the avatar; say how far.

    `unit` is how many metres a unit of length is.

    Every stretch of seam that is freed is worth a lift of WORTH times its length. Seams more than
    SHOULDER_REACH below the height of the shoulders [m] give no reason to lift, but may be a reason not to.
    """
    if avatar is None or not mesh.flat or not len(mesh.stitches):
        return mesh, ()
    test = SegmentTest(avatar)
    start, end = mesh.positions[mesh.stitches[:, 0]], mesh.positions[mesh.stitches[:, 1]]
    spacing = float(np.median(np.linalg.norm(np.diff(start, axis=0), axis=1)))

    def blocked(lift: float) -> Bool:
        """Mark stitches that run through the body at this lift, or less than HEADROOM above it."""
        up, below = np.array([0.0, lift, 0.0]), np.array([0.0, lift - HEADROOM, 0.0])
        return np.asarray(test.crossing(start + up, end + up) | test.crossing(start + below, end + below))

    low = np.minimum(start[:, 1], end[:, 1]) < shoulder - SHOULDER_REACH
    # Sleeves find the arms when they are rolled.
    counted = ~(low & blocked(0.0)) & ~on_sleeves(mesh)[mesh.stitches].all(axis=1)

    def cost(lift: float) -> float:
        return WORTH * spacing * float((blocked(lift) & counted).sum()) + lift

    lifts = np.arange(0.0, HIGHEST_LIFT, LIFT_STEP)
    best = float(lifts[np.argmin([cost(float(lift)) for lift in lifts])])
    if best == 0.0:
        return mesh, ()
    best += LIFT_CLEARANCE
    note = (
        f"garment {mesh.name} starts {best * unit * 100:.0f} cm higher so that its seams close over the body"
    )
    return replace(mesh, positions=mesh.positions + np.array([0.0, best, 0.0])), (note,)


def _outward(corners: Float) -> Float:
    """Return the unit normal of a flat panel's faces (t, 3, 3), on the right side, away from the body."""
    normal = area_normals(corners).sum(axis=0)
    return np.asarray(normal / np.linalg.norm(normal))


def _clearing_shift(pieces: RigidPieces, index: int, normal: Float) -> Float | None:
    """Shortest shift along a few directions after which the panel cuts nothing; None if there is none."""
    side = np.array([0.0, 0.0, 1.0 if normal[2] >= 0.0 else -1.0])
    across = np.array([1.0 if normal[0] >= 0.0 else -1.0, 0.0, 0.0])
    for directions in ([normal, side], [across, -across, np.array([0.0, 1.0, 0.0]), -normal]):
        for distance in np.arange(STEP, FARTHEST, STEP):
            for direction in directions:
                shift = direction * distance
                if not pieces.crosses_avatar(index, shift) and not pieces.crosses_pieces(index, shift):
                    return np.asarray(direction * (distance + CLEARANCE))
    return None
