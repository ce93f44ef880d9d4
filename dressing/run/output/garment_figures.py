"""Figures of a garment for the report: strain along warp and weft by panel, and where it is largest."""

from typing import Any

import numpy as np

from toile.dressing.run.result import DressedGarment
from toile.geometry.arrays import Bool, Float
from toile.geometry.normals import area_normals

SHARES = {"median": 0.5, "p95": 0.95}


def strain_figures(garment: DressedGarment) -> dict[str, Any]:
    """Return the strain of a garment and of its panels; nothing where it is not known.

    Quantiles are by area; places are in the room [m], Y up.
    """
    if garment.strain is None:
        return {}
    corners = garment.positions[garment.faces]
    area = 0.5 * np.linalg.norm(area_normals(corners), axis=1)
    middle = corners.mean(axis=1)
    every = np.ones(len(area), bool)
    panels = [
        {"panel": name} | _figures(garment.strain, area, middle, garment.panel == index)
        for index, name in enumerate(garment.panel_names)
        if (garment.panel == index).any()
    ]
    return {"strain": _figures(garment.strain, area, middle, every), "panel_strain": panels}


def strain_percent(garments: tuple[DressedGarment, ...]) -> dict[str, float | None]:
    """Return the largest strains of all garments and their 99th percentile [%], as a report has them."""
    known = [garment.strain for garment in garments if garment.strain is not None]
    if not known:
        return {"warp_max": None, "weft_max": None, "p99": None}
    strain = 100.0 * np.concatenate(known)
    return {
        "warp_max": float(strain[:, 0].max()),
        "weft_max": float(strain[:, 1].max()),
        "p99": float(np.quantile(strain, 0.99)),
    }


def _figures(strain: Float, area: Float, middle: Float, own: Bool) -> dict[str, Any]:
    """Return the strain of some faces [%], their area [m^2] and the place of the largest strain [m]."""
    percent, share = 100.0 * strain[own], area[own]
    found: dict[str, Any] = {"area_m2": float(share.sum())}
    for column, name in enumerate(("warp", "weft")):
        order = np.argsort(percent[:, column], kind="stable")
        summed = np.cumsum(share[order])
        values = percent[order, column]
        found[f"{name}_percent"] = {
            "min": float(values[0]),
            **{
                word: float(values[min(int(np.searchsorted(summed, part * summed[-1])), len(values) - 1)])
                for word, part in SHARES.items()
            },
            "max": float(values[-1]),
        }
    found["max_at"] = middle[own][int(percent.max(axis=1).argmax())].tolist()
    return found
