"""fit.json: fit per panel of every garment and per region of the body, as plain data."""

from typing import Any

import numpy as np

from toile.dressing.fit.findings import findings, shifts
from toile.dressing.fit.fit_maps import QUANTITIES, BodyFit, FitMaps, GarmentFit
from toile.dressing.fit.spread_out import SPREAD
from toile.dressing.fit.worn import Worn
from toile.geometry.arrays import Bool, Float

DECIMALS = {"Pa": 1, "mm": 2, "percent": 3, "m": 2, "N": 4, "m2": 5}
"""Decimals that files have, by the end of a name."""


def fit_tables(worn: Worn, maps: FitMaps) -> dict[str, Any]:
    """Return the tables of a fit.

    Every quantity has its mean by area, and the smallest and largest value that 5 % of the area stay below
    and exceed; body regions have the resultant of all forces in the room.
    """
    garments = [
        {
            "name": names.name,
            "fabric": names.fabric,
            **shifts(garment),
            "panels": [
                {"name": panel, **_part(garment, garment.panel == index)}
                for index, panel in enumerate(names.panels)
                if (garment.panel == index).any()
            ],
            "regions": [
                {"name": maps.regions[index], **_part(garment, garment.region == index)}
                for index in np.unique(garment.region).tolist()
            ],
        }
        for names, garment in zip(worn.garments, maps.garments, strict=True)
    ]
    table: dict[str, Any] = {
        "quantities": QUANTITIES | {"force_N": "force of the cloth on a region, in the room of the avatar"},
        "pressure_spread_over_mm": 1e3 * SPREAD,
        "weight_N": round(maps.weight, 4),
        "carried_by_body_N": round(maps.carried, 4),
        "body": {"regions": _body_regions(worn, maps)},
        "garments": garments,
    }
    return table | {"findings": findings(table)}


def _body_regions(worn: Worn, maps: FitMaps) -> list[dict[str, Any]]:
    """Return what the garments do to every region of the body that they cover."""
    body, rows = maps.body, []
    for index, name in enumerate(maps.regions):
        own = body.region == index
        covered = own & body.covered
        if covered.any():
            rows.append({"name": name, **_region(worn, body, own, covered)})
    return rows


def _region(worn: Worn, body: BodyFit, own: Bool, covered: Bool) -> dict[str, Any]:
    """Return the row of one region of the body."""
    force = worn.place.turned_out(body.force[own].sum(axis=0))
    return {
        "area_m2": round(float(body.area[own].sum()), DECIMALS["m2"]),
        "covered_m2": round(float(body.area[covered].sum()), DECIMALS["m2"]),
        "pressure_Pa": summary(body.pressure_Pa[covered], body.area[covered], "Pa"),
        "ease_mm": summary(body.ease_mm[covered], body.area[covered], "mm"),
        "normal_force_N": round(float(body.press[own].sum()), DECIMALS["N"]),
        "force_N": [round(value, DECIMALS["N"]) for value in force.tolist()],
    }


def _part(garment: GarmentFit, own: Bool) -> dict[str, Any]:
    """Return the row of some faces of a garment."""
    area = garment.area[own]
    return {"area_m2": round(float(area.sum()), DECIMALS["m2"])} | {
        name: summary(values[own], area, name.rpartition("_")[2]) for name, values in garment.at_faces.items()
    }


def summary(values: Float, area: Float, unit: str) -> dict[str, float]:
    """Return mean, 5th and 95th percentile by area, and the largest of values, shape (k,)."""
    order = np.argsort(values, kind="stable")
    share = np.cumsum(area[order]) / max(float(area.sum()), 1e-300)
    at = [min(int(np.searchsorted(share, level)), len(values) - 1) for level in (0.05, 0.95)]
    figures = {
        "mean": float((values * area).sum() / max(float(area.sum()), 1e-300)),
        "p05": float(values[order[at[0]]]),
        "p95": float(values[order[at[1]]]),
        "max": float(values.max()),
    }
    return {name: round(value, DECIMALS[unit]) for name, value in figures.items()}
