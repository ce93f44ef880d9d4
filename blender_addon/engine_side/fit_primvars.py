"""How a garment fits, as attributes of its points: strain in every frame, all maps in the last one."""

import numpy as np

from toile.blender_addon.engine_side.usd_frame import Primvar
from toile.dressing.fit.fit_maps import PERCENT, GarmentFit
from toile.dressing.run.result import DressedGarment
from toile.geometry.arrays import Float

STRAIN = ("stretch_warp_percent", "stretch_weft_percent")


def strain_primvars(garment: DressedGarment) -> list[Primvar]:
    """Return strain along warp and weft [%] at the nodes of a garment: means of the faces around."""
    if garment.strain is None:
        return []
    sides = garment.positions[garment.faces[:, 1:]] - garment.positions[garment.faces[:, :1]]
    weight = np.repeat(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1), 3)
    nodes, count = garment.faces.ravel(), len(garment.positions)
    area = np.maximum(np.bincount(nodes, weight, count), 1e-300)
    return [
        _of_points(name, np.bincount(nodes, weight * np.repeat(strain, 3), count) / area)
        for name, strain in zip(STRAIN, PERCENT * garment.strain.T, strict=True)
    ]


def fit_primvars(maps: GarmentFit, garment: DressedGarment) -> list[Primvar]:
    """Return all maps at the nodes of a garment: means of its material vertices there, zero on trims."""
    count = len(garment.positions)
    vertices = np.maximum(np.bincount(maps.node, minlength=count), 1)
    return [
        _of_points(name, np.bincount(maps.node, values, count) / vertices)
        for name, values in maps.at_vertices.items()
    ]


def _of_points(name: str, values: Float) -> Primvar:
    return Primvar(name, "POINT", "FLOAT", values)
