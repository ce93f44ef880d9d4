"""Arms and their sleeves raised while a garment is sewn whose skirt would close across them.

A flared skirt, still flat, reaches as high as the sleeves hang. Front and back of it would close around the sleeves,
and no seam would ever be free. With the arms level the skirt closes and falls below them; then they come down on it.
"""

from dataclasses import replace

import numpy as np

from toile.dressing.body.measurements import Measurements
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.arms import ELBOW, NEAR, REACH, on_sleeves
from toile.geometry.arrays import Bool, Float, Int

LEVEL = np.radians(5.0)
"""How far below the horizontal arms point that are raised."""
FREE = 0.2
"""How far along the arm panels beside sleeves may reach [m]: the sides of a wide bodice do."""
ROOT = -0.03, 0.10
"""Where along the arm skin begins to turn with it, and where it turns in full [m]."""
SMOOTHING = 12
STAGES = 4
"""Straight ways in which arms come down: one would draw hands 5 cm back through their cuffs."""


def raised_arms(
    vertices: Float, faces: Int, body: Measurements | None, meshes: list[GarmentMesh]
) -> tuple[list[Float], list[GarmentMesh]] | None:
    """Return shapes of the avatar, vertices (v, 3), and the garments with raised sleeves; None if none asks for it.

    A garment asks for it whose sleeves are covered, seen from the front, by panels that are no sleeves. The
    first shape has its arms raised, the next ones lead from there to the given one, without it.
    """
    if body is None or body.arm_angle <= LEVEL or not all(mesh.flat for mesh in meshes):
        return None
    if not any(_covers_sleeves(mesh, body) for mesh in meshes):
        return None
    shapes = [vertices] * STAGES
    positions = [mesh.positions.copy() for mesh in meshes]
    for sign in (1.0, -1.0):
        shoulder, axis = _arm(body, sign)
        angle = sign * (body.arm_angle - LEVEL)
        share = _share(vertices, faces, shoulder, axis, sign)
        shapes = [
            _turned(shape, shoulder, angle * (1.0 - stage / STAGES) * share)
            for stage, shape in enumerate(shapes)
        ]
        for mesh, place in zip(meshes, positions, strict=True):
            own = on_sleeves(mesh) & (sign * mesh.positions[:, 0] > 0.0)
            place[own] = _turned(place[own], shoulder, np.full(int(own.sum()), angle))
    return shapes, [replace(mesh, positions=place) for mesh, place in zip(meshes, positions, strict=True)]


def _arm(body: Measurements, sign: float) -> tuple[Float, Float]:
    """Shoulder point and axis of an arm, the left one for sign 1."""
    shoulder = np.array(body.shoulder_point) * [sign, 1.0, 1.0]
    return shoulder, np.array([sign * np.cos(body.arm_angle), -np.sin(body.arm_angle), 0.0])


def _covers_sleeves(mesh: GarmentMesh, body: Measurements) -> bool:
    """Whether other panels cover sleeves, seen from the front."""
    sleeves = on_sleeves(mesh)
    for sign in (1.0, -1.0):
        shoulder, axis = _arm(body, sign)
        own = mesh.positions[sleeves & (sign * mesh.positions[:, 0] > 0.0)] - shoulder
        other = mesh.positions[~sleeves] - shoulder
        longest = float((own @ axis).max(initial=0.0))
        reach = other @ axis
        beside = np.abs(other[:, 0] * axis[1] - other[:, 1] * axis[0])
        if bool(((reach > FREE) & (reach < longest) & (beside < 0.5 * NEAR)).any()):
            return True
    return False


def _share(vertices: Float, faces: Int, shoulder: Float, axis: Float, sign: float) -> Float:
    """How much of the turn of an arm every vertex takes part in, 0 to 1, shape (v,), smooth over the skin."""
    offset = vertices - shoulder
    along = offset @ axis
    distance = np.linalg.norm(offset - along[:, None] * axis, axis=1)
    near: Bool = (distance < REACH) & ((distance < NEAR) | (along > ELBOW))
    near &= sign * vertices[:, 0] > sign * shoulder[0] - 0.05
    share = np.where(near, np.clip((along - ROOT[0]) / (ROOT[1] - ROOT[0]), 0.0, 1.0), 0.0)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    count = np.maximum(np.bincount(edges[:, 0], minlength=len(vertices)), 1)
    for _ in range(SMOOTHING):
        around = np.bincount(edges[:, 0], weights=share[edges[:, 1]], minlength=len(vertices)) / count
        share = 0.5 * share + 0.5 * around
    return np.asarray(share)


def _turned(points: Float, centre: Float, angle: Float) -> Float:
    """Points (n, 3) turned about the z axis through a centre by angles (n,) [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = points[:, 0] - centre[0], points[:, 1] - centre[1]
    return np.column_stack([centre[0] + c * x - s * y, centre[1] + s * x + c * y, points[:, 2]])
