"""Room for cloth between closed parts of a body that touch: their skins give way, as they do in films."""

from collections.abc import Sequence

import numpy as np

from toile.collide.skins.skin_slots import SkinSlots
from toile.dressing.body.dress_form import DressForm
from toile.dressing.garment.garment_mesh import GarmentMesh

AROUND = 0.1
"""Skin this far above or below the garments still has cloth near it as they settle [m]."""
ROOM = 0.006
"""Room for cloth at rest [m]: little, so that what arms or legs hold stays held. Films make more."""
NOTABLE = 1e-3
"""Skins that give way by less are not worth a sentence [m]."""


def skins_apart(form: DressForm, garments: Sequence[GarmentMesh]) -> tuple[DressForm, str | None]:
    """Return a body with its closed parts apart at the height of garments, and a sentence that says so.

    Only bodies in motion have parts that are not united, and obstacles are never united with a body. Where
    these touch from the first frame on, cloth between them would have no place. The same form comes back
    where nothing touches.
    """
    body = form.avatar
    apart = bool(body.obstacles) or (body.solid is not None and body.motion is not None)
    if not apart or not garments:
        return form, None
    heights = np.concatenate([mesh.positions[:, 1] for mesh in garments])
    level = body.vertices[:, 1]
    near = (level > heights.min() - AROUND) & (level < heights.max() + AROUND)
    retreat = SkinSlots(body.vertices, body.faces).retreat(body.vertices, near, ROOM)
    depth = np.linalg.norm(retreat, axis=1)
    if not depth.any():
        return form, None
    deepest = int(depth.argmax())
    said = None
    if depth[deepest] > NOTABLE:
        x, y, z = form.place.outward(body.vertices[deepest])
        said = (
            f"its parts touch in the first frame: skins give way by up to {1e3 * depth[deepest]:.0f} mm, "
            f"near ({x:.2f}, {y:.2f}, {z:.2f}) m, so that cloth has room between them"
        )
    return form.with_skin(body.vertices + retreat), said
