"""Fit in words: where garments are tight, where they are loose, and what moved."""

from typing import Any

import numpy as np

from toile.dressing.fit.fit_maps import GarmentFit
from toile.geometry.connected import connected

TIGHT_PRESSURE = 1500.0
"""95th percentile of the pressure from which a region is tight [Pa]. Discomfort begins at 6 to 10 kPa (Denton
1972); what is worn all day without being felt stays below a quarter of that."""
TIGHT_TENSION = 150.0
"""95th percentile of the tension from which a region pulls [N/m]: 1500 Pa on a radius of 10 cm."""
LOOSE_EASE = 40.0
"""Mean gap from which a region is loose [mm]: 25 cm of girth beyond the body's."""
LEAST_AREA = 0.002
"""Area of cloth or body below which a region is not worth a word [m^2]."""
MOVED = {"waist": 10.0, "hem": 40.0}
"""Shifts that are told [mm]: shoulders and seat take up some of the length that a pattern has when flat."""
TOP = 0.98
"""Quantile of heights that is a garment's top: a lone corner is none."""


def shifts(garment: GarmentFit) -> dict[str, float]:
    """Return how far waist and hem have moved from where the pattern has them, upwards [mm].

    `waist_rise_mm` is that of edges that sit on the waist, where there are any. `hem_rise_mm` is how much
    closer the lowest border is to the top of the garment than in the pattern as it was placed.
    """
    found: dict[str, float] = {}
    start = np.zeros(len(garment.positions))
    count = np.bincount(garment.node, minlength=len(start))
    np.add.at(start, garment.node, garment.start[:, 1])
    start /= np.maximum(count, 1)
    now = garment.positions[:, 1]
    if len(garment.waist):
        found["waist_rise_mm"] = round(1e3 * float(np.median((now - start)[garment.waist])), 1)
    hem = _lowest_border(garment.faces, start)
    if len(hem):
        drop = [float(np.quantile(y, TOP) - np.mean(y[hem])) for y in (start, now)]
        found["hem_rise_mm"] = round(1e3 * (drop[0] - drop[1]), 1)
    return found


def _lowest_border(faces: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Return the nodes of the border whose mean height, shape (n,), is the lowest; none if it is closed."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    edges, times = np.unique(ends, axis=0, return_counts=True)
    border = edges[times == 1]
    if not len(border):
        return np.empty(0, np.int32)
    nodes, local = np.unique(border, return_inverse=True)
    loop = connected(local.reshape(-1, 2), len(nodes))
    mean = np.bincount(loop, height[nodes]) / np.bincount(loop)
    return np.asarray(nodes[loop == int(mean.argmin())])


def findings(table: dict[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """Return what stands out of the tables of a fit: tight, loose, moved; the worst first."""
    tight, loose, moved = [], [], []
    for garment in table["garments"]:
        name = garment["name"]
        for row in garment["regions"]:
            if row["area_m2"] < LEAST_AREA:
                continue
            pressure, tension = row["pressure_Pa"]["p95"], row["tension_N_m"]["p95"]
            measure = max(pressure / TIGHT_PRESSURE, tension / TIGHT_TENSION)
            fact = {"garment": name, "region": row["name"], "pressure_Pa": pressure, "tension_N_m": tension}
            if measure >= 1.0:
                tight.append((measure, fact))
            ease = row["ease_mm"]["mean"]
            if ease >= LOOSE_EASE:
                loose.append((ease, {"garment": name, "region": row["name"], "ease_mm": ease}))
        for edge, least in MOVED.items():
            rise = garment.get(f"{edge}_rise_mm", 0.0)
            if abs(rise) >= least:
                moved.append((abs(rise), {"garment": name, "edge": edge, "rise_mm": rise}))
    return {
        kind: [fact for _, fact in sorted(found, key=lambda entry: -entry[0])]
        for kind, found in (("tight", tight), ("loose", loose), ("moved", moved))
    }


def fit_sentences(table: dict[str, Any]) -> list[str]:
    """Return the findings of fit.json as sentences."""
    found, lines = table["findings"], []
    spread = {(row["garment"], row["region"]): row for row in table.get("spread", {}).get("regions", [])}
    for fact in found["tight"]:
        error = spread.get((fact["garment"], fact["region"]))
        more = "" if error is None else f" +- {_number(error['pressure_Pa'])}"
        lines.append(
            f"{fact['garment']}: tight at {fact['region']}, {_number(fact['tension_N_m'])} N/m, and presses "
            f"on the body with {_number(fact['pressure_Pa'])}{more} Pa"
        )
    lines += [
        f"{fact['garment']}: loose at {fact['region']}, {fact['ease_mm']:.0f} mm from the body"
        for fact in found["loose"]
    ]
    for fact in found["moved"]:
        rise = fact["rise_mm"]
        way = "rides up" if rise > 0.0 else "comes down"
        lines.append(f"{fact['garment']}: {fact['edge']} {way} by {abs(rise):.0f} mm")
    lines = lines or ["nothing is tight, loose or out of its place"]
    weight, carried = table["weight_N"], table["carried_by_body_N"]
    lines.append(f"the body bears {carried:.2f} N of the {weight:.2f} N that the garments weigh")
    return lines


def _number(value: float) -> str:
    """Return a number with three digits at most."""
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"
