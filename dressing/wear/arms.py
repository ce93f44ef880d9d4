"""Arms drawn in while a wide garment is put on, so that a skirt hangs before they come back."""

import numpy as np

from toile.dressing.body.measurements import Measurements
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.geometry.arrays import Bool, Float

STUMP = 0.10
"""Length of the upper arm that stays [m]: an armhole closes around it."""
REACH = 0.25
"""Vertices farther than this from the arm's axis belong to the torso [m]."""
NEAR = 0.12
ELBOW = 0.3
STUMP_TIP = 0.02
THICKNESS_KEPT = 0.5


def drawn_in_arms(vertices: Float, body: Measurements | None, meshes: list[GarmentMesh]) -> Float | None:
    """Vertices with both arms drawn in along their axes, if garments need it; else None.

    They do if a panel that is no sleeve, seen from the front, covers part of an arm. What is left of an arm
    is a short stump, or the length that sleeves cover. `vertices`, shape (v, 3), is the avatar in its start
    shape, `body` what was measured on it. Bodies that could not be measured (None) keep their arms.
    """
    if body is None or not all(mesh.flat for mesh in meshes):
        return None
    drawn = vertices.copy()
    covered = False
    for sign in (1.0, -1.0):
        shoulder = np.array(body.shoulder_point) * [sign, 1.0, 1.0]
        axis = np.array([sign * np.cos(body.arm_angle), -np.sin(body.arm_angle), 0.0])
        stump = max(STUMP, *(_sleeve_reach(mesh, shoulder, axis) + STUMP_TIP for mesh in meshes))
        offset = vertices - shoulder
        along = offset @ axis
        across = offset - along[:, None] * axis
        distance = np.linalg.norm(across, axis=1)
        # Beyond the elbow the arm is far from the hip; before it, only what is near the axis is arm.
        arm = (along > stump) & (distance < REACH) & ((distance < NEAR) | (along > ELBOW))
        arm &= sign * vertices[:, 0] > sign * shoulder[0] - 0.02
        longest = float(along[arm].max(initial=stump))
        length = stump + STUMP_TIP * (along[arm] - stump) / max(longest - stump, 1e-9)
        drawn[arm] = shoulder + length[:, None] * axis + THICKNESS_KEPT * across[arm]
        for mesh in meshes:
            seen = mesh.positions[~on_sleeves(mesh)] - shoulder
            reach = seen @ axis
            beside = np.abs(seen[:, 0] * axis[1] - seen[:, 1] * axis[0])
            covered |= bool(((reach > stump) & (reach < longest) & (beside < 0.5 * NEAR)).any())
    return drawn if covered else None


def on_sleeves(mesh: GarmentMesh) -> Bool:
    """Mark the material vertices of sleeves and cuffs, shape (m,)."""
    sleeves = [index for index, role in enumerate(mesh.panel_roles) if role == "sleeve"]
    marked = np.zeros(len(mesh.positions), bool)
    marked[mesh.faces[np.isin(mesh.panel, sleeves)].ravel()] = True
    return marked


def _sleeve_reach(mesh: GarmentMesh, shoulder: Float, axis: Float) -> float:
    """How far sleeves on the side of this arm reach along it [m]; 0 without sleeves."""
    seen = mesh.positions[on_sleeves(mesh)] - shoulder
    return float((seen[seen[:, 0] * axis[0] > 0.0] @ axis).max(initial=0.0))
