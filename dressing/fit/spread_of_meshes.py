"""The error bar of a fit: how far a second drape on another mesh is from it, per vertex and per region."""

from typing import Any

import numpy as np

from toile.dressing.fit.fit_maps import FitMaps, GarmentFit
from toile.geometry.arrays import Float
from toile.geometry.closest_point import closest_points

REGION_QUANTITIES = ("pressure_Pa", "ease_mm", "tension_N_m")


def garment_spread(one: GarmentFit, other: GarmentFit) -> dict[str, Float]:
    """Return the differences of two meshes of a garment at the material vertices of the first, (m,)."""
    found = {name: np.zeros(len(one.start)) for name in one.at_vertices}
    # Panels lie across each other at the start: each is looked up on its own.
    for panel in np.unique(one.panel).tolist():
        vertices = np.unique(one.vertex_faces[one.panel == panel])
        there = other.vertex_faces[other.panel == panel]
        at = closest_points(one.start[vertices], other.start, there)
        for name, values in one.at_vertices.items():
            found[name][vertices] = np.abs(values[vertices] - at.take(other.at_vertices[name], there))
    return found


def body_spread(one: FitMaps, other: FitMaps) -> Float:
    """Return the difference of the pressures at the vertices of the body [Pa], shape (v,)."""
    return np.asarray(np.abs(one.body.pressure_Pa - other.body.pressure_Pa))


def spread_tables(table: dict[str, Any], other: dict[str, Any], on_body: Float) -> dict[str, Any]:
    """Return the differences of the tables of two meshes per region of garments and body.

    Those of pressure and tension are of the 95th percentiles, in which regions are judged; of ease, of the
    means. `on_body` are the differences at vertices of the body [Pa].
    """
    rows: list[dict[str, Any]] = []
    for garment, again in zip(table["garments"], other["garments"], strict=True):
        twins = {row["name"]: row for row in again["regions"]}
        rows += [
            {"garment": garment["name"], "region": row["name"]} | _differences(row, twins[row["name"]])
            for row in garment["regions"]
            if row["name"] in twins
        ]
    twins = {row["name"]: row for row in other["body"]["regions"]}
    body = [
        {"region": row["name"]} | _differences(row, twins[row["name"]])
        for row in table["body"]["regions"]
        if row["name"] in twins
    ]
    return {
        "regions": rows,
        "body": body,
        "body_pressure_Pa_p95": round(float(np.quantile(on_body, 0.95)), 1),
    }


def _differences(row: dict[str, Any], twin: dict[str, Any]) -> dict[str, float]:
    """Return by how much two rows differ."""
    return {
        name: round(abs(row[name][figure] - twin[name][figure]), 3)
        for name in REGION_QUANTITIES
        if name in row
        for figure in (("mean",) if name == "ease_mm" else ("p95",))
    }
