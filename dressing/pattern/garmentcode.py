"""Reader of GarmentCode sewing patterns (*_specification.json).

Checked here, where the names of the file are still at hand: every panel is one closed, simple loop and every
stitch can be sewn. What is wrong is named with file, panel and edge.
"""

import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, get_args

from toile.dressing.files.parse_text import parse_json
from toile.dressing.pattern.empty_edges import (
    SHORTEST_EDGE,
    Numbers,
    new_number,
    renumbered,
    same_place,
    without_empty_edges,
)
from toile.dressing.pattern.garmentcode_loops import consistent_loops
from toile.dressing.pattern.garmentcode_roles import edge_role, panel_role
from toile.dressing.pattern.likely_units import likely_units
from toile.dressing.pattern.pattern import Arc, Cubic, Curve, Edge, Panel, Pattern, Point, Quadratic, Stitch
from toile.dressing.pattern.pattern_curve import edge_length, relative_point
from toile.dressing.pattern.pattern_outline import crossing_sides, default_segments, outline
from toile.dressing.pattern.roles import EdgeRole, PanelRole
from toile.dressing.pattern.seam import read_seam
from toile.dressing.pattern.split_seams import split_seams
from toile.geometry.errors import InputError, about

MAX_DART_RATIO = 5.0
MAX_GATHER_RATIO = 12.0
"""Longest over shortest edge that can be sewn together; real gathers stay below 4."""
LARGEST_PANEL, SMALLEST_LARGEST = 10.0, 0.03
"""Size [m] that no panel exceeds, and that some panel of every pattern reaches: else the units are wrong."""


def read_garmentcode(path: str | Path) -> Pattern:
    """Read a sewing pattern.

    Raises
    ------
    InputError
        The file is missing or not a pattern; a panel is open, crosses itself or has an edge without length; a
        stitch refers to what does not exist or joins edges that cannot be sewn together.
    """
    path = Path(path)
    with about(file=path):
        return _pattern(_load(path), path.name)


def pattern_of(document: Mapping[str, Any], name: str = "garment") -> Pattern:
    """Return the pattern of a GarmentCode specification that is in memory, called `name`.

    Raises InputError as `read_garmentcode` does.
    """
    return _pattern(document, name)


def _pattern(document: Mapping[str, Any], file: str) -> Pattern:
    """Return the pattern of a document; `file` is the name of its file, for messages and its own name."""
    with about(field="pattern"):
        body = _mapping(
            document.get("pattern"), f"{file}: 'pattern'", "this is not a GarmentCode specification"
        )
    properties = document.get("properties") or {}
    if not isinstance(properties, Mapping):
        raise InputError(f"{file}: 'properties' must be an object of settings", field="properties")
    notes: list[str] = []
    units = properties.get("units_in_meter")
    if units is None:
        units, word = likely_units(body)
        notes.append(f"The pattern does not say its units; {word} are assumed.")
    with about(field="properties.units_in_meter"):
        units = _number(units, f"{file}: properties.units_in_meter")
        if units <= 0.0:
            raise InputError(
                f"{file}: properties.units_in_meter is {units:g}; give units per metre, such as 100"
            )
    absolute = properties.get("curvature_coords", "relative") == "absolute"
    recentre = properties.get("normalize_panel_translation") is True

    with about(field="pattern.panels"):
        raw_panels = _mapping(body.get("panels"), f"{file}: 'pattern.panels'", "give at least one panel")
        if not raw_panels:
            raise InputError(f"{file}: 'pattern.panels' is empty; give at least one panel")
    panels: dict[str, Panel] = {}
    numbers: dict[str, Numbers] = {}
    for name, raw in raw_panels.items():
        with about(field=f"pattern.panels.{name}"):
            panels[name], numbers[name], mended = _panel(
                raw, str(name), f"{file}: panel '{name}'", units, absolute, recentre
            )
        notes += [f"Panel '{name}': {note}." for note in mended]
    _check_sizes(panels, file, units)
    order = body.get("panel_order")
    if isinstance(order, list) and sorted(map(str, order)) == sorted(panels):
        panels = {name: panels[name] for name in order}
    stitches = _stitches(body.get("stitches") or [], panels, file, numbers)
    name = file.removesuffix(".json").removesuffix("_specification")
    seams = tuple(
        renumbered(read_seam(text, where), numbers, where)
        for where, text in (
            (f"{file}: pattern.seams.{i}", text) for i, text in enumerate(body.get("seams") or [])
        )
    )
    pattern = Pattern(
        name=name, panels=tuple(panels.values()), stitches=stitches, notes=tuple(notes), seams=seams
    )
    if properties.get("normalized_edge_loops") is not True:
        pattern = consistent_loops(pattern)
    return pattern


def check_pattern(pattern: Pattern) -> None:
    """Check a pattern that was not read from a file. Raises InputError as `read_garmentcode` does."""
    pattern = split_seams(pattern)
    for panel in pattern.panels:
        with about(field=f"pattern.panels.{panel.name}"):
            _check_outline(panel, f"{pattern.name}: panel '{panel.name}'")
    raw = [
        [{"panel": s.panel_a, "edge": s.edge_a}, {"panel": s.panel_b, "edge": s.edge_b}]
        for s in pattern.stitches
    ]
    numbers = {panel.name: tuple(range(len(panel.edges))) for panel in pattern.panels}
    _stitches(raw, {panel.name: panel for panel in pattern.panels}, pattern.name, numbers)


def _load(path: Path) -> Mapping[str, Any]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"{path}: no such pattern file; check the path", file=path) from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: the pattern cannot be read ({error})", file=path) from None
    try:
        document = parse_json(text)
    except ValueError as error:
        raise InputError(f"{path.name}: not valid JSON ({error}); export the pattern again") from None
    return _mapping(document, path.name, "this is not a GarmentCode specification")


def _mapping(value: Any, what: str, advice: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise InputError(f"{what} is {'missing' if value is None else 'not an object'}; {advice}")
    return value


def _number(value: Any, what: str) -> float:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    # NaN is not less than anything, and some whole numbers are too large for a float.
    if not is_number or not abs(value) <= sys.float_info.max:
        shown = repr(value) if len(repr(value)) < 40 else f"{repr(value)[:36]}..."
        raise InputError(f"{what} must be a finite number, got {shown}")
    return float(value)


def _numbers(value: Any, count: int, what: str, field: str | None = None) -> tuple[float, ...]:
    with about(field=field):
        if not isinstance(value, list) or len(value) != count:
            raise InputError(f"{what} must be a list of {count} numbers, got {value!r}")
        return tuple(_number(item, what) for item in value)


def _index(value: Any, count: int, what: str, owner: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise InputError(f"{what} must be a whole number, got {value!r}")
    if not 0 <= value < count:
        raise InputError(f"{what} is {value}, but {owner} has only 0..{count - 1}")
    return value


def _panel(
    raw: Any, name: str, where: str, units: float, absolute: bool, recentre: bool
) -> tuple[Panel, Numbers, tuple[str, ...]]:
    """Return a panel, what its edges are numbered now, and what was mended."""
    raw = _mapping(raw, where, "give vertices and edges")
    raw_vertices = raw.get("vertices")
    if not isinstance(raw_vertices, list) or not raw_vertices:
        raise InputError(f"{where}: 'vertices' must be a list of [x, y] corners", field="vertices")
    vertices = [
        _numbers(v, 2, f"{where}: vertex {i}", field=f"vertices.{i}") for i, v in enumerate(raw_vertices)
    ]
    corners: list[Point] = [(x / units, y / units) for x, y in vertices]
    translation, rotation = (
        _numbers(raw.get(key, [0, 0, 0]), 3, f"{where}: {key}", field=key)
        for key in ("translation", "rotation")
    )
    translation = tuple(t / units for t in translation)
    raw_edges = raw.get("edges")
    if not isinstance(raw_edges, list) or not raw_edges:
        raise InputError(f"{where}: 'edges' must be a list of edges", field="edges")
    edges = []
    for i, raw_edge in enumerate(raw_edges):
        with about(field=f"edges.{i}"):
            edges.append(_edge(raw_edge, f"{where}, edge {i}", corners, units, absolute))
    edges, numbers, mended = without_empty_edges(corners, edges, where)
    if recentre:
        shift_x = sum(x for x, _ in corners) / len(corners)
        shift_y = sum(y for _, y in corners) / len(corners)
        corners = [(x - shift_x, y - shift_y) for x, y in corners]
        translation = (translation[0] + shift_x, translation[1] + shift_y, translation[2])
    with about(field="warp_degrees"):
        warp = _number(raw.get("warp_degrees", 0.0), f"{where}: warp_degrees")
    if max(math.dist(corners[0], corner) for corner in corners) > LARGEST_PANEL:
        raise InputError(
            f"{where} is more than {LARGEST_PANEL:g} m large with {units:g} units per metre; "
            "check its vertices and properties.units_in_meter"
        )
    with about(field="roll_radius"):
        roll = raw.get("roll_radius")
        roll = None if roll is None else _number(roll, f"{where}: roll_radius") / units
    label = str(raw.get("label") or "")
    panel = Panel(
        name=name,
        vertices=tuple(corners),
        edges=tuple(edges),
        translation=(translation[0], translation[1], translation[2]),
        rotation_degrees=(rotation[0], rotation[1], rotation[2]),
        label=label,
        role=_role(raw, PanelRole, where) or panel_role(name, label),
        warp_degrees=warp,
        roll_radius=roll,
    )
    _check_outline(panel, where)
    for i in range(len(edges)):
        # A circle is three times as long as it is wide.
        if not (length := edge_length(panel, i)) <= 4.0 * LARGEST_PANEL:
            raise InputError(
                f"{where}, edge {i} is {length:.3g} m long; check its curvature", field=f"edges.{i}.curvature"
            )
    return panel, numbers, mended


def _check_sizes(panels: Mapping[str, Panel], file: str, units: float) -> None:
    size = max(math.dist(p.vertices[0], corner) for p in panels.values() for corner in p.vertices)
    if size < SMALLEST_LARGEST:
        raise InputError(
            f"{file}: the largest panel measures {100 * size:.3g} cm with {units:g} units per metre; "
            "check properties.units_in_meter",
            field="properties.units_in_meter",
        )


def _edge(raw: Any, where: str, corners: list[Point], units: float, absolute: bool) -> Edge:
    raw = _mapping(raw, where, "give its endpoints")
    ends = raw.get("endpoints")
    if not isinstance(ends, list) or len(ends) != 2:
        raise InputError(f"{where}: 'endpoints' must be two vertex numbers, got {ends!r}", field="endpoints")
    with about(field="endpoints"):
        start, end = (_index(value, len(corners), f"{where}: endpoint", "the panel") for value in ends)
    bent = raw.get("curvature")
    if same_place(corners[start], corners[end]):
        if bent is not None:
            raise InputError(
                f"{where} has no length (vertices {start} and {end} coincide); remove it or move a vertex"
            )
        return Edge(start, end)
    with about(field="curvature"):
        curve = _curve(bent, where, corners[start], corners[end], units, absolute)
    label = str(raw.get("label") or "")
    return Edge(start, end, curve, label, _role(raw, EdgeRole, where) or edge_role(label))


def _role(raw: Mapping[str, Any], kind: Any, where: str) -> Any:
    """Return the role that the file itself gives, one of those of a kind; None if it gives none."""
    role = raw.get("role")
    if role is not None and role not in get_args(kind):
        raise InputError(
            f"{where}: role must be one of {', '.join(get_args(kind))}, got {role!r}", field="role"
        )
    return role


def _curve(raw: Any, where: str, start: Point, end: Point, units: float, absolute: bool) -> Curve:
    if raw is None:
        return None
    where = f"{where}: curvature"
    if isinstance(raw, list):
        raw = {"type": "quadratic", "params": [raw]}
    raw = _mapping(raw, where, "give type and params")
    kind, params = raw.get("type"), raw.get("params")
    if kind == "circle":
        radius, large, right = _numbers(params, 3, where)
        return Arc(radius / units, large != 0.0, right != 0.0)
    count = {"quadratic": 1, "cubic": 2}.get(str(kind))
    if count is None:
        raise InputError(f"{where} type {kind!r} is unknown; use quadratic, cubic or circle")
    if not isinstance(params, list) or len(params) != count:
        raise InputError(f"{where} of type {kind} needs {count} control point(s), got {params!r}")
    control: list[Point] = []
    for item in params:
        u, v = _numbers(item, 2, where)
        control.append(relative_point(start, end, (u / units, v / units)) if absolute else (u, v))
    return Quadratic(control[0]) if count == 1 else Cubic(control[0], control[1])


def _check_outline(panel: Panel, where: str) -> None:
    count = len(panel.edges)
    for i, edge in enumerate(panel.edges):
        following = panel.edges[(i + 1) % count]
        if edge.end != following.start:
            raise InputError(
                f"{where} is not a closed loop: edge {i} ends at vertex {edge.end}, but the next one starts "
                f"at vertex {following.start}; edges must follow each other around the panel",
                field=f"edges.{i}",
            )
    visited = [edge.start for edge in panel.edges]
    twice = sorted({v for v in visited if visited.count(v) > 1})
    if twice:
        raise InputError(f"{where} crosses itself: its outline passes vertex {twice[0]} more than once")
    for i in range(count):
        try:
            length = edge_length(panel, i)
        except ValueError as error:
            raise InputError(f"{where}, edge {i}: {error}; enlarge the radius", field=f"edges.{i}") from None
        if length < SHORTEST_EDGE:
            raise InputError(
                f"{where}, edge {i} has no length; remove it or move a vertex", field=f"edges.{i}"
            )
    polygon, owner = outline(panel, default_segments(panel))
    if len(polygon) < 3:
        raise InputError(f"{where} encloses no area: it needs three edges, or two of which one is curved")
    crossing = crossing_sides(polygon)
    if crossing is not None:
        a, b = (int(owner[side]) for side in crossing)
        what = f"edge {a} crosses itself" if a == b else f"edges {a} and {b} cross or touch"
        raise InputError(f"{where} crosses itself: {what}; move their vertices or control points apart")


def _stitches(
    raw_stitches: Any, panels: Mapping[str, Panel], file: str, numbers: Mapping[str, Numbers]
) -> tuple[Stitch, ...]:
    if not isinstance(raw_stitches, list):
        raise InputError(f"{file}: 'pattern.stitches' must be a list", field="pattern.stitches")
    sewn: dict[tuple[str, int], int] = {}
    stitches = []
    for number, raw in enumerate(raw_stitches):
        with about(field=f"pattern.stitches.{number}"):
            stitches.append(_stitch(raw, panels, f"{file}: stitch {number}", sewn, numbers))
        sewn |= dict.fromkeys(_sides(stitches[-1]), number)
    return tuple(stitches)


def _stitch(
    raw: Any,
    panels: Mapping[str, Panel],
    where: str,
    sewn: Mapping[tuple[str, int], int],
    numbers: Mapping[str, Numbers],
) -> Stitch:
    right_wrong = isinstance(raw, list) and len(raw) == 3 and raw[2] == "right_wrong"
    if not isinstance(raw, list) or not (len(raw) == 2 or right_wrong):
        raise InputError(f'{where} must be two edges, optionally followed by "right_wrong"')
    sides: list[tuple[str, int]] = []
    for item in raw[:2]:
        item = _mapping(item, where, "give panel and edge")
        name = str(item.get("panel"))
        if name not in panels:
            known = ", ".join(sorted(panels))
            raise InputError(
                f"{where} refers to panel '{name}', which does not exist; the panels are {known}"
            )
        edge = _index(item.get("edge"), len(numbers[name]), f"{where}: edge", f"panel '{name}'")
        side = (name, new_number(numbers[name], name, edge, where))
        if side in sides:
            raise InputError(f"{where} sews panel '{name}', edge {edge} to itself; name two different edges")
        if side in sewn:
            raise InputError(
                f"{where} sews panel '{name}', edge {edge} again (stitch {sewn[side]} does already); "
                "split the edge or remove one stitch"
            )
        sides.append(side)
    stitch = Stitch(*sides[0], *sides[1], right_wrong)
    _check_lengths(stitch, panels, where)
    return stitch


def _sides(stitch: Stitch) -> tuple[tuple[str, int], tuple[str, int]]:
    """Return both edges of a stitch, each as panel and number."""
    return (stitch.panel_a, stitch.edge_a), (stitch.panel_b, stitch.edge_b)


def _check_lengths(stitch: Stitch, panels: Mapping[str, Panel], where: str) -> None:
    a = edge_length(panels[stitch.panel_a], stitch.edge_a)
    b = edge_length(panels[stitch.panel_b], stitch.edge_b)
    limit = MAX_DART_RATIO if stitch.panel_a == stitch.panel_b else MAX_GATHER_RATIO
    if max(a, b) > limit * min(a, b):
        raise InputError(
            f"{where} ({stitch.name}) sews an edge of {100 * a:.3g} cm to one of "
            f"{100 * b:.3g} cm; more than {limit:g} to 1 cannot be matched, check the edge numbers"
        )
