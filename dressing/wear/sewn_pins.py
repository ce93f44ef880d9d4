"""When the pins of garments take hold: at the start, or once seams are closed."""

import numpy as np

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.geometry.arrays import Bool, Int


def pins_in_time(meshes: list[GarmentMesh], pins: tuple[Int, ...]) -> tuple[list[Int], Bool | None]:
    """Return the pins of every garment that hold from the start, and a mask of those that do once it is sewn.

    Panels that are to be sewn must move: their pins hold later. The mask is that of all material vertices,
    shape (m,), or None.
    """
    none = np.empty(0, np.int32)
    at_once = [none if is_sewn_up(mesh) else own for mesh, own in zip(meshes, pins, strict=False)]
    masks = [np.zeros(len(mesh.positions), bool) for mesh in meshes]
    for mesh, mask, own in zip(meshes, masks, pins, strict=False):
        mask[own] = is_sewn_up(mesh)
    later: Bool = np.concatenate(masks)
    return at_once, later if later.any() else None


def is_sewn_up(mesh: GarmentMesh) -> bool:
    """Whether a garment has seams that are open at the start."""
    ends = mesh.positions[mesh.stitches.reshape(-1, 2)]
    return bool((np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) > 1e-9).any())
