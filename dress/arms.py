"""Arms drawn in while a garment without sleeves is put on: a wide skirt then hangs before they come back."""

import numpy as np

from toile.dress.avatar import Avatar
from toile.dress.garment_mesh import GarmentMesh
from toile.dress.measure import measure
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

STUMP = 0.10
"""Length of the upper arm that stays [m]: an armhole closes around it."""
REACH = 0.25
"""Vertices farther than this from the arm's axis belong to the torso [m]."""
NEAR = 0.12
ELBOW = 0.3
STUMP_TIP = 0.02
THICKNESS_KEPT = 0.5


def drawn_in_arms(vertices: Float, avatar: Avatar, meshes: list[GarmentMesh]) -> Float | None:
    """Vertices with both arms drawn in along their axes to short stumps, if garments need it; else None.

    They do if none has sleeves and a panel, seen from the front, covers part of an arm. `vertices`, shape
    (v, 3), is the avatar in its start shape. Bodies that cannot be measured (sitting, arms up) keep
    their arms.
    """
    for mesh in meshes:
        if not mesh.flat or any("sleeve" in name or name.startswith("sl_") for name in mesh.panel_names):
            return None
    try:
        body = measure(avatar)
    except InputError:
        return None
    drawn = vertices.copy()
    covered = False
    for sign in (1.0, -1.0):
        shoulder = np.array(body.shoulder_point) * [sign, 1.0, 1.0]
        axis = np.array([sign * np.cos(body.arm_angle), -np.sin(body.arm_angle), 0.0])
        offset = vertices - shoulder
        along = offset @ axis
        across = offset - along[:, None] * axis
        distance = np.linalg.norm(across, axis=1)
        # Beyond the elbow the arm is far from the hip; before it, only what is near the axis is arm.
        arm = (along > STUMP) & (distance < REACH) & ((distance < NEAR) | (along > ELBOW))
        arm &= sign * vertices[:, 0] > sign * shoulder[0] - 0.02
        longest = float(along[arm].max(initial=STUMP))
        length = STUMP + STUMP_TIP * (along[arm] - STUMP) / max(longest - STUMP, 1e-9)
        drawn[arm] = shoulder + length[:, None] * axis + THICKNESS_KEPT * across[arm]
        for mesh in meshes:
            seen = mesh.positions - shoulder
            reach = seen @ axis
            beside = np.abs(seen[:, 0] * axis[1] - seen[:, 1] * axis[0])
            covered |= bool(((reach > STUMP) & (reach < longest) & (beside < 0.5 * NEAR)).any())
    return drawn if covered else None
