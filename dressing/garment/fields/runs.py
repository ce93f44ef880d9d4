"""Runs of edges by their names: a role, a label, or panels and numbers of edges."""

from collections.abc import Iterator, Sequence

import numpy as np

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.garment.garment_mesh import Border, GarmentMesh
from toile.dressing.pattern.pattern import Panel, Pattern
from toile.dressing.pattern.seam import EdgePart, read_run
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

_SLACK = 1e-6
"""Fractions of an edge closer than this are one."""


def run_parts(run: str, pattern: Pattern) -> tuple[EdgePart, ...]:
    """Return the stretches of edges that a run names. Raises InputError if there is none of that name."""
    named = tuple(_of_name(run, pattern.panels))
    if named:
        return named
    if "." not in run:
        raise InputError(
            f"run: {unknown_name('edge', run, _names(pattern))}; or write PANEL.NUMBER", field="run"
        )
    parts = read_run(run, "run")
    names = [panel.name for panel in pattern.panels]
    for part in parts:
        if part.panel not in names:
            raise InputError(f"run '{run}': {unknown_name('panel', part.panel, names)}", field="run")
        count = len(pattern.panel(part.panel).edges)
        if part.edge >= count:
            raise InputError(
                f"run '{run}': panel '{part.panel}' has no edge {part.edge}, only 0..{count - 1}", field="run"
            )
    return parts


def _of_name(run: str, panels: Sequence[Panel]) -> Iterator[EdgePart]:
    for panel in panels:
        for number, edge in enumerate(panel.edges):
            if run and run in (edge.label, edge.role):
                yield EdgePart(panel.name, number)


def _names(pattern: Pattern) -> list[str]:
    names = {
        name for panel in pattern.panels for edge in panel.edges for name in (edge.label, edge.role) if name
    }
    return sorted(names) or ["none that has a name in this garment"]


def run_lines(run: str, mesh: GarmentMesh, rest: Float) -> dict[int, Float]:
    """Return the straight pieces of a run in rest space [m], shape (k, 2, 3), by the number of their panel.

    `rest` are the material vertices there, shape (m, 3). Raises InputError if there is none of that name.
    """
    named = [border for border in mesh.borders if run in (border.label, border.role)]
    if not named:
        if not mesh.borders:
            raise InputError(
                f"run '{run}': a garment from a mesh has no edges with names; use a pattern", field="run"
            )
        if "." not in run:
            known = sorted({name for b in mesh.borders for name in (b.label, b.role) if name})
            raise InputError(f"run: {unknown_name('edge', run, known)}; or write PANEL.NUMBER", field="run")
        named = [b for part in read_run(run, "run") for b in mesh.borders if _is_within(b, part)]
        if not named:
            raise InputError(f"run '{run}': there is no such edge; see toile pattern FILE", field="run")
    found: dict[int, list[Float]] = {}
    for border in named:
        points = rest[border.vertices]
        number = mesh.panel_names.index(border.panel)
        found.setdefault(number, []).append(np.stack([points[:-1], points[1:]], axis=1))
    return {number: np.concatenate(lines) for number, lines in found.items()}


def _is_within(border: Border, part: EdgePart) -> bool:
    low, high = sorted((part.start, part.end))
    return (border.panel, border.edge) == (part.panel, part.edge) and (
        low - _SLACK <= border.start and border.end <= high + _SLACK
    )
