"""Writer of GarmentCode sewing patterns (*_specification.json), in centimetres."""

import json
import math
from pathlib import Path
from typing import Any

from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.pattern.fit_cubics import with_curves
from toile.dressing.pattern.garmentcode_roles import edge_role, panel_role
from toile.dressing.pattern.pattern import Arc, Cubic, Edge, Panel, Pattern, Quadratic
from toile.dressing.pattern.split_seams import split_seams

_UNITS = 100.0


def write_garmentcode(pattern: Pattern, path: str | Path) -> None:
    """Write a pattern so that reading the file back gives the same pattern, to the last bit.

    Seams between runs are written as stitches between whole edges, and polylines as cubics that follow them
    within 0.1 mm; edges are split for both, and notches are left out.

    (A length that is not a floating-point number divided by 100 comes back changed by one unit in the last
    place; writing that again changes nothing. A panel or an edge without a role comes back with the one that
    its name or label has in GarmentCode; another role of its own is written beside them.)
    """
    text = json.dumps(garmentcode_document(pattern), indent=1) + "\n"
    write_atomic(Path(path), text.encode())


def garmentcode_document(pattern: Pattern) -> dict[str, Any]:
    """Return what `write_garmentcode` writes, as a dictionary that a garment may be made from."""
    pattern = with_curves(split_seams(pattern))
    return {
        "pattern": {
            "panels": {panel.name: _panel(panel) for panel in pattern.panels},
            "stitches": [
                [
                    {"panel": stitch.panel_a, "edge": stitch.edge_a},
                    {"panel": stitch.panel_b, "edge": stitch.edge_b},
                    *(["right_wrong"] if stitch.right_wrong else []),
                ]
                for stitch in pattern.stitches
            ],
            "panel_order": [panel.name for panel in pattern.panels],
        },
        "parameters": {},
        "parameter_order": [],
        "properties": {
            "curvature_coords": "relative",
            "normalize_panel_translation": False,
            "normalized_edge_loops": True,
            "units_in_meter": int(_UNITS),
        },
    }


def _panel(panel: Panel) -> dict[str, Any]:
    raw: dict[str, Any] = {
        "translation": [_in_file_units(t) for t in panel.translation],
        "rotation": list(panel.rotation_degrees),
        "vertices": [[_in_file_units(x), _in_file_units(y)] for x, y in panel.vertices],
        "edges": [_edge(edge) for edge in panel.edges],
    }
    if panel.label:
        raw["label"] = panel.label
    if panel.role not in (None, panel_role(panel.name, panel.label)):
        raw["role"] = panel.role
    if panel.warp_degrees:
        raw["warp_degrees"] = panel.warp_degrees
    if panel.roll_radius is not None:
        raw["roll_radius"] = _in_file_units(panel.roll_radius)
    return raw


def _edge(edge: Edge) -> dict[str, Any]:
    raw: dict[str, Any] = {"endpoints": [edge.start, edge.end]}
    curve = edge.curve
    if isinstance(curve, Quadratic):
        raw["curvature"] = {"type": "quadratic", "params": [list(curve.control)]}
    elif isinstance(curve, Cubic):
        raw["curvature"] = {"type": "cubic", "params": [list(curve.control_a), list(curve.control_b)]}
    elif isinstance(curve, Arc):
        params = [_in_file_units(curve.radius), int(curve.large), int(curve.right)]
        raw["curvature"] = {"type": "circle", "params": params}
    if edge.label:
        raw["label"] = edge.label
    if edge.role not in (None, edge_role(edge.label)):
        raw["role"] = edge.role
    return raw


def _in_file_units(metres: float) -> float:
    """Centimetres that divide back to exactly `metres`; of several, the one with the fewest digits."""
    first = metres * _UNITS
    candidates = [first, math.nextafter(first, -math.inf), math.nextafter(first, math.inf)]
    exact = [value for value in candidates if value / _UNITS == metres] or [first]
    return min(exact, key=lambda value: len(repr(value)))
