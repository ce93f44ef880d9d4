"""Garments that toile mends or places: exports with the usual faults, and patterns without places."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from tests.dressing.garment.mesh_parts import obj_text, octahedron, tube
from tests.fuzz.drawn import form
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.garment.pattern_place import moved_to_body
from toile.dressing.garment.unplaced import placed_by_seams
from toile.dressing.pattern.garmentcode import check_pattern, read_garmentcode
from toile.dressing.pattern.smpl_frame import on_the_floor
from toile.dressing.pattern.twisted_seams import check_twists


def placed_patterns() -> Iterable[tuple[str, bytes]]:
    """A tee of four panels: all in one place, in millimetres, and placed for an origin at the chest."""
    unplaced = _tee(100.0, 0.0, 0.0)
    in_millimetres = _tee(1000.0, 0.12, 0.95)
    about_the_chest = _tee(100.0, 0.12, -0.35)
    for document in (unplaced, in_millimetres, about_the_chest):
        yield ".json", json.dumps(document).encode()


def _tee(units: float, depth: float, height: float) -> dict[str, Any]:
    """Return a tee in `units` per metre, its panels `depth` before and behind a body, from a height [m]."""
    outline = [(-0.25, 0), (0.25, 0), (0.25, 0.35), (0.2, 0.55), (0.08, 0.6), (-0.08, 0.6), (-0.2, 0.55),
               (-0.25, 0.35)]  # fmt: skip

    def panel(points: list[tuple[float, float]], x: float, z: float, turn: float) -> dict[str, Any]:
        count = len(points)
        return {
            "vertices": [[units * px, units * py] for px, py in points],
            "edges": [{"endpoints": [n, (n + 1) % count]} for n in range(count)],
            "translation": [units * x, units * height, units * z], "rotation": [0, turn, 0],
        }  # fmt: skip

    sleeve = [(-0.2, 0.0), (0.2, 0.0), (0.21, 0.2), (0.0, 0.3), (-0.21, 0.2)]
    turn = 180.0 if depth else 0.0
    panels = {
        "front": panel(outline, 0.0, depth, 0.0), "back": panel(outline, 0.0, -depth, turn),
        "sleeve_l": panel(sleeve, 4 * depth, 0.0, 0.0), "sleeve_r": panel(sleeve, -4 * depth, 0.0, 0.0),
    }  # fmt: skip
    sewn = [
        ("front", 1, "back", 7), ("front", 7, "back", 1), ("front", 3, "back", 5), ("front", 5, "back", 3),
        ("sleeve_l", 2, "front", 2), ("sleeve_l", 3, "back", 6), ("sleeve_r", 2, "front", 6),
        ("sleeve_r", 3, "back", 2), ("sleeve_l", 1, "sleeve_l", 4), ("sleeve_r", 1, "sleeve_r", 4),
    ]  # fmt: skip
    return {
        "pattern": {
            "panels": panels, "panel_order": list(panels),
            "stitches": [[{"panel": a, "edge": i}, {"panel": b, "edge": j}] for a, i, b, j in sewn],
        },
        "properties": {"units_in_meter": units, "curvature_coords": "relative"},
    }  # fmt: skip


def placed_pattern(path: Path) -> object:
    """Read a pattern, lay it around the mannequin, and mesh it coarsely."""
    pattern = read_garmentcode(path)
    check_pattern(pattern)
    pattern = on_the_floor(pattern, form().avatar.vertices)
    pattern = moved_to_body(placed_by_seams(pattern, form()), form())
    check_twists(pattern)
    return mesh_pattern(pattern, edge_length=0.05, curve_edge_length=0.05)


def dirty_meshes() -> Iterable[tuple[str, bytes]]:
    """A tube with doubled, flat and flipped faces, gaps, a fin and a button; and one with two walls."""
    (outer, faces), (inner, _) = (tube(radius, 16, 3, 0.05) for radius in (0.3, 0.299))
    count = len(outer)
    walls = [*faces, *(tuple(count + corner for corner in reversed(face)) for face in faces)]
    yield ".obj", obj_text((np.concatenate([outer, inner]), walls)).encode()
    first = faces[0]
    cap = 0.5 * (outer[first[0]] + outer[first[1]])
    vertices = np.concatenate([outer, [cap, outer[first[0]] + 2e-5, outer[first[2]] * (1.2, 1.0, 1.2)]])
    broken = [
        *faces, first, first[::-1], (first[0], count, first[1]), (first[0], first[0], first[1]),
        (first[1], first[2], count + 2), (count + 1, first[1], first[2]), faces[5][::-1],
    ]  # fmt: skip
    yield ".obj", obj_text((vertices, broken), octahedron((0.0, 1.06, 0.302), 0.006)).encode()


def one_layer(path: Path) -> object:
    """Mend a garment; two walls are one layer."""
    return read_mesh_garment(path, units="m", up="y", edge_length=0.05)


def two_layers(path: Path) -> object:
    """Mend a garment for the mannequin; two walls are two layers."""
    return read_mesh_garment(path, avatar=form().avatar, walls=2)
