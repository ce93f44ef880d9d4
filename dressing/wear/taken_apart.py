"""Cloth of a whole scene as separate garments, their rigid trims in place."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from toile.dressing.wear.drape_types import DrapedGarment
from toile.dressing.wear.strain import warp_weft_strain
from toile.engine.cloth.cloth import Cloth
from toile.geometry.arrays import Float

if TYPE_CHECKING:
    from toile.dressing.garment.trims import Trims


def taken_apart(cloth: Cloth, trims: Sequence["Trims | None"]) -> list[DrapedGarment]:
    """Take garments apart again, nodes and material vertices renumbered, with the `trims` of each."""
    draped, strain = [], warp_weft_strain(cloth)
    for index, rigid in enumerate(trims):
        own = cloth.garment == index
        vertices, local = np.unique(cloth.faces[own], return_inverse=True)
        nodes, node = np.unique(cloth.node[vertices], return_inverse=True)
        material = local.reshape(-1, 3).astype(np.int32)
        garment = DrapedGarment(
            positions=cloth.positions[nodes],
            faces=node.astype(np.int32)[material],
            faces_material=material,
            uv=cloth.uv[vertices],
            panel=cloth.panel[own],
            velocities=cloth.velocities[nodes],
            origin=None
            if cloth.origin is None
            else cloth.origin.of_garment(index, vertices, np.flatnonzero(own).astype(np.int32)),
            strain=strain[own],
        )
        if rigid is not None:
            garment = _with_trims(garment, rigid, cloth.start_positions[vertices], node)
        draped.append(garment)
    return draped


def _with_trims(garment: DrapedGarment, trims: "Trims", start: Float, node: np.ndarray) -> DrapedGarment:
    """Return a garment with trims; `start` is where its material vertices started, `node` their nodes."""
    assert garment.velocities is not None and garment.strain is not None
    positions = garment.positions[node]
    placed = trims.carried(start, positions)
    speeds = trims.carried(start, positions + garment.velocities[node]) - placed
    return replace(
        garment,
        positions=np.concatenate([garment.positions, placed]),
        faces=np.concatenate([garment.faces, trims.faces + np.int32(len(garment.positions))]),
        faces_material=np.concatenate([garment.faces_material, trims.faces + np.int32(len(garment.uv))]),
        uv=np.concatenate([garment.uv, np.zeros((len(placed), 2))]),
        panel=np.concatenate([garment.panel, trims.panel]).astype(np.int32),
        velocities=np.concatenate([garment.velocities, speeds]),
        origin=None,
        strain=np.concatenate([garment.strain, np.zeros((len(trims.faces), 2))]),
    )
